#include "penumbra/render/path_waves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "penumbra/render/path_shading.h"
#include "penumbra/render/path_survival.h"
#include "penumbra/render/ray_tally.h"
#include "penumbra/render/sobol_lanes.h"
#include "penumbra/render/spectral_sample.h"
#include "penumbra/render/wave_queue.h"
#include "penumbra/tracing/shading/media.h"

namespace penumbra {
namespace {

constexpr std::size_t lanes = RayPacket::size;
constexpr std::size_t most_samples_a_batch = 4096;  // the waves of so many stay in the second-level cache

// The random numbers of one bounce, in the order of path.cpp.
enum Draw : int { which_lamp, point_on_lamp, lobe, direction, survival };

// Materials that show something to wavelengths only.
bool has_spectra(const Scene& scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& m) { return m.fluorescence || m.emission_spectrum; });
}

// All triangles of all lamps as one lamp, chosen among by power.
std::optional<PacketLight> all_lamps(const std::vector<PacketLight>& lights) {
  PacketLight all;
  double power = 0;
  for (const PacketLight& light : lights) {
    if (light.kind != PacketLight::Kind::area) return std::nullopt;
    for (std::size_t i = 0; i < light.triangles.size(); ++i) {
      const PacketLight::Triangle& t = light.triangles[i];
      const double area = 0.5 * length(cross(Vec3d(t.e1), Vec3d(t.e2)));
      const double own = area * luminance(t.radiance) * (t.both_sides ? 2 : 1);
      if (!(own > 0)) return std::nullopt;
      power += own;
      all.triangles.push_back(t);
      all.triangles.back().inverse_density = static_cast<float>(area / own);  // times all power, below
      all.cdf.push_back(static_cast<float>(power));
    }
  }
  if (all.triangles.empty()) return std::nullopt;
  for (PacketLight::Triangle& t : all.triangles) t.inverse_density *= static_cast<float>(power);
  for (float& c : all.cdf) c /= static_cast<float>(power);
  all.cdf.back() = 1;
  return all;
}

}  // namespace

/// Sixteen paths at their next ray.
struct alignas(64) PathWaves::Wave {
  RayPacket rays;
  Lanes r, g, b;  // throughput
  Lanes density;  // of the ray's direction, 1/sr
  std::uint32_t sample[lanes];
  int used = 0;

  [[nodiscard]] Rgb throughput(std::size_t i) const { return {r[i], g[i], b[i]}; }
};

/// What is known of the surfaces that sixteen paths met.
struct alignas(64) PathWaves::Lit {
  HitPacket hits;
  HitTriangles triangles;
  HitShapes shapes;
  PointLanes points;
  LightLanes on_lamp{};
  RayPacket shadow;
  Lanes geometry;
  std::array<const PacketMaterial*, lanes> material{};
  std::array<Rgb, lanes> reflectance{};
  std::int32_t lit[lanes] = {};
  IndexLanes index{};  // of random numbers
  KeyLanes key{};      // of the bounce's first random number
};

/// The paths that are traced together.
class PathWaves::Batch {
 public:
  Batch(const PathWaves& owner, RayCounts& rays) : owner_(owner), rays_(rays) {}

  void start(const PixelBlock& block);
  void trace();
  void add_to(Film& film);
  void clear() { samples_.clear(), bands_.clear(); }
  [[nodiscard]] std::size_t size() const { return samples_.size(); }

 private:
  void meet(std::span<const Wave> waves);
  void go_on(const Wave& wave, const HitPacket& hits);
  void classify(const Wave& wave, Lit& lit);
  void shine(const Wave& wave, std::size_t i, const Lit& lit);
  void light(const Wave& wave, Lit& lit);
  void bounce(const Wave& wave, const Lit& lit);
  [[nodiscard]] static KeyLanes keys(const Lit& lit, Draw draw);
  void shine_on(const Wave& wave, std::size_t i, const Rgb& light) { samples_[wave.sample[i]].radiance += light; }
  [[nodiscard]] const Bands& bands(const Wave& wave, std::size_t i) const {
    return bands_.empty() ? red_green_blue_ : bands_[wave.sample[i]];
  }

