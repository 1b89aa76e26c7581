#include "penumbra/render/ray_waves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "penumbra/render/ray_tally.h"
#include "penumbra/tracing/shading/checker.h"
#include "penumbra/tracing/shading/media.h"

namespace penumbra {
namespace {

constexpr int lanes = RayPacket::size;
constexpr std::size_t most_samples_a_batch = 2048;  // the waves of so many stay in the second-level cache
constexpr std::uint32_t root = 1;                   // of a tree of rays; a node's rays are 2 node and 2 node + 1

struct ColourLanes {
  Lanes r, g, b;
  void set(std::size_t i, const Rgb& c) { r[i] = c.x, g[i] = c.y, b[i] = c.z; }
  void add(std::size_t i, const Rgb& c) { r[i] += c.x, g[i] += c.y, b[i] += c.z; }
  [[nodiscard]] Rgb get(std::size_t i) const { return {r[i], g[i], b[i]}; }
};

}  // namespace

/// Sixteen rays, what they carry, and whose they are.
struct alignas(64) RayWaves::Wave {
  RayPacket rays;
  ColourLanes weight;
  std::uint32_t sample[lanes];
  std::uint32_t node[lanes];
  std::array<RayDifferential, RayPacket::size> differential;  // where something is filtered
  int used = 0;

  [[nodiscard]] Ray ray(int lane) const {
    return {.origin = {rays.origin_x[lane], rays.origin_y[lane], rays.origin_z[lane]},
            .direction = normalize(Vec3d(rays.direction_x[lane], rays.direction_y[lane], rays.direction_z[lane])),
            .time = static_cast<double>(rays.time[lane])};
  }
};

/// A light's points for sixteen surfaces, and its radiance there (or strength).
struct alignas(64) RayWaves::LightPoints {
  LightLanes lanes{};
  std::array<Rgb, RayPacket::size> radiance{};

  void set(std::size_t i, const PacketLight::Triangle& t, const Vec3f& position) {
    const int lane = static_cast<int>(i);
    lanes.position.set(lane, position);
    lanes.normal.set(lane, t.normal);
    lanes.inverse_density[i] = t.inverse_density;
    lanes.both_sides[i] = t.both_sides ? 1.0F : 0.0F;
    radiance[i] = t.radiance;
  }
};

/// What is known of sixteen surfaces while they are lit.
struct alignas(64) RayWaves::Lit {
  HitPacket hits;
  HitTriangles triangles;
  HitShapes shapes;
  PointLanes points;
  RayPacket shadow;
  Lanes geometry;
  ColourLanes reflectance, radiance;
  std::array<const PacketMaterial*, lanes> material{};  // none: missed, unused or shaded by itself
  std::int32_t lit[lanes] = {};                         // -1: matt, light can bring something
  bool any_glass = false, any_mirror = false, any_lit = false;
};

/// The samples that are drawn together, from their camera rays to the last wave.
class RayWaves::Batch {
 public:
  Batch(const RayWaves& owner, const Others& others, RayCounts& rays) : owner_(owner), others_(others), rays_(rays) {}

  void start(const PixelBlock& block);
  void trace();
  void add_to(Film& film) const { add_samples(samples_, film); }
  void clear() { samples_.clear(); }
  [[nodiscard]] std::size_t size() const { return samples_.size(); }

 private:
  void meet(Wave& wave);
  void classify(const Wave& wave, Lit& lit);
  void hand_over(const Wave& wave, int lane);
  void shine(const Wave& wave, Lit& lit) const;
  [[nodiscard]] static SurfacePoint surface_of(const Wave& wave, const Lit& lit, int lane);
  [[nodiscard]] float second_colour(const Wave& wave, const Lit& lit, int lane) const;
  [[nodiscard]] RayDifferential turned(const Wave& wave, const Lit& lit, int lane, const BounceLanes& bounce,
                                       bool refracted) const;
  void light(const Wave& wave, Lit& lit);
  void draw_points(const PacketLight& light, int number, const Wave& wave, const Lit& lit, LightPoints& points) const;
  void go_on(const Wave& wave, const Lit& lit);
  void follow(const Wave& wave, const Lit& lit, int lane, const BounceLanes& bounce, const Rgb& share, bool refracted);
  Wave& open_wave();
  [[nodiscard]] PixelSampler sampler(const Wave& wave, int lane) const;

