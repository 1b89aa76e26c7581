#include "penumbra/io/gltf_node.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>

namespace penumbra {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

struct Family {
  std::vector<std::uint32_t> parent;
  std::vector<std::vector<std::uint32_t>> children;
};

JsonPlace node_place(const GltfDocument& document, std::uint64_t index) {
  return document.item("nodes", "node", index, document.root());
}

Family read_family(const GltfDocument& document) {
  const std::size_t count = document.count("nodes");
  Family family{std::vector<std::uint32_t>(count, none), std::vector<std::vector<std::uint32_t>>(count)};
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
void check_acyclic(const GltfDocument& document, const Family& family) {
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

Mat4d rotation_of(const std::array<double, 4>& q, const JsonPlace& place) {
  const double size = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(size > 0) || !std::isfinite(size))
    place.fail("its rotation is no quaternion of length 1; export the file again");
  const double x = q[0] / size;
  const double y = q[1] / size;
  const double z = q[2] / size;
  const double w = q[3] / size;
  return {Vec4d(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0),
          Vec4d(2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x), 0),
          Vec4d(2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y), 0), Vec4d(0, 0, 0, 1)};
}

Mat4d to_parent(const JsonPlace& place) {
  if (place.has("matrix")) {
    const auto m = place.numbers<16>("matrix", {});
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1) {
      place.fail("its matrix is not affine (its last row must be 0 0 0 1); export the file again");
    }
    Mat4d matrix;
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 4; ++row) matrix[column][row] = m[static_cast<std::size_t>(4 * column + row)];
    }
    return matrix;
  }
  const auto t = place.numbers<3>("translation", {0, 0, 0});
  const auto r = place.numbers<4>("rotation", {0, 0, 0, 1});
  const auto s = place.numbers<3>("scale", {1, 1, 1});
  Mat4d matrix = rotation_of(r, place);
  for (int i = 0; i < 3; ++i) matrix[i] *= s[static_cast<std::size_t>(i)];
  matrix[3] = Vec4d(t[0], t[1], t[2], 1);
  return matrix;
}

bool is_finite(const Mat4d& m) {
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      if (!std::isfinite(m[column][row])) return false;
    }
  }
  return true;
}

std::vector<std::uint32_t> roots_of(const GltfDocument& document, const Family& family) {
  std::vector<std::uint32_t> roots;
  const auto scene = gltf_scene(document);
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

std::optional<JsonPlace> gltf_scene(const GltfDocument& document) {
  const auto index = document.root().whole("scene");
  if (!index && document.count("scenes") == 0) return std::nullopt;
  return document.item("scenes", "scene", index.value_or(0), document.root());
}

std::vector<GltfNode> placed_gltf_nodes(GltfDocument& document) {
  const Family family = read_family(document);
  check_acyclic(document, family);
  std::vector<GltfNode> placed;
  // A stack instead of recursion: a chain of nodes may be as long as the file.
  std::vector<GltfNode> open;
  const auto roots = roots_of(document, family);
  for (auto root = roots.rbegin(); root != roots.rend(); ++root) open.push_back({*root, Mat4d(1.0)});
  while (!open.empty()) {
    GltfNode node = open.back();
    open.pop_back();
    const JsonPlace place = node_place(document, node.index);
    node.to_world = node.to_world * to_parent(place);
    if (!is_finite(node.to_world)) place.fail("its transform is not finite; export the file again");
    placed.push_back(node);
    const auto& children = family.children[node.index];
    for (auto child = children.rbegin(); child != children.rend(); ++child) open.push_back({*child, node.to_world});
  }
  return placed;
}

}  // namespace penumbra
