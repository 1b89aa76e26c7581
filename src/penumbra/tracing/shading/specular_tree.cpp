#include "penumbra/tracing/shading/specular_tree.h"

namespace penumbra {

Rgb SpecularTree::trace(const Ray& ray, const Branch& branch, Visitor& visitor) const {
  const auto hit = tracer_.nearest(ray);
  if (!hit && media_.none()) return visitor.sky(ray, branch);
  if (!hit) {
    const Stretch way{ray, branch.interior.innermost(), branch};
    const Rgb scattered = media_.scatter() ? visitor.air(way) : Rgb(0);
    return scattered + media_.transmittance(way.around, ray, branch.bands) * visitor.sky(ray, branch);
  }
  const Scene& scene = tracer_.scene();
  const SurfacePoint point = tracer_.surface_point(ray, *hit);
  const Vec3d wo = -ray.direction;
  const bool front = dot(point.geometric_normal, wo) > 0;
  Rgb passed = branch.interior.transmittance(scene, point, front, length(point.position - branch.start), branch.bands);
  Rgb scattered(0);
  if (!media_.none()) {
    Stretch way{ray, branch.interior.around(scene, point, front), branch};
    way.ray.t_max = hit->t;
    if (media_.scatter()) scattered = visitor.air(way);
    passed *= media_.transmittance(way.around, way.ray, branch.bands);
  }
  if (front_sides_only_ && !front && scene.materials[point.material].transmission == 0) return scattered;

  const auto& differential = branch.differential;
  const bool filtered = textures_ != nullptr && differential;
  const Footprint footprint = filtered ? footprint_of(ray, *differential, point) : Footprint{};
  const auto view = filtered ? std::optional(FilteredTextures::View(*textures_, point, footprint)) : std::nullopt;
  const SurfaceMaterial surface = surface_material(scene, point, branch.bands, view ? &*view : nullptr);
  const Bsdf bsdf(surface, frame_towards(surface.shading, point.geometric_normal, wo), point.geometric_normal);
  Node node{ray, point, surface, bsdf, wo, front, passed, branch};
  node.branch.weight *= passed * surface.alpha;
  Rgb radiance = visitor.surface(node);
  const Material& material = scene.materials[point.material];
  if (branch.bands.spectral() && disperses(material)) {
    radiance += follow_dispersed(node, *material.dispersion, visitor);
  } else {
    const SpecularSplit split = bsdf.specular_split(wo, followed_roughness);
    if (!is_black(split.reflected)) {
      radiance += follow(
          point, node.branch, split.reflection_direction, split.reflected, false, visitor,
          filtered ? std::optional(reflected(tracer_, ray, *differential, footprint, point, bsdf.shading_normal()))
                   : std::nullopt);
    }
    if (!is_black(split.refracted)) {
      radiance += follow(
          point, node.branch, split.refraction_direction, split.refracted, true, visitor,
          filtered ? std::optional(refracted(tracer_, ray, *differential, footprint, point, bsdf.shading_normal(),
                                             split.refraction_direction, relative_index(surface, front)))
                   : std::nullopt);
    }
  }
  radiance *= surface.alpha;
  if (surface.alpha < 1) {
    node.branch.weight = branch.weight * passed;
    radiance += follow(point, node.branch, ray.direction, Rgb(1 - surface.alpha), true, visitor,
                       filtered ? std::optional(passed_on(*differential, footprint)) : std::nullopt);
  }
  return scattered + passed * radiance;
}

// Each wavelength has its own index, and so its own way on and its own share of the one mirror ray.
Rgb SpecularTree::follow_dispersed(const Node& node, const Dispersion& dispersion, Visitor& visitor) const {
  Rgb radiance(0);
  Rgb reflected(0);
  Vec3d reflection(0);
  SurfaceMaterial surface = node.surface;
  const Frame frame = frame_towards(surface.shading, node.point.geometric_normal, node.wo);
  for (int k = 0; k < 3; ++k) {
    if (node.branch.weight[k] == 0) continue;
    surface.ior =
        static_cast<float>(refractive_index(dispersion, node.branch.bands.wavelengths()[static_cast<std::size_t>(k)]));
    const SpecularSplit split =
        Bsdf(surface, frame, node.point.geometric_normal).specular_split(node.wo, followed_roughness);
    reflected[k] = split.reflected[k];
    if (reflected[k] > 0) reflection = split.reflection_direction;
    Rgb refracted(0);
    refracted[k] = split.refracted[k];
    if (refracted[k] > 0) {
      radiance += follow(node.point, node.branch, split.refraction_direction, refracted, true, visitor);
    }
  }
  if (!is_black(reflected)) radiance += follow(node.point, node.branch, reflection, reflected, false, visitor);
  return radiance;
}

Rgb SpecularTree::follow(const SurfacePoint& point, const Branch& from, const Vec3d& direction, const Rgb& weight,
                         bool refracted, Visitor& visitor, const std::optional<RayDifferential>& differential) const {
  const Rgb carried = from.weight * weight;
  const float times = visitor.followed(carried, from.depth);
  if (!(times > 0)) return Rgb(0);
  Branch child{.weight = times * carried,
               .depth = from.depth + 1,
               .start = point.position,
               .interior = from.interior,
               .differential = differential,
               .bands = from.bands};
  child.interior.cross(tracer_.scene(), point, direction, refracted);
  visitor.count(refracted, child.depth);
  return times * weight * trace(leave(point, direction), child, visitor);
}

}  // namespace penumbra
