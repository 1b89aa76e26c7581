#include "penumbra/baking/texel_rays.h"

#include <algorithm>
#include <numbers>

#include "penumbra/tracing/shading/bsdf.h"
#include "penumbra/tracing/shading/fresnel.h"
#include "penumbra/tracing/shading/light_sampling.h"
#include "penumbra/tracing/shading/surface_material.h"

namespace penumbra {
namespace {

constexpr auto pi = std::numbers::pi_v<float>;
constexpr int most_turns = 32;
constexpr float least_weight = 1e-3F;

/// What may happen to a ray at a surface, by how much of the light it makes up.
struct Shares {
  float pass = 0;  // straight through what is half transparent
  float diffuse = 0;
  float mirror = 0;
  float metal = 0;
  float glass = 0;
};

Shares shares_of(const SurfaceMaterial& m, const Rgb& albedo, bool emits) {
  Shares s;
  s.pass = 1 - m.alpha;
  s.diffuse = std::max(max_component(albedo), emits ? 0.5F : 0.0F);
  s.mirror = max_component(m.mirror);
  s.metal = m.metallic * (1 - s.mirror);
  s.glass = (1 - m.metallic) * m.transmission * (1 - s.mirror);
  const float rest = s.diffuse + s.mirror + s.metal + s.glass;
  if (rest > 0) {
    for (float* share : {&s.diffuse, &s.mirror, &s.metal, &s.glass}) *share *= m.alpha / rest;
  }
  return s;
}

/// The diffuse part, without the layer over it.
Rgb diffuse_albedo(SurfaceMaterial m, const Vec3d& geometric_normal) {
  m.specular = 0;
  return Bsdf(m, m.shading, geometric_normal).diffuse_reflectance();
}

}  // namespace

TexelRays::TexelRays(const SamplePoints& points, const AtlasSpace& space, const StraightLamps& lamps)
    : points_(points),
      tracer_(points.tracer()),
      map_(points.map()),
      lamps_(lamps),
      environment_(points.map().atlas().scene),
      metals_(points.map(), space) {
  const LightmapAtlas& atlas = map_.atlas();
  kinds_.resize(atlas.first_triangle.back());
  for (std::size_t i = 0; i + 1 < atlas.first_triangle.size(); ++i) {
    const Mesh& mesh = atlas.scene.meshes[atlas.scene.instances[i].mesh];
    for (std::uint32_t t = atlas.first_triangle[i]; t < atlas.first_triangle[i + 1]; ++t) {
      kinds_[t] = kind_of(atlas.scene.materials[mesh.material_of(t - atlas.first_triangle[i])]);
    }
  }
}

TexelRays::Kind TexelRays::kind_of(const Material& m) {
  if (is_opaque_metal(m)) return Kind::metal;
  const bool is_matt = m.unlit || (m.transmission == 0 && is_black(m.mirror) && m.alpha_mode != AlphaMode::blend);
  return is_matt ? Kind::matt : Kind::other;
}

std::uint32_t TexelRays::texel_at(const Hit& hit, std::uint32_t triangle, bool back) const {
  const std::uint32_t texel =
      map_.at(triangle, static_cast<float>(hit.barycentric.x), static_cast<float>(hit.barycentric.y));
  if (texel == TexelMap::none || !points_.is_cut(texel)) return texel;
  const SurfacePoint p = tracer_.surface_point({}, hit);
  const Place place{p.position, p.geometric_normal, p.shading_normal};
  return points_.on_side_of(back ? place.reversed() : place, texel);
}

Rgb TexelRays::sky(const Vec3d& direction) const {
  return environment_.lights_surfaces() ? pi * environment_.radiance(direction) : Rgb(0);
}

void TexelRays::trace(const RayPacket& rays, std::uint64_t key, Landing (&landings)[RayPacket::size]) const {
  HitPacket hits;
  tracer_.nearest(rays, hits);
  const auto& first_triangle = map_.atlas().first_triangle;
  for (int i = 0; i < RayPacket::size; ++i) {
    Landing& landing = landings[i];
    landing = {};
    if (rays.active[i] == 0) continue;
    const auto direction = [&] { return Vec3d(rays.direction_x[i], rays.direction_y[i], rays.direction_z[i]); };
    if (hits.object[i] == HitPacket::no_hit) {
      landing.extra = sky(normalize(direction()));
      continue;
    }
    const std::uint32_t triangle = first_triangle[hits.object[i]] + hits.primitive[i];
    if (kinds_[triangle] != Kind::matt) {
      Ray ray{.origin = {rays.origin_x[i], rays.origin_y[i], rays.origin_z[i]}, .direction = normalize(direction())};
      const Hit hit{hits.t[i], hits.object[i], hits.primitive[i], {hits.u[i], hits.v[i]}};
      landing = follow(ray, hit, hash_key(key, i));
      continue;
    }
    const float side = rays.direction_x[i] * hits.normal_x[i] + rays.direction_y[i] * hits.normal_y[i] +
                       rays.direction_z[i] * hits.normal_z[i];
    const bool back = side > 0;
    const Hit hit{hits.t[i], hits.object[i], hits.primitive[i], {hits.u[i], hits.v[i]}};
    const std::uint32_t texel = texel_at(hit, triangle, back);
    if (texel != TexelMap::none) landing.side = 2 * texel + (back ? 1U : 0U);
  }
}

Landing TexelRays::follow(Ray ray, Hit hit, std::uint64_t key) const {
  CounterRng random(key);
  Landing landing;
  for (int turns = 0; turns < most_turns; ++turns) {
    const std::uint32_t triangle = map_.atlas().first_triangle[hit.object] + hit.primitive;
    const bool back = dot(ray.direction, map_.texels().normals_of[triangle]) > 0;
    const std::uint32_t texel = texel_at(hit, triangle, back);
    Turn turn{.fate = Turn::Fate::ends};
    if (kinds_[triangle] == Kind::metal) turn = turn_at_metal(ray, hit, texel, random);
    if (kinds_[triangle] == Kind::other) turn = turn_at_other(ray, hit, random);
    landing.weight *= turn.weight;
    if (turn.fate == Turn::Fate::ends) {
      landing.is_plain = turns == 0 && turn.weight == Rgb(1.0F);
      if (texel != TexelMap::none) landing.side = 2 * texel + (back ? 1U : 0U);
      // Straight light does not go by mirrors.
      if (turns > 0 && lamps_.holds(triangle, back)) {
        landing.extra = landing.weight * pi * map_.atlas().scene.materials[map_.material(triangle)].emission;
      }
      return landing;
    }
    if (turn.fate == Turn::Fate::is_lost || max_component(landing.weight) < least_weight) break;
    ray = turn.ray;
    const auto next = tracer_.nearest(ray);
    if (!next) {
      landing.is_plain = false;
      landing.extra = landing.weight * sky(ray.direction);
      break;
    }
    hit = *next;
  }
  return landing;
}

TexelRays::Turn TexelRays::turn_at_metal(const Ray& ray, const Hit& hit, std::uint32_t texel,
                                         CounterRng& random) const {
  const float ending = texel == TexelMap::none ? 1.0F : metals_.ending(texel);
  if (ending == 1 || random.next() < static_cast<double>(ending)) return {Turn::Fate::ends, Rgb(1 / ending), {}};
  const SurfacePoint p = tracer_.surface_point(ray, hit);
  const SurfaceMaterial m = metals_.metal(texel, map_.atlas().scene.materials[p.material]);
  const Frame shading = frame_towards(m.shading, p.geometric_normal, -ray.direction);
  const Vec2d u{random.next(), random.next()};
  const auto sample = Bsdf(m, shading, p.geometric_normal).sample(-ray.direction, random.next(), u);
  if (!sample || max_component(sample->weight) <= 0) return {};
  return {Turn::Fate::goes_on, sample->weight * (metals_.metallic(texel) / (1 - ending)), leave(p, sample->direction)};
}

TexelRays::Turn TexelRays::turn_at_other(const Ray& ray, const Hit& hit, CounterRng& random) const {
  const Scene& scene = map_.atlas().scene;
  const SurfacePoint p = tracer_.surface_point(ray, hit);
  SurfaceMaterial m = surface_material(scene, p);
  const Vec3d wo = -ray.direction;
  const bool back = dot(wo, p.geometric_normal) < 0;
  Rgb weight(1);
  if (back && m.transmission > 0 && !m.thin_walled) {
    const Material& glass = scene.materials[p.material];
    weight = volume_transmittance(glass.attenuation_colour, glass.attenuation_distance, hit.t);
  }
  const Shares shares = shares_of(m, diffuse_albedo(m, p.geometric_normal), !is_black(m.emission));
  double u = random.next();
  const Vec2d u2{random.next(), random.next()};
  const double u_lobe = random.next();
  const auto chosen = [&](float share) { return share > 0 && (u -= static_cast<double>(share)) < 0; };
  if (chosen(shares.pass)) return {Turn::Fate::goes_on, weight, leave(p, ray.direction)};
  if (chosen(shares.diffuse)) return {Turn::Fate::ends, weight * (m.alpha / shares.diffuse), {}};
  const Frame shading = frame_towards(m.shading, p.geometric_normal, wo);
  if (chosen(shares.mirror)) {
    const Vec3d out = reflect(wo, back ? -shading.normal : shading.normal);
    return {Turn::Fate::goes_on, weight * m.mirror * (m.alpha / shares.mirror), leave(p, out)};
  }
  const bool metal = chosen(shares.metal);
  const float share = metal ? m.metallic : (1 - m.metallic) * m.transmission;
  const float chance = metal ? shares.metal : shares.glass;
  if (!(chance > 0)) return {};
  weight *= Rgb(1 - max_component(m.mirror)) * (share * m.alpha / chance);
  m.metallic = metal ? 1.0F : 0.0F;
  m.transmission = metal ? 0.0F : 1.0F;
  m.mirror = Rgb(0);
  const auto sample = Bsdf(m, shading, p.geometric_normal).sample(wo, u_lobe, u2);
  if (!sample || max_component(sample->weight) <= 0) return {};
  return {Turn::Fate::goes_on, weight * sample->weight, leave(p, sample->direction)};
}

}  // namespace penumbra