  const RayWaves& owner_;
  const Others& others_;
  RayCounts& rays_;
  std::vector<PixelSample> samples_;
  std::vector<Wave> now_, next_;
  std::size_t next_count_ = 0;
  int depth_ = 0;
  std::uint64_t reflections_ = 0, refractions_ = 0;  // in the next wave
};

RayWaves::RayWaves(const RayTracer& tracer, const CameraRays& camera, const LightSampler& lights,
                   std::vector<PacketLight> packet_lights, const Options& options)
    : tracer_(tracer),
      camera_(camera, options.seed),
      lights_(lights),
      packet_lights_(std::move(packet_lights)),
      options_(options),
      shadow_(tracer, options.through_glass),
      surfaces_(tracer.scene()) {
  for (const PacketLight& l : packet_lights_) {
    const PacketLight::Triangle point{.v0 = l.position,
                                      .e1 = Vec3f(0),
                                      .e2 = Vec3f(0),
                                      .normal = Vec3f(0),
                                      .inverse_density = 1,
                                      .radiance = l.strength,
                                      .both_sides = false};
    const PacketLight::Triangle& t = l.kind == PacketLight::Kind::area ? l.triangles[0] : point;
    LightPoints& points = fixed_points_.emplace_back();
    for (std::size_t i = 0; i < lanes; ++i) points.set(i, t, t.v0);
  }
}

RayWaves::~RayWaves() = default;

std::unique_ptr<RayWaves> RayWaves::make(const RayTracer& tracer, const CameraRays& camera, const LightSampler& lights,
                                         const Options& options) {
  if (!camera.is_pinhole() || !Media(tracer.scene()).none()) return nullptr;
  auto packet_lights = penumbra::packet_lights(tracer.scene(), lights, options.at_middles);
  if (!packet_lights) return nullptr;
  return std::unique_ptr<RayWaves>(new RayWaves(tracer, camera, lights, std::move(*packet_lights), options));
}

void RayWaves::render(std::span<const PixelBlock> blocks, const Others& others, Film& film, RayCounts& rays) const {
  Batch batch(*this, others, rays);
  for (const PixelBlock& block : blocks) {
    batch.start(block);
    const bool full = batch.size() >= most_samples_a_batch;
    if (!full && &block != &blocks.back()) continue;
    batch.trace();
    batch.add_to(film);
    batch.clear();
  }
}

// The camera's rays: one packet for each sample of the block.
void RayWaves::Batch::start(const PixelBlock& block) {
  for (int number = block.first_sample; number < block.last_sample; ++number) {
    Wave& wave = open_wave();
    const std::size_t first = samples_.size();
    wave.used = owner_.camera_.aim(block, number, wave.rays, samples_);
    for (std::size_t i = 0; i < lanes; ++i) {
      wave.sample[i] = static_cast<std::uint32_t>(first + i);
      wave.node[i] = root;
      wave.weight.set(i, Rgb(1));
    }
    for (int lane = 0; owner_.filters() && lane < wave.used; ++lane) {
      wave.differential[static_cast<std::size_t>(lane)] = owner_.camera_.rays().differential(wave.ray(lane));
    }
  }
}

RayWaves::Wave& RayWaves::Batch::open_wave() {
  if (next_count_ == next_.size()) next_.emplace_back();
  Wave& wave = next_[next_count_++];
  wave.used = 0;
  return wave;
}

void RayWaves::Batch::trace() {
  count(rays_, RayPurpose::primary, 0, samples_.size());
  for (depth_ = 0; next_count_ > 0; ++depth_) {
    std::swap(now_, next_);
    const std::size_t waves = std::exchange(next_count_, 0);
    for (std::size_t i = 0; i < waves; ++i) {
      for (int lane = now_[i].used; lane < lanes; ++lane) now_[i].rays.active[lane] = 0;
      meet(now_[i]);
    }
    count(rays_, RayPurpose::reflection, depth_ + 1, std::exchange(reflections_, 0));
    count(rays_, RayPurpose::refraction, depth_ + 1, std::exchange(refractions_, 0));
  }
}

PixelSampler RayWaves::Batch::sampler(const Wave& wave, int lane) const {
  const PixelSampler random = owner_.camera_.sampler(samples_[wave.sample[lane]]);
  return wave.node[lane] == root ? random : random.at_node(wave.node[lane]);
}

void RayWaves::Batch::meet(Wave& wave) {
  Lit lit;
  owner_.tracer_.nearest(wave.rays, lit.hits, depth_ == 0);
  owner_.surfaces_.fetch(lit.hits, wave.used);
  classify(wave, lit);
  shine(wave, lit);
  if (lit.any_lit) light(wave, lit);
  for (int lane = 0; lane < wave.used; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    if (lit.material[i] != nullptr) {
      samples_[wave.sample[lane]].radiance += wave.weight.get(i) * lit.radiance.get(i);
    }
  }
  if (depth_ < owner_.options_.max_depth && (lit.any_glass || lit.any_mirror)) go_on(wave, lit);
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
    // A shading normal turned away from the eye is bent back by the scalar way.
    if (lit.material[i] == nullptr || lit.points.facing[i] > 0) continue;
    lit.material[i] = nullptr;
    hand_over(wave, lane);
  }
}

