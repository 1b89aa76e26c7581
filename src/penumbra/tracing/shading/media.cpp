#include "penumbra/tracing/shading/media.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace penumbra {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// The part of the ray that lies in a box; empty (from >= to) when it misses.
Media::Interval clip(const Ray& ray, const Bounds& box) {
  Media::Interval in{0, ray.t_max};
  for (int axis = 0; axis < 3; ++axis) {
    if (ray.direction[axis] == 0) {
      if (ray.origin[axis] < box.lower[axis] || ray.origin[axis] > box.upper[axis]) return {0, 0};
      continue;
    }
    const double a = (box.lower[axis] - ray.origin[axis]) / ray.direction[axis];
    const double b = (box.upper[axis] - ray.origin[axis]) / ray.direction[axis];
    in.from = std::max(in.from, std::min(a, b));
    in.to = std::min(in.to, std::max(a, b));
  }
  return in;
}

bool holds(const Bounds& box, const Vec3d& p) {
  return p.x >= box.lower.x && p.y >= box.lower.y && p.z >= box.lower.z && p.x <= box.upper.x && p.y <= box.upper.y &&
         p.z <= box.upper.z;
}

// Chances of the bands, in proportion to what each carries.
Vec3d band_chances(const Rgb& throughput) {
  const Vec3d carried = glm::max(Vec3d(throughput), Vec3d(0));
  const double sum = carried.x + carried.y + carried.z;
  return sum > 0 ? carried / sum : Vec3d(1.0 / 3);
}

// A coefficient in a ray's bands; what is grey stays so to the last bit, and needs no joining of bands.
Rgb in_bands(const Rgb& sigma, const Bands& bands) {
  return sigma.x == sigma.y && sigma.y == sigma.z ? sigma : bands.reflectance(sigma);
}

int chosen_band(const Vec3d& chances, double u) {
  if (u < chances.x) return 0;
  return u < chances.x + chances.y || !(chances.z > 0) ? 1 : 2;
}

}  // namespace

Media::Media(const Scene& scene) : scene_(&scene) {
  const auto consider = [&](std::uint32_t index) {
    const Medium& m = scene.media[index];
    none_ = none_ && is_black(m.extinction());
    scatter_ = scatter_ || m.scatters();
  };
  for (const Medium& m : scene.media) {
    m.density ? fields_.emplace_back(DensityField(*m.density)) : fields_.emplace_back(std::nullopt);
  }
  for (const std::uint32_t index : scene.air) consider(index);
  for (const Material& m : scene.materials) {
    if (m.medium) consider(*m.medium);
  }
}

Media::Contents Media::contents(const Surroundings& around) const {
  Contents found;
  if (around) {
    if (const auto medium = scene_->materials[*around].medium) found.medium[found.count++] = *medium;
    return found;
  }
  for (const std::uint32_t index : scene_->air) found.medium[found.count++] = index;
  return found;
}

Media::Parts Media::parts(const Surroundings& around, const Ray& ray, const Bands& bands) const {
  Parts all;
  const Contents inside = contents(around);
  for (std::size_t i = 0; i < inside.count; ++i) {
    const std::uint32_t index = inside.medium[i];
    const Medium& m = scene_->media[index];
    Interval in{0, ray.t_max};
    if (m.box) in = clip(ray, *m.box);
    if (m.density) {
      const Interval grid = clip(ray, m.density->box);
      in = {std::max(in.from, grid.from), std::min(in.to, grid.to)};
    }
    if (!(in.from < in.to) || is_black(m.extinction())) continue;
    all.part[all.count++] = {index, in.from, in.to, in_bands(m.extinction(), bands)};
  }
  return all;
}

double Media::density(std::uint32_t medium, const Vec3d& point) const {
  const Medium& m = scene_->media[medium];
  if (m.box && !holds(*m.box, point)) return 0;
  if (!fields_[medium]) return 1;
  return holds(fields_[medium]->box(), point) ? fields_[medium]->at(point) : 0;
}

double Media::path_density(const Part& part, const Ray& ray, double to) const {
  const double end = std::min(part.to, to);
  if (end <= part.from) return 0;
  return fields_[part.medium] ? fields_[part.medium]->integral(ray, part.from, end) : end - part.from;
}

Vec3d Media::optical_depth(const Parts& parts, const Ray& ray, double to) const {
  Vec3d depth(0);
  for (const Part& part : parts) {
    const double density = path_density(part, ray, to);
    const Vec3d sigma(part.extinction);
    for (int band = 0; band < 3; ++band) {
      if (sigma[band] > 0) depth[band] += sigma[band] * density;  // the way may be infinite
    }
  }
  return depth;
}

