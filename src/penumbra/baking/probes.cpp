#include "penumbra/baking/probes.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "penumbra/baking/spherical_harmonics.h"
#include "penumbra/math/quadrature.h"
#include "penumbra/math/rng.h"
#include "penumbra/parallel/parallel_for.h"

namespace penumbra {
namespace {

using std::numbers::pi;
constexpr int lanes = RayPacket::size;

void check(const ProbeOptions& options) {
  for (const int n : options.count) {
    if (n < 1) throw std::invalid_argument("a grid of probes needs at least one along each axis");
  }
  if (options.rings < 3 || options.rings > max_tabled_gauss) {
    throw std::invalid_argument("rings of rays around a probe must be 3 to 64");
  }
  if (options.lamp_samples < 1) throw std::invalid_argument("a probe needs at least one shadow ray to each lamp");
}

std::vector<Vec3d> places(const Bounds& bounds, const std::array<int, 3>& count, bool at_ends) {
  std::vector<Vec3d> all;
  const auto along = [&](int axis, int k) {
    const int n = count[static_cast<std::size_t>(axis)];
    const double share = at_ends && n > 1 ? static_cast<double>(k) / (n - 1) : (k + 0.5) / n;
    return bounds.lower[axis] + share * (bounds.upper[axis] - bounds.lower[axis]);
  };
  for (int z = 0; z < count[2]; ++z) {
    for (int y = 0; y < count[1]; ++y) {
      for (int x = 0; x < count[0]; ++x) all.emplace_back(along(0, x), along(1, y), along(2, z));
    }
  }
  return all;
}

/// One probe: harmonics of what comes to it.
class Probe {
 public:
  Probe(const TexelSolution& solution, const Vec3d& position, std::uint64_t key)
      : solution_(solution), position_(position), key_(key) {}

  void add_lamps(std::uint32_t samples) {
    for (const auto& beam : solution_.straight().beams(position_, Vec3d(0), samples, key_)) {
      add(beam.direction, beam.irradiance);
    }
  }

  void add_rays(int rings) {
    const auto nodes = gauss_legendre(rings);
    CounterRng random(key_);
    RayPacket packet;
    Vec3d directions[lanes];
    float weights[lanes];
    int lane = 0;
    const int around = 2 * rings;
    for (const GaussNode& node : nodes) {
      const double z = 2 * node.x - 1, r = std::sqrt(1 - z * z), turn = random.next();
      for (int k = 0; k < around; ++k) {
        const double phi = 2 * pi * (k + turn) / around;
        directions[lane] = {r * std::cos(phi), r * std::sin(phi), z};
        weights[lane] = static_cast<float>(4 * pi * node.weight / around);
        if (++lane == lanes) trace(packet, directions, weights, lane), lane = 0;
      }
    }
    if (lane > 0) trace(packet, directions, weights, lane);
  }

  [[nodiscard]] const std::array<Rgb, 9>& sums() const { return sums_; }
  [[nodiscard]] bool is_inside() const { return 2 * backs_ > traced_; }

 private:
  void add(const Vec3d& direction, const Rgb& light) {
    const std::array<double, 9> y = spherical_harmonics(direction);
    for (std::size_t k = 0; k < 9; ++k) sums_[k] += static_cast<float>(y[k]) * light;
  }

  void trace(RayPacket& packet, const Vec3d (&directions)[lanes], const float (&weights)[lanes], int count) {
    for (int i = 0; i < lanes; ++i) {
      const Vec3f o(position_), d(directions[i < count ? i : 0]);
      packet.origin_x[i] = o.x, packet.origin_y[i] = o.y, packet.origin_z[i] = o.z;
      packet.direction_x[i] = d.x, packet.direction_y[i] = d.y, packet.direction_z[i] = d.z;
      packet.t_min[i] = 0, packet.t_max[i] = HUGE_VALF;
      packet.active[i] = i < count ? -1 : 0;
    }
    Landing landings[lanes];
    solution_.rays().trace(packet, hash_key(key_, ++packets_), landings);
    for (int i = 0; i < count; ++i) {
      const Landing& l = landings[i];
      ++traced_;
      Rgb radiosity = l.extra;
      if (l.side != Landing::nowhere) {
        radiosity += l.weight * Rgb(solution_.cells().radiosity(l.side));
        if (l.is_plain && (l.side & 1U) != 0) ++backs_;
      }
      add(directions[i], weights[i] / std::numbers::pi_v<float> * radiosity);
    }
  }

  const TexelSolution& solution_;
  Vec3d position_;
  std::uint64_t key_;
  std::uint64_t packets_ = 0;
  int traced_ = 0, backs_ = 0;
  std::array<Rgb, 9> sums_{};
};

}  // namespace

std::array<Rgb, 9> ProbeGrid::radiance(std::size_t probe) const {
  std::array<Rgb, 9> all;
  for (std::size_t k = 0; k < 9; ++k) {
    const float* c = coefficients.data() + 3 * (9 * probe + k);
    all[k] = {c[0], c[1], c[2]};
  }
  return all;
}

ProbeGrid bake_probes(const TexelSolution& solution, const ProbeOptions& options) {
  check(options);
  const bool own_bounds = !options.bounds.empty();
  const Bounds bounds = own_bounds ? options.bounds : solution.points().tracer().bounds();
  if (bounds.empty()) throw std::invalid_argument("a scene without surfaces needs bounds for its probes");
  ProbeGrid grid;
  grid.count = options.count;
  grid.positions = places(bounds, options.count, own_bounds);
  const std::size_t count = grid.positions.size();
  grid.coefficients.assign(27 * count, 0);
  grid.is_inside.assign(count, 0);
  const std::size_t round = std::max<std::size_t>(16, count / 64);
  for (std::size_t start = 0; start < count; start += round) {
    if (options.progress.stop_requested()) {
      grid.partial = true;
      break;
    }
    parallel_for(std::min(round, count - start), 1, [&](std::size_t first, std::size_t last) {
      for (std::size_t p = start + first; p < start + last; ++p) {
        Probe probe(solution, grid.positions[p], hash_key(options.seed, 6, p));
        probe.add_lamps(options.lamp_samples);
        probe.add_rays(options.rings);
        grid.is_inside[p] = probe.is_inside();
        for (std::size_t k = 0; k < 9; ++k) {
          for (int b = 0; b < 3; ++b) {
            grid.coefficients[3 * (9 * p + k) + static_cast<std::size_t>(b)] = probe.sums()[k][b];
          }
        }
      }
    });
    options.progress.tell("probes", static_cast<double>(std::min(count, start + round)) / static_cast<double>(count));
  }
  return grid;
}

}  // namespace penumbra
