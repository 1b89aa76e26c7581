#include "penumbra/render/ray_batch.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "penumbra/render/ray_tally.h"
#include "penumbra/render/sobol_lanes.h"

namespace penumbra {
namespace {

constexpr int lanes = RayPacket::size;
constexpr std::uint32_t root = 1;  // of a tree of rays

Vec3d vector_of(const VectorLanes& v, std::size_t i) { return {v.x[i], v.y[i], v.z[i]}; }

}  // namespace

Ray RayWaves::Wave::ray(int lane) const {
  return {.origin = {rays.origin_x[lane], rays.origin_y[lane], rays.origin_z[lane]},
          .direction = normalize(Vec3d(rays.direction_x[lane], rays.direction_y[lane], rays.direction_z[lane])),
          .time = static_cast<double>(rays.time[lane])};
}

RayDifferential RayWaves::Wave::differential_of(std::size_t i) const {
  return {vector_of(differential.origin_x, i), vector_of(differential.origin_y, i),
          vector_of(differential.direction_x, i), vector_of(differential.direction_y, i)};
}

void RayWaves::LightPoints::set(std::size_t i, const PacketLight::Triangle& t, const Vec3f& position) {
  const int lane = static_cast<int>(i);
  lanes.position.set(lane, position);
  lanes.normal.set(lane, t.normal);
  lanes.inverse_density[i] = t.inverse_density;
  lanes.both_sides[i] = t.both_sides ? 1.0F : 0.0F;
  radiance.set(i, t.radiance);
}

/// What is known of sixteen surfaces while they are lit.
struct alignas(64) RayWaves::Batch::Lit {
  explicit Lit(const HitPacket& met) : hits(met) {}