Vec3d Media::optical_depth(const Surroundings& around, const Ray& ray, const Bands& bands) const {
  return optical_depth(parts(around, ray, bands), ray, ray.t_max);
}

Rgb Media::transmittance(const Surroundings& around, const Ray& ray, const Bands& bands) const {
  return Rgb(glm::exp(-optical_depth(around, ray, bands)));
}

std::optional<Media::Interval> Media::scattering_interval(const Surroundings& around, const Ray& ray) const {
  Interval all{infinity, 0};
  for (const Part& part : parts(around, ray, {})) {
    if (!scene_->media[part.medium].scatters()) continue;
    all = {std::min(all.from, part.from), std::max(all.to, part.to)};
  }
  if (all.from < all.to) return all;
  return std::nullopt;
}

Media::Lobes Media::lobes(const Surroundings& around, const Vec3d& point, const Bands& bands) const {
  Lobes found;
  const Contents inside = contents(around);
  for (std::size_t i = 0; i < inside.count; ++i) {
    const Medium& m = scene_->media[inside.medium[i]];
    if (!m.scatters()) continue;
    const auto thick = static_cast<float>(density(inside.medium[i], point));
    found.lobe[found.count++] = {thick * in_bands(m.scattering, bands), m.asymmetry};
  }
  return found;
}

Rgb Media::extinction(const Surroundings& around, const Vec3d& point, const Bands& bands) const {
  Rgb sum(0);
  const Contents inside = contents(around);
  for (std::size_t i = 0; i < inside.count; ++i) {
    const Rgb sigma = in_bands(scene_->media[inside.medium[i]].extinction(), bands);
    sum += static_cast<float>(density(inside.medium[i], point)) * sigma;
  }
  return sum;
}

// Where the next real collision in one band is. Between the ends of the parts the majorant is constant; a step beyond
// the next end is drawn anew from there, for exponential steps know no past.
std::optional<Media::Strike> Media::track(const Parts& parts, const Ray& ray, int band, double u,
                                          CounterRng& rng) const {
  std::array<double, 2 * most_media_in_air> ends;
  std::size_t count = 0;
  for (const Part& part : parts) ends[count++] = part.from, ends[count++] = part.to;
  std::sort(ends.begin(), ends.begin() + static_cast<std::ptrdiff_t>(count));

  const auto sigma = [&](const Part& part) { return static_cast<double>(part.extinction[band]); };
  double t = 0;
  for (std::size_t e = 0; e < count; ++e) {
    const double end = ends[e];
    double majorant = 0;
    for (const Part& part : parts) {
      if (part.from <= t && t < part.to && part.to > t) {
        majorant += sigma(part) * (fields_[part.medium] ? fields_[part.medium]->maximum() : 1);
      }
    }
    while (majorant > 0 && t < end) {
      t -= std::log1p(-u) / majorant;
      u = rng.next();
      if (!(t < end)) break;
      double choice = u * majorant;
      u = rng.next();
      for (const Part& part : parts) {
        if (t < part.from || t >= part.to) continue;
        choice -= sigma(part) * density(part.medium, ray.at(t));
        if (choice < 0) return Strike{t, part.medium};
      }
    }
    t = end;
  }
  return std::nullopt;
}

bool Media::is_grey(const Parts& parts) {
  return std::all_of(parts.begin(), parts.end(), [](const Part& part) {
    return part.extinction.x == part.extinction.y && part.extinction.y == part.extinction.z;
  });
}

Media::Flight Media::fly(const Surroundings& around, const Ray& ray, const Rgb& throughput, const Vec2d& u,
                         CounterRng& rng, const Bands& bands) const {
  const Parts in = parts(around, ray, bands);
  if (in.count == 0) return {};
  const Vec3d chances = band_chances(throughput);
  const int band = chosen_band(chances, u.x);
  const auto strike = track(in, ray, band, u.y, rng);

  // Density of what happened, had each band decided, relative to the one that did.
  Vec3d density(1);
  if (!is_grey(in)) {
    const Vec3d depth = optical_depth(in, ray, strike ? strike->distance : ray.t_max);
    for (int b = 0; b < 3; ++b) density[b] = depth[b] == depth[band] ? 1 : std::exp(depth[band] - depth[b]);
  }
  if (!strike) return {.weight = Rgb(density / dot(chances, density))};
  const Medium& medium = scene_->media[strike->medium];
  const Vec3d collided = Vec3d(in_bands(medium.extinction(), bands)) * density;
  return {.weight = Rgb(Vec3d(in_bands(medium.scattering, bands)) * density / dot(chances, collided)),
          .collided = true,
          .distance = strike->distance,
          .medium = strike->medium};
}

}  // namespace penumbra
