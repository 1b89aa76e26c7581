#include "penumbra/render/ray_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "penumbra/render/direct_light.h"
#include "penumbra/tracing/shading/specular_tree.h"

namespace penumbra {
namespace {

// The sampler of lights that have no middle: the pixel (0, 0) of seed 0.
PixelSampler first_sample() { return {0, 0, 0, 0}; }

/// Notes the tree while SpecularTree walks it.
class Recorder final : public SpecularTree::Visitor {
 public:
  Recorder(const RayTracer& tracer, const RayTreeOptions& options, RayTree& tree)
      : tracer_(tracer),
        options_(options),
        direct_(tracer, !options.opaque_shadows, true),
        sampler_(first_sample()),
        tree_(tree) {}

  Rgb surface(const SpecularTree::Node& node) override {
    const std::int32_t number = begin(node.ray, node.branch.depth);
    TreeRay& ray = tree_.rays[static_cast<std::size_t>(number)];
    ray.end = TreeRay::End::surface;
    ray.length = length(node.point.position - node.ray.origin);
    ray.object = static_cast<std::int32_t>(node.point.object);
    ray.material = static_cast<std::int32_t>(node.point.material);
    ray.front = node.front;
    ray.weight = node.branch.weight;
    ray.split = split_at(node);
    const Rgb own = light_of(node, number);
    tree_.rays[static_cast<std::size_t>(number)].radiance = own;
    return own;
  }

  Rgb sky(const Ray& ray, const SpecularTree::Branch& branch) override {
    const std::int32_t number = begin(ray, branch.depth);
    TreeRay& noted = tree_.rays[static_cast<std::size_t>(number)];
    noted.end = TreeRay::End::left_scene;
    noted.length = std::numeric_limits<double>::infinity();
    noted.weight = branch.weight;
    noted.radiance = direct_.lights().seen_in_sky(ray.direction);
    return noted.radiance;
  }

  float followed(const Rgb& weight, int depth) override {
    const bool deep = depth >= options_.max_depth;
    const bool spent = max_component(weight) < static_cast<float>(options_.min_throughput);
    if (!deep && !spent) return 1;
    TreeRay ray;
    ray.parent = at_depth_[static_cast<std::size_t>(depth)];
    ray.kind = kind_of_next(ray.parent);
    ray.end = spent ? TreeRay::End::energy_spent : TreeRay::End::too_deep;
    ray.depth = depth + 1;
    const TreeRay& from = tree_.rays[static_cast<std::size_t>(ray.parent)];
    ray.origin = from.origin + from.length * from.direction;
    ray.weight = weight;
    tree_.rays.push_back(ray);
    return 0;
  }

  void count(bool refracted, int) override { refracted_ = refracted; }

 private:
  // A ray of the tree that was sent.
  std::int32_t begin(const Ray& ray, int depth) {
    const auto number = static_cast<std::int32_t>(tree_.rays.size());
    TreeRay noted;
    noted.depth = depth;
    noted.origin = ray.origin;
    noted.direction = ray.direction;
    if (depth > 0) {
      noted.parent = at_depth_[static_cast<std::size_t>(depth) - 1];
      noted.kind = refracted_ ? TreeRay::Kind::refraction : TreeRay::Kind::reflection;
    }
    at_depth_.resize(static_cast<std::size_t>(depth));
    at_depth_.push_back(number);
    tree_.rays.push_back(noted);
    return number;
  }

  // A surface sends its reflection first, where it has one.
  [[nodiscard]] TreeRay::Kind kind_of_next(std::int32_t parent) const {
    const bool reflects = !is_black(tree_.rays[static_cast<std::size_t>(parent)].split->reflected);
    const bool any = std::any_of(tree_.rays.begin() + parent, tree_.rays.end(), [&](const TreeRay& r) {
      return r.parent == parent && r.kind != TreeRay::Kind::shadow;
    });
    return reflects && !any ? TreeRay::Kind::reflection : TreeRay::Kind::refraction;
  }

  static TreeRay::Split split_at(const SpecularTree::Node& node) {
    const SpecularSplit specular = node.bsdf.specular_split(node.wo, followed_roughness);
    const float alpha = node.surface.alpha;
    TreeRay::Split split;
    split.reflected = alpha * specular.reflected;
    split.refracted = alpha * specular.refracted + Rgb(1 - alpha);
    const Rgb left = glm::max(Rgb(0), Rgb(1) - split.reflected - split.refracted);
    split.diffuse = glm::min(left, alpha * node.bsdf.diffuse_reflectance());
    split.absorbed = left - split.diffuse;
    return split;
  }

