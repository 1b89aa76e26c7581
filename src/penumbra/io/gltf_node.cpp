#include "penumbra/io/gltf_node.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <string>

#include "penumbra/io/gltf_choice.h"

namespace penumbra {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

JsonPlace node_place(const GltfDocument& document, std::uint64_t index) {
  return document.item("nodes", "node", index, document.root());
}

GltfNodes::Family read_family(const GltfDocument& document) {
  const std::size_t count = document.count("nodes");
  GltfNodes::Family family{std::vector<std::uint32_t>(count, none), std::vector<std::vector<std::uint32_t>>(count)};
  for (std::size_t n = 0; n < count; ++n) {
    const JsonPlace place = node_place(document, n);
    const auto list = place.list("children");
    if (!list) continue;
    for (std::size_t i = 0; i < list->size(); ++i) {
      const std::uint64_t child = list->whole_item(i);
      if (child >= count) {
        place.fail(
            fmt::format("its child {} does not exist, as there are {} nodes; export the file again", child, count));
      }
      if (const std::uint32_t other = family.parent[child]; other != none) {
        place.fail(fmt::format(
            "its child, node {}, is also a child of node {}, and a node has one parent; export the file again", child,
            other));
      }
      family.parent[child] = static_cast<std::uint32_t>(n);
      family.children[n].push_back(static_cast<std::uint32_t>(child));
    }
  }
  return family;
}

// With at most one parent each, a node is its own ancestor exactly when no root leads to it.
void check_acyclic(const GltfDocument& document, const GltfNodes::Family& family) {
  std::vector<bool> reached(family.parent.size(), false);
  std::vector<std::uint32_t> open;
  for (std::uint32_t n = 0; n < family.parent.size(); ++n) {
    if (family.parent[n] == none) open.push_back(n);
  }
  while (!open.empty()) {
    const std::uint32_t n = open.back();
    open.pop_back();
    reached[n] = true;
    open.insert(open.end(), family.children[n].begin(), family.children[n].end());
  }
  for (std::uint32_t n = 0; n < reached.size(); ++n) {
    if (!reached[n]) node_place(document, n).fail("is its own ancestor: the nodes form a cycle; export the file again");
  }
}

bool is_finite(const Mat4d& m) {
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      if (!std::isfinite(m[column][row])) return false;
    }
  }
  return true;
}

std::vector<std::uint32_t> roots_of(const std::optional<JsonPlace>& scene, const GltfNodes::Family& family) {
  std::vector<std::uint32_t> roots;
  if (!scene) {
    for (std::uint32_t n = 0; n < family.parent.size(); ++n) {
      if (family.parent[n] == none) roots.push_back(n);
    }
    return roots;
  }
  const auto list = scene->list("nodes");
  if (!list) return roots;
  std::vector<bool> listed(family.parent.size(), false);
  for (std::size_t i = 0; i < list->size(); ++i) {
    const std::uint64_t n = list->whole_item(i);
    if (n >= family.parent.size()) {
      scene->fail(fmt::format("names node {}, but there are {}, counted from 0; export the file again", n,
                              family.parent.size()));
    }
    if (listed[n]) scene->fail(fmt::format("names node {} twice; export the file again", n));
    if (family.parent[n] != none) {
      scene->fail(fmt::format("names node {} as a root, but it is a child of node {}; export the file again", n,
                              family.parent[n]));
    }
    listed[n] = true;
    roots.push_back(static_cast<std::uint32_t>(n));
  }
  return roots;
}

}  // namespace

std::optional<JsonPlace> gltf_scene(const GltfDocument& document, const std::optional<std::string>& choice) {
  const auto usual = choice ? std::nullopt : document.root().whole("scene");
  const auto index = usual ? usual : chosen_gltf_item(document, "scenes", "scene", choice);
  if (!index) return std::nullopt;
  return document.item("scenes", "scene", *index, document.root());
}

GltfNodes::GltfNodes(const GltfDocument& document, const GltfAnimation& animation)
    : document_(&document), animation_(&animation), family_(read_family(document)) {
  check_acyclic(document, family_);
}

Mat4d GltfNodes::to_parent(std::uint32_t node, std::optional<double> time) const {
  return animation_->to_parent(node_place(*document_, node), node, time);
}

std::vector<GltfNode> GltfNodes::placed(const std::optional<JsonPlace>& scene, std::optional<double> time) const {
  std::vector<GltfNode> placed;
  // A stack instead of recursion: a chain of nodes may be as long as the file.
  std::vector<GltfNode> open;
  const auto roots = roots_of(scene, family_);
  for (auto root = roots.rbegin(); root != roots.rend(); ++root) open.push_back({.index = *root});
  while (!open.empty()) {
    GltfNode node = open.back();
    open.pop_back();
    node.to_world = node.to_world * to_parent(node.index, time);
    node.moves = node.moves || animation_->moves(node.index);
    if (!is_finite(node.to_world)) {
      node_place(*document_, node.index).fail("its transform is not finite; export the file again");
    }
    placed.push_back(node);
    const auto& children = family_.children[node.index];
    for (auto child = children.rbegin(); child != children.rend(); ++child) {
      open.push_back({*child, node.to_world, node.moves, node.depth + 1});
    }
  }
  return placed;
}

std::vector<Mat4d> GltfNodes::to_world(std::optional<double> time) const {
  std::vector<Mat4d> all(family_.parent.size());
  for (const GltfNode& node : placed(std::nullopt, time)) all[node.index] = node.to_world;
  return all;
}

Mat4d GltfNodes::to_world(std::uint32_t node, std::optional<double> time) const {
  Mat4d placement = to_parent(node, time);
  for (std::uint32_t n = family_.parent[node]; n != none; n = family_.parent[n]) {
    placement = to_parent(n, time) * placement;
  }
  if (!is_finite(placement)) node_place(*document_, node).fail("its transform is not finite; export the file again");
  return placement;
}

}  // namespace penumbra