  const PathWaves& owner_;
  RayCounts& rays_;
  std::vector<PixelSample> samples_;
  std::vector<Bands> bands_;  // of each sample, where they are wavelengths
  const Bands red_green_blue_{};
  WaveQueue<Wave> queue_;
  int depth_ = 0;
  int numbers_before_ = 0;  // drawn by each path before this bounce
  std::uint64_t bounces_ = 0;
};

PathWaves::PathWaves(const RayTracer& tracer, const CameraRays& camera, const LightSampler& lights, PacketLight lamps,
                     const Options& options)
    : tracer_(tracer),
      camera_(camera, options.seed),
      lights_(lights),
      lamps_(std::move(lamps)),
      options_(options),
      surfaces_(tracer) {}

PathWaves::~PathWaves() = default;

std::unique_ptr<PathWaves> PathWaves::make(const RayTracer& tracer, const CameraRays& camera,
                                           const LightSampler& lights, const Options& options) {
  if (!camera.is_pinhole() || !Media(tracer.scene()).none() || !PacketSurfaces(tracer.scene()).all_matt()) {
    return nullptr;
  }
  if (options.spectral && has_spectra(tracer.scene())) return nullptr;
  const auto packet_lights = penumbra::packet_lights(tracer.scene(), lights, false);
  if (!packet_lights) return nullptr;
  auto lamps = all_lamps(*packet_lights);
  if (!lamps) return nullptr;
  return std::unique_ptr<PathWaves>(new PathWaves(tracer, camera, lights, std::move(*lamps), options));
}

void PathWaves::render(std::span<const PixelBlock> blocks, Film& film, RayCounts& rays) const {
  Batch batch(*this, rays);
  for (const PixelBlock& block : blocks) {
    batch.start(block);
    if (batch.size() < most_samples_a_batch && &block != &blocks.back()) continue;
    batch.trace();
    batch.add_to(film);
    batch.clear();
  }
}

void PathWaves::Batch::start(const PixelBlock& block) {
  for (int number = block.first_sample; number < block.last_sample; ++number) {
    Wave& wave = queue_.add();
    const std::size_t first = samples_.size();
    wave.used = owner_.camera_.aim(block, number, wave.rays, samples_);
    wave.r.fill(1), wave.g.fill(1), wave.b.fill(1), wave.density.fill(0);
    for (std::size_t i = 0; i < lanes; ++i) wave.sample[i] = static_cast<std::uint32_t>(first + i);
    for (std::size_t i = first; owner_.options_.spectral && i < samples_.size(); ++i) {
      PixelSampler random = owner_.camera_.sampler(samples_[i]);
      bands_.push_back(sample_bands(true, random));
    }
  }
}

void PathWaves::Batch::add_to(Film& film) {
  for (std::size_t i = 0; i < bands_.size(); ++i) samples_[i].radiance = bands_[i].to_rgb(samples_[i].radiance);
  add_samples(samples_, film);
}

void PathWaves::Batch::trace() {
  count(rays_, RayPurpose::primary, 0, samples_.size());
  numbers_before_ = owner_.options_.spectral ? 1 : 0;
  depth_ = 0;
  for (std::span<Wave> waves = queue_.advance(); !waves.empty(); waves = queue_.advance(), ++depth_) {
    meet(waves);
    count(rays_, RayPurpose::diffuse, depth_ + 1, std::exchange(bounces_, 0));
    numbers_before_ += depth_ + 1 > sure_bounces ? survival + 1 : survival;
  }
}