void RayWaves::Batch::hand_over(const Wave& wave, int lane) {
  const auto i = static_cast<std::size_t>(lane);
  const Rgb weight = wave.weight.get(i);
  const auto differential = owner_.filters() ? std::optional(wave.differential[i]) : std::nullopt;
  PixelSampler random = sampler(wave, lane);
  samples_[wave.sample[lane]].radiance +=
      weight * others_.trace(wave.ray(lane), weight, depth_, differential, random, rays_);
}

// What the scalar functions of differentials need to know of a lane's surface.
SurfacePoint RayWaves::Batch::surface_of(const Wave& wave, const Lit& lit, int lane) {
  const auto i = static_cast<std::size_t>(lane);
  const auto vector = [&](const VectorLanes& v) { return Vec3d(v.x[i], v.y[i], v.z[i]); };
  const double side = lit.points.front[i] != 0 ? 1 : -1;
  SurfacePoint point;
  point.position = vector(lit.points.position);
  point.geometric_normal = side * vector(lit.points.geometric);
  point.shading_normal = side * vector(lit.points.normal);
  point.object = lit.hits.object[lane];
  point.primitive = lit.hits.primitive[lane];
  point.time = static_cast<double>(wave.rays.time[lane]);
  return point;
}

// The share of a chequer's second colour.
float RayWaves::Batch::second_colour(const Wave& wave, const Lit& lit, int lane) const {
  const auto i = static_cast<std::size_t>(lane);
  const PacketMaterial& m = *lit.material[i];
  if (!owner_.filters()) return m.on_second_colour(lit.points, i) ? 1.0F : 0.0F;
  const SurfacePoint point = surface_of(wave, lit, lane);
  const Footprint footprint = footprint_of(wave.ray(lane), wave.differential[i], point);
  return second_colour_share(point, static_cast<double>(m.checker_size), footprint);
}

// The differential of a ray that goes on.
RayDifferential RayWaves::Batch::turned(const Wave& wave, const Lit& lit, int lane, const BounceLanes& bounce,
                                        bool refracted) const {
  const auto i = static_cast<std::size_t>(lane);
  const Ray ray = wave.ray(lane);
  const RayDifferential& before = wave.differential[i];
  const SurfacePoint point = surface_of(wave, lit, lane);
  const Footprint footprint = footprint_of(ray, before, point);
  const Vec3d& normal = point.shading_normal;
  if (!refracted) return reflected(owner_.tracer_, ray, before, footprint, point, normal);
  const Vec3d direction(bounce.direction.x[i], bounce.direction.y[i], bounce.direction.z[i]);
  const auto ior = static_cast<double>(lit.material[i]->ior);
  const double eta = lit.points.front[i] != 0 ? 1 / ior : ior;
  return penumbra::refracted(owner_.tracer_, ray, before, footprint, point, normal, direction, eta);
}