  const HitPacket& hits;
  HitTriangles triangles;
  HitShapes shapes;
  PointLanes points;
  FootprintLanes footprints;  // where something is filtered
  RayPacket shadow;
  Lanes geometry;
  ColourLanes reflectance, radiance;
  GlossLanes gloss;                                     // where any_gloss
  std::array<const PacketMaterial*, lanes> material{};  // none: missed, unused or shaded by itself
  std::int32_t lit[lanes];                              // -1: matt, light can bring something
  bool any_glass = false, any_mirror = false, any_lit = false, any_checker = false, any_gloss = false;
};

void RayWaves::Batch::start(const PixelBlock& block) {
  for (int number = block.first_sample; number < block.last_sample; ++number) {
    for (int y = block.y0; y < block.y1; ++y) {
      for (int x = block.x0; x < block.x1; ++x) samples_.push_back({x, y, number});
    }
  }
  while (samples_.size() - aimed_ >= lanes) aim(lanes);
}

// The camera's rays through the next samples: a packet.
void RayWaves::Batch::aim(std::size_t count) {
  Wave& wave = open_wave();
  owner_.camera_.aim(std::span(samples_).subspan(aimed_, count), wave.rays);
  wave.used = static_cast<int>(count);
  for (std::size_t i = 0; i < lanes; ++i) {
    wave.sample[i] = static_cast<std::uint32_t>(aimed_ + i);
    wave.node[i] = root;
    wave.weight.set(i, Rgb(1));
  }
  if (owner_.filters()) {
    const auto spacing = static_cast<float>(owner_.camera_.rays().spacing());
    aim_differentials(owner_.camera_.raster(), spacing, wave.rays, wave.differential);
  }
  aimed_ += count;
}

RayWaves::Wave& RayWaves::Batch::open_wave() {
  if (next_count_ == next_.size()) next_.emplace_back();
  Wave& wave = next_[next_count_++];
  wave.used = 0;
  return wave;
}

void RayWaves::Batch::trace(const Others& others, RayCounts& rays) {
  others_ = &others;
  rays_ = &rays;
  if (aimed_ < samples_.size()) aim(samples_.size() - aimed_);
  count(rays, RayPurpose::primary, 0, samples_.size());
  for (depth_ = 0; next_count_ > 0; ++depth_) {
    std::swap(now_, next_);
    trace_waves(std::exchange(next_count_, 0));
    count(rays, RayPurpose::reflection, depth_ + 1, std::exchange(reflections_, 0));
    count(rays, RayPurpose::refraction, depth_ + 1, std::exchange(refractions_, 0));
  }
}

// While waves are traced, memory brings what those before them met.
void RayWaves::Batch::trace_waves(std::size_t waves) {
  const PacketSurfaces& surfaces = owner_.surfaces_;
  std::array<HitPacket, 3> hits;
  const auto of = [&](std::size_t i) -> HitPacket& { return hits[i % hits.size()]; };
  for (std::size_t i = 0; i < waves + 2; ++i) {
    if (i < waves) {
      Wave& wave = now_[i];
      for (int lane = wave.used; lane < lanes; ++lane) wave.rays.active[lane] = 0;
      owner_.tracer_.nearest(wave.rays, of(i), depth_ == 0);
      surfaces.fetch_triangles(of(i), wave.used);
    }
    if (i >= 1 && i - 1 < waves) surfaces.fetch_corners(of(i - 1), now_[i - 1].used);
    if (i >= 2) shade(now_[i - 2], of(i - 2));
  }
}

PixelSampler RayWaves::Batch::sampler(const Wave& wave, int lane) const {
  const PixelSampler random = owner_.camera_.sampler(samples_[wave.sample[lane]]);
  return wave.node[lane] == root ? random : random.at_node(wave.node[lane]);
}

void RayWaves::Batch::shade(const Wave& wave, const HitPacket& hits) {
  Lit lit(hits);
  classify(wave, lit);
  const bool goes_on = depth_ < owner_.options_.max_depth && (lit.any_glass || lit.any_mirror);
  if (owner_.filters() && (lit.any_checker || goes_on)) {
    find_footprints(wave.rays, wave.differential, lit.points, lit.footprints);
  }
  shine(wave, lit);
  if (lit.any_lit) light(wave, lit);
  for (int lane = 0; lane < wave.used; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    if (lit.material[i] != nullptr) samples_[wave.sample[lane]].radiance += wave.weight.get(i) * lit.radiance.get(i);
  }
  if (goes_on) go_on(wave, lit);
}

// Works out points and normals; what missed or is shaded by itself is settled here.
void RayWaves::Batch::classify(const Wave& wave, Lit& lit) {
  bool triangles = false, shapes = false;
  for (int lane = 0; lane < wave.used; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    if (lit.hits.object[lane] == HitPacket::no_hit) {
      const Vec3d direction(wave.rays.direction_x[lane], wave.rays.direction_y[lane], wave.rays.direction_z[lane]);
      samples_[wave.sample[lane]].radiance += wave.weight.get(i) * owner_.lights_.environment().radiance(direction);
      continue;
    }
    lit.material[i] = owner_.surfaces_.gather(lit.hits, lane, lit.triangles, lit.shapes);
    if (lit.material[i] == nullptr) {
      hand_over(wave, lane);
      continue;
    }
    (lit.shapes.met[i] != 0 ? shapes : triangles) = true;
  }
  if (triangles) shade_points(wave.rays, lit.triangles, lit.points);
  if (shapes && !triangles) shade_shapes(wave.rays, lit.shapes, lit.points);
  if (shapes && triangles) {
    PointLanes on_shapes;
    shade_shapes(wave.rays, lit.shapes, on_shapes);
    choose_points(lit.shapes.met, on_shapes, lit.points);
  }
  for (int lane = 0; lane < wave.used; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    if (lit.material[i] == nullptr) continue;
    // A shading normal turned away from the eye is bent back by the scalar way.
    if (!(lit.points.facing[i] > 0)) {
      lit.material[i] = nullptr;
      hand_over(wave, lane);
      continue;
    }
    const PacketMaterial& m = *lit.material[i];
    lit.any_glass = lit.any_glass || m.kind == PacketMaterial::Kind::glass;
    lit.any_mirror = lit.any_mirror || m.mirrors;
    lit.any_checker = lit.any_checker || m.checker_size > 0;
    lit.any_gloss = lit.any_gloss || m.gloss;
  }
}

void RayWaves::Batch::hand_over(const Wave& wave, int lane) {
  const auto i = static_cast<std::size_t>(lane);
  const Rgb weight = wave.weight.get(i);
  const auto differential = owner_.filters() ? std::optional(wave.differential_of(i)) : std::nullopt;
  PixelSampler random = sampler(wave, lane);
  samples_[wave.sample[lane]].radiance +=
      weight * others_->trace(wave.ray(lane), weight, depth_, differential, random, *rays_);
}

// Emission, ambient light and what shadow rays may bring to each surface.
void RayWaves::Batch::shine(const Wave& wave, Lit& lit) const {
  for (std::size_t i = 0; i < lanes; ++i) {
    const PacketMaterial* const m = lit.material[i];
    const bool shines = m != nullptr && (m->double_sided || lit.points.front[i] != 0);
    lit.radiance.set(i, shines ? m->emission : Rgb(0));
    lit.reflectance.set(i, m != nullptr ? m->reflectance[0] : Rgb(0));
    lit.lit[i] = m != nullptr && m->scatters ? -1 : 0;
    lit.any_lit = lit.any_lit || lit.lit[i] != 0;
  }
  if (lit.any_checker) mix_checkers(wave, lit);
  if (lit.any_gloss) layer(lit);
  if (const Rgb ambient = owner_.lights_.ambient(); !is_black(ambient)) {
    add_ambient(lit.reflectance, ambient, lit.radiance);
  }
}

// What rough layers leave of the ambient light, which comes head on.
void RayWaves::Batch::layer(Lit& lit) const {
  const Rgb ambient = owner_.lights_.ambient();
  for (std::size_t i = 0; i < lanes; ++i) {
    const bool is_layered = lit.material[i] != nullptr && lit.material[i]->gloss;
    lit.gloss.set(i, is_layered ? &*lit.material[i]->gloss : nullptr, lit.points.facing[i]);
    if (!is_layered) continue;
    const float hidden = 1 - lit.material[i]->gloss->left_at(1);
    lit.radiance.set(i, lit.radiance.get(i) - hidden * ambient * lit.reflectance.get(i));
  }
}

void RayWaves::Batch::mix_checkers(const Wave& wave, Lit& lit) const {
  Lanes inverse_size{}, shares{};
  for (int lane = 0; lane < wave.used; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    const PacketMaterial* const m = lit.material[i];
    if (m == nullptr || !(m->checker_size > 0)) continue;
    inverse_size[i] = 1 / m->checker_size;
    if (!owner_.filters()) shares[i] = m->on_second_colour(lit.points, i) ? 1.0F : 0.0F;
  }
  if (owner_.filters()) average_checkers(lit.points, inverse_size, lit.footprints, shares);
  for (std::size_t i = 0; i < lanes; ++i) {
    if (inverse_size[i] > 0) {
      const PacketMaterial& m = *lit.material[i];
      lit.reflectance.set(i, glm::mix(m.reflectance[0], m.reflectance[1], shares[i]));
    }
  }
}

// One shadow ray from each matt lane to each light.
void RayWaves::Batch::light(const Wave& wave, Lit& lit) {
  LightPoints drawn;
  ColourLanes passed;
  std::copy(std::begin(wave.rays.time), std::end(wave.rays.time), std::begin(lit.shadow.time));
  for (std::size_t number = 0; number < owner_.packet_lights_.size(); ++number) {
    const PacketLight& one = owner_.packet_lights_[number];
    const bool is_fixed = one.kind != PacketLight::Kind::area || one.at_middle;
    if (!is_fixed) draw_points(one, static_cast<int>(number), wave, lit, drawn);
    const LightPoints& on_light = is_fixed ? owner_.fixed_points_[number] : drawn;
    if (one.kind == PacketLight::Kind::area) {
      aim_at_area(lit.points, on_light.lanes, lit.lit, lit.shadow, lit.geometry);
    } else {
      aim_at_point(lit.points, on_light.lanes, one.kind == PacketLight::Kind::far, one.inverse_square, one.range,
                   lit.lit, lit.shadow, lit.geometry);
    }
    std::uint64_t cast = 0;
    for (const std::int32_t a : lit.shadow.active) cast += a != 0 ? 1 : 0;
    if (cast == 0) continue;
    count(*rays_, RayPurpose::shadow, depth_, cast);
    owner_.packet_shadow_.transmittance(lit.shadow, is_fixed && depth_ == 0, passed);
    if (lit.any_gloss) {
      add_glossy_light(wave.rays, lit.points, lit.gloss, lit.reflectance, on_light.radiance, passed, lit.geometry,
                       lit.shadow, lit.radiance);
      continue;
    }
    add_light(lit.reflectance, on_light.radiance, passed, lit.geometry, lit.shadow, lit.radiance);
  }
}

// A random point of the light for each lane, the same as the scalar way draws.
void RayWaves::Batch::draw_points(const PacketLight& light, int number, const Wave& wave, const Lit& lit,
                                  LightPoints& points) const {
  KeyLanes key{};
  IndexLanes index{};
  for (int lane = 0; lane < lanes; ++lane) {
    if (lit.lit[lane] == 0) continue;
    const PixelSampler random = sampler(wave, lane);
    key[static_cast<std::size_t>(lane)] = random.key_after(number);  // each light draws one point
    index[static_cast<std::size_t>(lane)] = random.index();
  }
  Lanes which, across;
  owen_sobol_2d(index, key, which, across);
  for (std::size_t i = 0; i < lanes; ++i) {
    if (lit.lit[i] == 0) continue;
    float choice = which[i];
    const PacketLight::Triangle& t = light.choose(choice);
    const float square_root = std::sqrt(choice);  // uniform over a triangle, as sample_triangle
    points.set(i, t, t.v0 + (square_root * (1 - across[i])) * t.e1 + (square_root * across[i]) * t.e2);
  }
}

// The rays of the next wave.
void RayWaves::Batch::go_on(const Wave& wave, Lit& lit) {
  BounceLanes reflected, refracted, mirrored;
  DifferentialLanes of_reflected, of_refracted;
  FootprintLanes changes;
  Lanes ior;
  for (std::size_t i = 0; i < lanes; ++i) ior[i] = lit.material[i] != nullptr ? lit.material[i]->ior : 1.0F;
  if (lit.any_glass) split_rays(wave.rays, lit.points, ior, reflected, refracted);
  // Mirrors take the whole of the mirror image, which glass has scaled by Fresnel's term.
  if (lit.any_mirror) reflect_rays(wave.rays, lit.points, mirrored);
  if (owner_.filters()) {
    bend(wave, lit, changes);
    reflect_differentials(wave.rays, lit.points, wave.differential, lit.footprints, changes, of_reflected);
    if (lit.any_glass) {
      refract_differentials(wave.rays, lit.points, wave.differential, lit.footprints, changes, refracted, ior,
                            of_refracted);
    }
  }
  for (int lane = 0; lane < wave.used; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    if (lit.material[i] == nullptr) continue;
    const PacketMaterial& m = *lit.material[i];
    if (m.kind == PacketMaterial::Kind::matt) {
      if (m.mirrors) follow(wave, lane, mirrored, of_reflected, m.mirror, false);
      continue;
    }
    follow(wave, lane, reflected, of_reflected, Rgb(1), false);
    follow(wave, lane, refracted, of_refracted, m.tint, true);
  }
}

// How normals change over the footprints: spheres by their radius, triangles with normals of their own one by one.
void RayWaves::Batch::bend(const Wave& wave, const Lit& lit, FootprintLanes& changes) const {
  Lanes curvature{};
  for (std::size_t i = 0; i < lanes; ++i) {
    if (lit.material[i] != nullptr && lit.shapes.met[i] != 0 && lit.shapes.flat[i] == 0) {
      curvature[i] = 1 / lit.shapes.radius[i];
    }
  }
  bend_normals(lit.points, curvature, lit.footprints, changes);
  for (int lane = 0; lane < wave.used; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    const bool on_triangle = lit.material[i] != nullptr && lit.shapes.met[i] == 0;
    if (!on_triangle || lit.triangles.smooth[i] == 0) continue;
    const float side = lit.points.front[i] != 0 ? 1.0F : -1.0F;
    SurfacePoint point;
    point.position = vector_of(lit.points.position, i);
    point.object = lit.hits.object[lane];
    point.primitive = lit.hits.primitive[lane];
    const auto change = [&](const VectorLanes& step) {
      return side * Vec3f(owner_.tracer_.surface_change(point, vector_of(step, i)).normal);
    };
    changes.x.set(lane, change(lit.footprints.x));
    changes.y.set(lane, change(lit.footprints.y));
  }
}

namespace {

void copy_lane(const VectorLanes& from, std::size_t i, VectorLanes& to, std::size_t k) {
  to.x[k] = from.x[i];
  to.y[k] = from.y[i];
  to.z[k] = from.z[i];
}

}  // namespace

void RayWaves::Batch::follow(const Wave& wave, int lane, const BounceLanes& bounce,
                             const DifferentialLanes& differential, const Rgb& share, bool refracted) {
  const auto i = static_cast<std::size_t>(lane);
  if (!(bounce.chance[i] > 0)) return;
  const Rgb weight = wave.weight.get(i) * share * bounce.chance[i];
  if (is_black(weight) || max_component(weight) < owner_.options_.min_throughput) return;
  if (next_count_ == 0 || next_[next_count_ - 1].used == lanes) open_wave();
  Wave& to = next_[next_count_ - 1];
  const auto k = static_cast<std::size_t>(to.used);
  to.rays.origin_x[k] = bounce.origin.x[i];
  to.rays.origin_y[k] = bounce.origin.y[i];
  to.rays.origin_z[k] = bounce.origin.z[i];
  to.rays.direction_x[k] = bounce.direction.x[i];
  to.rays.direction_y[k] = bounce.direction.y[i];
  to.rays.direction_z[k] = bounce.direction.z[i];
  to.rays.t_min[k] = 0;
  to.rays.t_max[k] = std::numeric_limits<float>::infinity();
  to.rays.time[k] = wave.rays.time[i];
  to.rays.active[k] = -1;
  if (owner_.filters()) {
    copy_lane(differential.origin_x, i, to.differential.origin_x, k);
    copy_lane(differential.origin_y, i, to.differential.origin_y, k);
    copy_lane(differential.direction_x, i, to.differential.direction_x, k);
    copy_lane(differential.direction_y, i, to.differential.direction_y, k);
  }
  to.weight.set(k, weight);
  to.sample[k] = wave.sample[lane];
  to.node[k] = 2 * wave.node[lane] + (refracted ? 1 : 0);
  ++to.used;
  ++(refracted ? refractions_ : reflections_);
}

}  // namespace penumbra