// While waves are traced, memory brings what those before them met.
void PathWaves::Batch::meet(std::span<const Wave> waves) {
  std::array<HitPacket, 3> hits;
  const auto of = [&](std::size_t i) -> HitPacket& { return hits[i % hits.size()]; };
  for (std::size_t i = 0; i < waves.size() + 2; ++i) {
    if (i < waves.size()) {
      owner_.tracer_.nearest(waves[i].rays, of(i), depth_ == 0);
      owner_.surfaces_.fetch_triangles(of(i), waves[i].used);
    }
    if (i >= 1 && i - 1 < waves.size()) owner_.surfaces_.fetch_corners(of(i - 1), waves[i - 1].used);
    if (i >= 2) go_on(waves[i - 2], of(i - 2));
  }
}

void PathWaves::Batch::go_on(const Wave& wave, const HitPacket& hits) {
  Lit lit;
  lit.hits = hits;
  classify(wave, lit);
  if (owner_.options_.max_depth > 0 && depth_ >= owner_.options_.max_depth) return;
  light(wave, lit);
  bounce(wave, lit);
}

// Works out points and normals, and adds what the surfaces shine.
void PathWaves::Batch::classify(const Wave& wave, Lit& lit) {
  bool triangles = false, shapes = false;
  const auto used = static_cast<std::size_t>(wave.used);
  for (std::size_t i = 0; i < used; ++i) {
    if (lit.hits.object[i] == HitPacket::no_hit) {
      if (depth_ > 0) continue;
      const Vec3d direction(wave.rays.direction_x[i], wave.rays.direction_y[i], wave.rays.direction_z[i]);
      shine_on(wave, i, bands(wave, i).emission(owner_.lights_.environment().radiance(direction)));
      continue;
    }
    lit.material[i] = owner_.surfaces_.gather(lit.hits, static_cast<int>(i), lit.triangles, lit.shapes);
    (lit.shapes.met[i] != 0 ? shapes : triangles) = true;
  }
  if (triangles) shade_points(wave.rays, lit.triangles, lit.points);
  if (shapes && !triangles) shade_shapes(wave.rays, lit.shapes, lit.points);
  if (shapes && triangles) {
    PointLanes on_shapes;
    shade_shapes(wave.rays, lit.shapes, on_shapes);
    choose_points(lit.shapes.met, on_shapes, lit.points);
  }
  for (std::size_t i = 0; i < used; ++i) {
    if (lit.material[i] == nullptr) continue;
    if (!is_black(lit.material[i]->emission)) shine(wave, i, lit);
    if (lit.points.facing[i] <= 0) turn_towards_eye(wave.rays, i, lit.points);
    lit.reflectance[i] = bands(wave, i).reflectance(lit.material[i]->reflectance[0]);
    lit.lit[i] = is_black(lit.reflectance[i]) ? 0 : -1;
    const PixelSampler random = owner_.camera_.sampler(samples_[wave.sample[i]]);
    lit.index[i] = random.index();
    lit.key[i] = random.key_after(numbers_before_);
  }
}

// Emission that the path ran into, weighted against the chance that its last shadow ray found it.
void PathWaves::Batch::shine(const Wave& wave, std::size_t i, const Lit& lit) {
  const PacketMaterial& m = *lit.material[i];
  if (!m.double_sided && lit.points.front[i] == 0) return;
  float share = 1;
  if (wave.density[i] > 0) {
    // A lamp's points are chosen by power, so their density is that of any triangle of the same radiance.
    const float t = lit.hits.t[i];
    const float cosine = std::abs(lit.points.geometric.x[i] * wave.rays.direction_x[i] +
                                  lit.points.geometric.y[i] * wave.rays.direction_y[i] +
                                  lit.points.geometric.z[i] * wave.rays.direction_z[i]);
    const PacketLight::Triangle& lamp = owner_.lamps_.triangles.front();
    const float brighter = luminance(m.emission) * (m.double_sided ? 2.0F : 1.0F) /
                           (luminance(lamp.radiance) * (lamp.both_sides ? 2.0F : 1.0F));
    const float ratio = t * t * brighter / (std::max(cosine, 1e-9F) * lamp.inverse_density * wave.density[i]);
    share = 1 / (1 + ratio * ratio);
  }
  shine_on(wave, i, share * wave.throughput(i) * bands(wave, i).emission(m.emission));
}