// Emission, ambient light and what shadow rays may bring to each surface.
void RayWaves::Batch::shine(const Wave& wave, Lit& lit) const {
  const Rgb ambient = owner_.lights_.ambient();
  for (std::size_t i = 0; i < lanes; ++i) {
    lit.lit[i] = 0;
    if (lit.material[i] == nullptr) continue;
    const PacketMaterial& m = *lit.material[i];
    Rgb radiance(0);
    if (m.double_sided || lit.points.front[i] != 0) radiance = m.emission;
    if (m.kind == PacketMaterial::Kind::glass) {
      lit.any_glass = true;
    } else {
      Rgb reflectance = m.reflectance[0];
      if (m.checker_size > 0) {
        reflectance = glm::mix(reflectance, m.reflectance[1], second_colour(wave, lit, static_cast<int>(i)));
      }
      radiance += ambient * reflectance;
      lit.reflectance.set(i, reflectance * std::numbers::inv_pi_v<float>);
      lit.lit[i] = is_black(reflectance) ? 0 : -1;
      lit.any_lit = lit.any_lit || lit.lit[i] != 0;
      lit.any_mirror = lit.any_mirror || !is_black(m.mirror);
    }
    lit.radiance.set(i, radiance);
  }
}

// One shadow ray from each matt lane to each light.
void RayWaves::Batch::light(const Wave& wave, Lit& lit) {
  LightPoints drawn;
  std::array<Rgb, lanes> passed;
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
    count(rays_, RayPurpose::shadow, depth_, cast);
    owner_.shadow_.transmittance(lit.shadow, is_fixed && depth_ == 0, passed);
    for (std::size_t i = 0; i < lanes; ++i) {
      if (lit.shadow.active[i] == 0) continue;
      lit.radiance.add(i, lit.reflectance.get(i) * on_light.radiance[i] * passed[i] * lit.geometry[i]);
    }
  }
}

// A random point of the light for each lane, the same as the scalar way draws.
void RayWaves::Batch::draw_points(const PacketLight& light, int number, const Wave& wave, const Lit& lit,
                                  LightPoints& points) const {
  for (int lane = 0; lane < lanes; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    if (lit.lit[lane] == 0) continue;
    PixelSampler random = sampler(wave, lane);
    random.skip(number);  // each light draws one point
    const Vec2d u = random.next_2d();
    float choice = static_cast<float>(u.x);
    const PacketLight::Triangle& t = light.choose(choice);
    const float square_root = std::sqrt(choice);  // uniform over a triangle, as sample_triangle
    const auto across = static_cast<float>(u.y);
    points.set(i, t, t.v0 + (square_root * (1 - across)) * t.e1 + (square_root * across) * t.e2);
  }
}

// The rays of the next wave.
void RayWaves::Batch::go_on(const Wave& wave, const Lit& lit) {
  BounceLanes reflected, refracted;
  if (lit.any_glass) {
    Lanes ior;
    for (std::size_t i = 0; i < lanes; ++i) ior[i] = lit.material[i] != nullptr ? lit.material[i]->ior : 1.0F;
    split_rays(wave.rays, lit.points, ior, reflected, refracted);
  }
  // Mirrors take the whole of the mirror image, which glass has scaled by Fresnel's term.
  BounceLanes mirrored;
  if (lit.any_mirror) reflect_rays(wave.rays, lit.points, mirrored);
  for (int lane = 0; lane < wave.used; ++lane) {
    const auto i = static_cast<std::size_t>(lane);
    if (lit.material[i] == nullptr) continue;
    const PacketMaterial& m = *lit.material[i];
    if (m.kind == PacketMaterial::Kind::matt) {
      if (!is_black(m.mirror)) follow(wave, lit, lane, mirrored, m.mirror, false);
      continue;
    }
    follow(wave, lit, lane, reflected, Rgb(1), false);
    follow(wave, lit, lane, refracted, m.tint, true);
  }
}

void RayWaves::Batch::follow(const Wave& wave, const Lit& lit, int lane, const BounceLanes& bounce, const Rgb& share,
                             bool refracted) {
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
  if (owner_.filters()) to.differential[k] = turned(wave, lit, lane, bounce, refracted);
  to.weight.set(k, weight);
  to.sample[k] = wave.sample[lane];
  to.node[k] = 2 * wave.node[lane] + (refracted ? 1 : 0);
  ++to.used;
  ++(refracted ? refractions_ : reflections_);
}

}  // namespace penumbra