  // What the surface sends back by itself, with a shadow ray to each light.
  Rgb light_of(const SpecularTree::Node& node, std::int32_t number) {
    const Material& material = tracer_.scene().materials[node.point.material];
    const bool shines = material.unlit || emits_towards(material, node.point.geometric_normal, node.wo);
    Rgb radiance = shines ? node.surface.emission : Rgb(0);
    radiance += direct_.lights().ambient() * node.bsdf.diffuse_reflectance();
    if (!node.bsdf.has_spread()) return radiance;
    for (std::size_t light = 0; light < direct_.lights().light_count(); ++light) {
      const auto met = direct_.meet(node.point, node.bsdf, node.wo, followed_roughness, light, sampler_);
      if (!met) continue;
      radiance += met->radiance;
      note_shadow_ray(node, number, static_cast<std::int32_t>(light), *met);
    }
    return radiance;
  }

  void note_shadow_ray(const SpecularTree::Node& node, std::int32_t number, std::int32_t light,
                       const DirectLight::Meeting& met) {
    TreeRay ray;
    ray.parent = number;
    ray.kind = TreeRay::Kind::shadow;
    ray.depth = node.branch.depth;
    ray.origin = met.shadow_ray.origin;
    ray.direction = met.shadow_ray.direction;
    ray.length = met.shadow_ray.t_max;
    ray.weight = node.branch.weight;
    ray.radiance = met.radiance;
    ray.light = light;
    ray.end = TreeRay::End::light;
    if (is_black(met.radiance)) {
      ray.end = TreeRay::End::hidden;
      if (const auto blocker = tracer_.nearest(met.shadow_ray)) {
        ray.length = blocker->t;
        ray.object = static_cast<std::int32_t>(blocker->object);
        ray.material = static_cast<std::int32_t>(tracer_.surface_point(met.shadow_ray, *blocker).material);
      }
    }
    tree_.rays.push_back(ray);
  }

  const RayTracer& tracer_;
  const RayTreeOptions& options_;
  DirectLight direct_;
  PixelSampler sampler_;
  RayTree& tree_;
  std::vector<std::int32_t> at_depth_;  // the rays from the root to the surface that is looked at
  bool refracted_ = false;
};

// A surface's radiance so far is its own; here that of the rays it sent is added, weighed as the picture weighs them.
void add_what_children_bring(RayTree& tree) {
  for (std::size_t i = tree.rays.size(); i-- > 1;) {
    const TreeRay& child = tree.rays[i];
    if (child.kind == TreeRay::Kind::shadow || child.direction == Vec3d(0)) continue;
    TreeRay& parent = tree.rays[static_cast<std::size_t>(child.parent)];
    for (int band = 0; band < 3; ++band) {
      if (parent.weight[band] > 0)
        parent.radiance[band] += child.radiance[band] * child.weight[band] / parent.weight[band];
    }
  }
}

}  // namespace

RayTree make_ray_tree(const RayTracer& tracer, const Ray& primary, const RayTreeOptions& options) {
  RayTree tree;
  Recorder recorder(tracer, options, tree);
  const FilteredTextures textures(tracer);
  const SpecularTree::Branch root{.start = primary.origin, .differential = options.differential};
  tree.radiance = SpecularTree(tracer, options.front_sides_only, &textures).trace(primary, root, recorder);
  if (tree.rays.empty()) {  // a black back: nothing was asked of it
    TreeRay only;
    only.origin = primary.origin;
    only.direction = primary.direction;
    if (const auto hit = tracer.nearest(primary)) {
      only.length = hit->t;
      only.object = static_cast<std::int32_t>(hit->object);
    }
    tree.rays.push_back(only);
  }
  add_what_children_bring(tree);
  return tree;
}

std::string_view name_of(TreeRay::Kind kind) {
  switch (kind) {
    case TreeRay::Kind::primary:
      return "primary";
    case TreeRay::Kind::reflection:
      return "reflection";
    case TreeRay::Kind::refraction:
      return "refraction";
    case TreeRay::Kind::shadow:
      return "shadow";
  }
  return "";
}

std::string_view name_of(TreeRay::End end) {
  switch (end) {
    case TreeRay::End::surface:
      return "met a surface";
    case TreeRay::End::left_scene:
      return "left the scene";
    case TreeRay::End::energy_spent:
      return "not sent: too little energy left";
    case TreeRay::End::too_deep:
      return "not sent: too deep";
    case TreeRay::End::light:
      return "reached the light";
    case TreeRay::End::hidden:
      return "hidden from the light";
  }
  return "";
}

}  // namespace penumbra