KeyLanes PathWaves::Batch::keys(const Lit& lit, Draw draw) {
  KeyLanes keys;
  for (std::size_t i = 0; i < lanes; ++i) keys[i] = PixelSampler::later_key(lit.key[i], draw);
  return keys;
}

// A shadow ray from each path to a point of one lamp.
void PathWaves::Batch::light(const Wave& wave, Lit& lit) {
  Lanes which, u, v;
  owner_.lamps_.triangles.size() > 1 ? owen_sobol_1d(lit.index, keys(lit, which_lamp), which) : which.fill(0);
  owen_sobol_2d(lit.index, keys(lit, point_on_lamp), u, v);
  std::array<Rgb, lanes> radiance{};
  for (std::size_t i = 0; i < lanes; ++i) {
    if (lit.lit[i] == 0) continue;
    float choice = which[i];
    const PacketLight::Triangle& t = owner_.lamps_.choose(choice);
    const float root = std::sqrt(u[i]);  // uniform over a triangle, as sample_triangle
    const int lane = static_cast<int>(i);
    lit.on_lamp.position.set(lane, t.v0 + (root * (1 - v[i])) * t.e1 + (root * v[i]) * t.e2);
    lit.on_lamp.normal.set(lane, t.normal);
    lit.on_lamp.inverse_density[i] = t.inverse_density;
    lit.on_lamp.both_sides[i] = t.both_sides ? 1.0F : 0.0F;
    radiance[i] = t.radiance;
  }
  aim_at_area(lit.points, lit.on_lamp, lit.lit, lit.shadow, lit.geometry);
  std::copy(std::begin(wave.rays.time), std::end(wave.rays.time), std::begin(lit.shadow.time));
  share_with_bounce(lit.points, lit.shadow, lit.geometry);
  std::uint64_t cast = 0;
  for (const std::int32_t a : lit.shadow.active) cast += a != 0 ? 1 : 0;
  if (cast == 0) return;
  count(rays_, RayPurpose::shadow, depth_, cast);
  owner_.tracer_.occluded(lit.shadow, false);
  for (std::size_t i = 0; i < lanes; ++i) {
    if (lit.shadow.active[i] == 0) continue;
    const Rgb arriving = bands(wave, i).emission(radiance[i]) * (lit.geometry[i] * std::numbers::inv_pi_v<float>);
    shine_on(wave, i, wave.throughput(i) * lit.reflectance[i] * arriving);
  }
}

// The paths that go on, in ranks of sixteen again.
void PathWaves::Batch::bounce(const Wave& wave, const Lit& lit) {
  Lanes u, v, density, luck;
  owen_sobol_2d(lit.index, keys(lit, direction), u, v);
  const bool may_end = depth_ + 1 > sure_bounces;
  if (may_end) owen_sobol_1d(lit.index, keys(lit, survival), luck);
  BounceLanes scattered;
  scatter_rays(lit.points, u, v, scattered, density);
  for (std::size_t i = 0; i < static_cast<std::size_t>(wave.used); ++i) {
    if (lit.lit[i] == 0 || scattered.chance[i] == 0) continue;
    Rgb throughput = wave.throughput(i) * lit.reflectance[i];
    if (may_end) {
      const auto chance = static_cast<float>(survival_chance(throughput));
      if (luck[i] >= chance) continue;
      throughput /= chance;
    }
    Wave& to = queue_.with_room();
    put_ray(scattered, i, wave.rays.time[i], to.rays, to.used);
    const auto k = static_cast<std::size_t>(to.used++);
    to.r[k] = throughput.x, to.g[k] = throughput.y, to.b[k] = throughput.z;
    to.density[k] = density[i];
    to.sample[k] = wave.sample[i];
    ++bounces_;
  }
}

}  // namespace penumbra
