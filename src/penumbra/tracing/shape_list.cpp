#include "penumbra/tracing/shape_list.h"

#include <cmath>
#include <limits>
#include <span>

#include "penumbra/tracing/shape_intersection.h"

// Compiled once for each instruction set; the best one that the processor has is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "penumbra/tracing/shape_list.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace penumbra::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, 16>;
using D = hn::CappedTag<double, 8>;
using VF = hn::Vec<F>;
using VD = hn::Vec<D>;
constexpr std::size_t packet = RayPacket::size;

HWY_INLINE std::uint32_t bits_of(hn::Mask<F> mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(F(), mask, bytes);
  return (bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8) & ((1U << hn::Lanes(F())) - 1U);
}

HWY_INLINE VD promoted(const float* from) { return hn::PromoteTo(D(), hn::LoadU(hn::Rebind<float, D>(), from)); }

// What the sieve needs of sixteen rays, directions made unit.
struct SievedRays {
  alignas(64) float x[packet], y[packet], z[packet];
  alignas(64) float ox[packet], oy[packet], oz[packet];
  alignas(64) float along[packet];    // o.d
  alignas(64) float squared[packet];  // o.o (1 - slack)
};

HWY_INLINE void prepare(const RayPacket& rays, float slack, SievedRays& out) {
  const F d;
  for (std::size_t l = 0; l < packet; l += hn::Lanes(d)) {
    VF x = hn::Load(d, rays.direction_x + l), y = hn::Load(d, rays.direction_y + l),
       z = hn::Load(d, rays.direction_z + l);
    const VF scale = hn::Div(hn::Set(d, 1.0F), hn::Sqrt(hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)))));
    x = hn::Mul(x, scale), y = hn::Mul(y, scale), z = hn::Mul(z, scale);
    const VF ox = hn::Load(d, rays.origin_x + l), oy = hn::Load(d, rays.origin_y + l),
             oz = hn::Load(d, rays.origin_z + l);
    hn::Store(x, d, out.x + l), hn::Store(y, d, out.y + l), hn::Store(z, d, out.z + l);
    hn::Store(ox, d, out.ox + l), hn::Store(oy, d, out.oy + l), hn::Store(oz, d, out.oz + l);
    hn::Store(hn::MulAdd(ox, x, hn::MulAdd(oy, y, hn::Mul(oz, z))), d, out.along + l);
    hn::Store(hn::Mul(hn::Set(d, 1 - slack), hn::MulAdd(ox, ox, hn::MulAdd(oy, oy, hn::Mul(oz, oz)))), d,
              out.squared + l);
  }
}

// Lanes whose line may meet sphere `i`.
HWY_INLINE std::uint32_t sift(const SievedRays& rays, const SphereGroups::Sieve& sieve, std::size_t i) {
  const F d;
  const VF cx = hn::Set(d, sieve.centre_x[i]), cy = hn::Set(d, sieve.centre_y[i]), cz = hn::Set(d, sieve.centre_z[i]);
  const VF mx = hn::Set(d, sieve.minus_x[i]), my = hn::Set(d, sieve.minus_y[i]), mz = hn::Set(d, sieve.minus_z[i]);
  const VF reach = hn::Set(d, sieve.reach[i]);
  std::uint32_t met = 0;
  for (std::size_t l = 0; l < packet; l += hn::Lanes(d)) {
    const VF near = hn::MulAdd(hn::Load(d, rays.ox + l), mx,
                               hn::MulAdd(hn::Load(d, rays.oy + l), my,
                                          hn::MulAdd(hn::Load(d, rays.oz + l), mz, hn::Load(d, rays.squared + l))));
    const VF along =
        hn::NegMulAdd(hn::Load(d, rays.x + l), cx,
                      hn::NegMulAdd(hn::Load(d, rays.y + l), cy,
                                    hn::NegMulAdd(hn::Load(d, rays.z + l), cz, hn::Load(d, rays.along + l))));
    met |= bits_of(hn::Le(hn::NegMulAdd(along, along, near), reach)) << l;
  }
  return met;
}

// The crossings of lanes l... with a sphere, by the steps of `intersect` in shape_intersection.cpp: the first within
// (t_min, nearest). Returns the mask of lanes that have one.
HWY_INLINE hn::Mask<D> meet_sphere(const RayPacket& rays, std::size_t l, const Sphere& sphere, VD nearest, VD& t) {
  const D d;
  const VD fx = hn::Sub(promoted(rays.origin_x + l), hn::Set(d, sphere.centre.x));
  const VD fy = hn::Sub(promoted(rays.origin_y + l), hn::Set(d, sphere.centre.y));
  const VD fz = hn::Sub(promoted(rays.origin_z + l), hn::Set(d, sphere.centre.z));
  const VD x = promoted(rays.direction_x + l), y = promoted(rays.direction_y + l), z = promoted(rays.direction_z + l);
  const VD a = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
  const VD b = hn::Add(hn::Add(hn::Mul(fx, x), hn::Mul(fy, y)), hn::Mul(fz, z));
  const VD ratio = hn::Div(b, a);
  const VD gx = hn::Sub(fx, hn::Mul(ratio, x)), gy = hn::Sub(fy, hn::Mul(ratio, y)),
           gz = hn::Sub(fz, hn::Mul(ratio, z));
  const VD r2 = hn::Set(d, sphere.radius * sphere.radius);
  const VD discriminant = hn::Mul(a, hn::Sub(r2, hn::Add(hn::Add(hn::Mul(gx, gx), hn::Mul(gy, gy)), hn::Mul(gz, gz))));
  const VD zero = hn::Zero(d);
  const auto real = hn::And(hn::Ge(discriminant, zero), hn::Ne(a, zero));
  const VD c = hn::Sub(hn::Add(hn::Add(hn::Mul(fx, fx), hn::Mul(fy, fy)), hn::Mul(fz, fz)), r2);
  const VD q = hn::Neg(hn::Add(b, hn::CopySign(hn::Sqrt(hn::Max(discriminant, zero)), b)));
  const VD r0 = hn::Div(q, a);
  const VD r1 = hn::IfThenElse(hn::Eq(q, zero), r0, hn::Div(c, q));
  const VD first = hn::Min(r0, r1), second = hn::Max(r0, r1);
  const VD t_min = promoted(rays.t_min + l);
  const auto first_within = hn::And(hn::Gt(first, t_min), hn::Lt(first, nearest));
  const auto second_within = hn::And(hn::Gt(second, t_min), hn::Lt(second, nearest));
  t = hn::IfThenElse(first_within, first, second);
  return hn::And(real, hn::Or(first_within, second_within));
}

HWY_INLINE hn::Mask<D> meet_plane(const RayPacket& rays, std::size_t l, const Plane& plane, VD nearest, VD& t) {
  const D d;
  const VD nx = hn::Set(d, plane.normal.x), ny = hn::Set(d, plane.normal.y), nz = hn::Set(d, plane.normal.z);
  const VD slope =
      hn::Add(hn::Add(hn::Mul(nx, promoted(rays.direction_x + l)), hn::Mul(ny, promoted(rays.direction_y + l))),
              hn::Mul(nz, promoted(rays.direction_z + l)));
  const VD wx = hn::Sub(hn::Set(d, plane.point.x), promoted(rays.origin_x + l));
  const VD wy = hn::Sub(hn::Set(d, plane.point.y), promoted(rays.origin_y + l));
  const VD wz = hn::Sub(hn::Set(d, plane.point.z), promoted(rays.origin_z + l));
  t = hn::Div(hn::Add(hn::Add(hn::Mul(wx, nx), hn::Mul(wy, ny)), hn::Mul(wz, nz)), slope);
  return hn::And(hn::Ne(slope, hn::Zero(d)), hn::And(hn::Gt(t, promoted(rays.t_min + l)), hn::Lt(t, nearest)));
}

// What has been met so far: distances, and the number of the entry in the order of spheres and planes.
struct Nearest {
  alignas(64) double t[packet];
  alignas(64) double entry[packet];  // -1: none; numbers as doubles, to be chosen with the distances
};

template <class Meet>
HWY_INLINE void take_nearer(const Meet& meet, std::size_t l, double entry, Nearest& best) {
  const D d;
  VD t = hn::Zero(d);
  const VD before = hn::Load(d, best.t + l);
  const auto met = meet(before, t);
  hn::Store(hn::IfThenElse(met, t, before), d, best.t + l);
  hn::Store(hn::IfThenElse(met, hn::Set(d, entry), hn::Load(d, best.entry + l)), d, best.entry + l);
}

// Visits the spheres that lanes of `active` may meet, with those lanes; `visit` returns the lanes still to be served.
template <class Visit>
HWY_INLINE void sift_all(const SievedRays& rays, const SphereGroups& spheres, std::uint32_t active,
                         const Visit& visit) {
  for (std::size_t g = 0; g < spheres.groups.size() && active != 0; ++g) {
    if ((sift(rays, spheres.around[g / SphereGroups::Sieve::size], g % SphereGroups::Sieve::size) & active) == 0)
      continue;
    const SphereGroups::Group& group = spheres.groups[g];
    for (std::size_t k = 0; k < group.count; ++k) {
      const std::uint32_t may = sift(rays, group.sieve, k) & active;
      if (may != 0) active = visit(group.first + k, may, active);
    }
  }
}

void nearest_lanes(const RayPacket& rays, const SphereGroups& spheres, std::span<const ShapeList::PlaneEntry> planes,
                   float slack, std::uint32_t active, double* t, double* entry) {
  const D d;
  const std::size_t n = hn::Lanes(d);
  const std::uint32_t all = (1U << n) - 1U;
  Nearest best;
  for (std::size_t l = 0; l < packet; l += n) {
    hn::Store(promoted(rays.t_max + l), d, best.t + l);
    hn::Store(hn::Set(d, -1.0), d, best.entry + l);
    if ((active >> l & all) == 0) continue;
    for (std::size_t i = 0; i < planes.size(); ++i) {
      take_nearer([&](VD before, VD& at) { return meet_plane(rays, l, planes[i].plane, before, at); }, l,
                  static_cast<double>(spheres.entries.size() + i), best);
    }
  }
  if (!spheres.entries.empty()) {
    SievedRays sieved;
    prepare(rays, slack, sieved);
    sift_all(sieved, spheres, active, [&](std::size_t i, std::uint32_t may, std::uint32_t left) {
      for (std::size_t l = 0; l < packet; l += n) {
        if ((may >> l & all) == 0) continue;
        take_nearer([&](VD before, VD& at) { return meet_sphere(rays, l, spheres.entries[i].sphere, before, at); }, l,
                    static_cast<double>(i), best);
      }
      return left;
    });
  }
  for (std::size_t i = 0; i < packet; ++i) t[i] = best.t[i], entry[i] = best.entry[i];
}

HWY_INLINE std::uint32_t bits_of(hn::Mask<D> mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(D(), mask, bytes);
  return bytes[0] & ((1U << hn::Lanes(D())) - 1U);
}

// The lanes of `active` in whose way nothing stands.
std::uint32_t free_lanes(const RayPacket& rays, const SphereGroups& spheres,
                         std::span<const ShapeList::PlaneEntry> planes, float slack, std::uint32_t active) {
  const D d;
  const std::size_t n = hn::Lanes(d);
  const std::uint32_t all = (1U << n) - 1U;
  VD t = hn::Zero(d);
  for (const ShapeList::PlaneEntry& p : planes) {
    for (std::size_t l = 0; l < packet; l += n) {
      if ((active >> l & all) == 0) continue;
      active &= ~(bits_of(meet_plane(rays, l, p.plane, promoted(rays.t_max + l), t)) << l);
    }
  }
  if (spheres.entries.empty() || active == 0) return active;
  SievedRays sieved;
  prepare(rays, slack, sieved);
  sift_all(sieved, spheres, active, [&](std::size_t i, std::uint32_t may, std::uint32_t) {
    for (std::size_t l = 0; l < packet; l += n) {
      if ((may >> l & all) == 0) continue;
      active &= ~(bits_of(meet_sphere(rays, l, spheres.entries[i].sphere, promoted(rays.t_max + l), t)) << l);
    }
    return active;
  });
  return active;
}

// Of sixteen spheres those that one line may meet. @param line direction (unit), origin, o.d and o.o (1 - slack).
std::uint32_t sift_spheres(const SphereGroups::Sieve& sieve, const float* line) {
  const F d;
  const VF x = hn::Set(d, line[0]), y = hn::Set(d, line[1]), z = hn::Set(d, line[2]);
  const VF ox = hn::Set(d, line[3]), oy = hn::Set(d, line[4]), oz = hn::Set(d, line[5]);
  const VF od = hn::Set(d, line[6]), oo = hn::Set(d, line[7]);
  std::uint32_t met = 0;
  for (std::size_t l = 0; l < SphereGroups::Sieve::size; l += hn::Lanes(d)) {
    const VF near =
        hn::MulAdd(ox, hn::Load(d, sieve.minus_x + l),
                   hn::MulAdd(oy, hn::Load(d, sieve.minus_y + l), hn::MulAdd(oz, hn::Load(d, sieve.minus_z + l), oo)));
    const VF along = hn::NegMulAdd(
        x, hn::Load(d, sieve.centre_x + l),
        hn::NegMulAdd(y, hn::Load(d, sieve.centre_y + l), hn::NegMulAdd(z, hn::Load(d, sieve.centre_z + l), od)));
    met |= bits_of(hn::Le(hn::NegMulAdd(along, along, near), hn::Load(d, sieve.reach + l))) << l;
  }
  return met;
}

}  // namespace penumbra::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace penumbra {
namespace {

HWY_EXPORT(nearest_lanes);
HWY_EXPORT(free_lanes);
HWY_EXPORT(sift_spheres);

constexpr float slack = SphereGroups::slack;

struct Line {
  float values[8];

  explicit Line(const Ray& ray) {
    const Vec3f o(ray.origin);
    const Vec3f d(normalize(ray.direction));
    const float all[8] = {d.x, d.y, d.z, o.x, o.y, o.z, dot(o, d), dot(o, o) * (1 - slack)};
    std::copy(std::begin(all), std::end(all), values);
  }
};

std::uint32_t active_bits(const RayPacket& rays) {
  std::uint32_t bits = 0;
  for (int i = 0; i < RayPacket::size; ++i) bits |= (rays.active[i] != 0 ? 1U : 0U) << i;
  return bits;
}

Ray lane_ray(const RayPacket& rays, int i, double t_max) {
  return {.origin = {rays.origin_x[i], rays.origin_y[i], rays.origin_z[i]},
          .direction = {rays.direction_x[i], rays.direction_y[i], rays.direction_z[i]},
          .t_min = rays.t_min[i],
          .t_max = t_max};
}

}  // namespace

void ShapeList::add(const Shape& shape, std::uint32_t object) {
  if (const auto* plane = std::get_if<Plane>(&shape)) {
    planes_.push_back({*plane, object});
    return;
  }
  const auto* sphere = std::get_if<Sphere>(&shape);
  if (sphere == nullptr) {
    others_.push_back({shape, object});
    return;
  }
  spheres_.add(*sphere, object);
}

namespace {

// Calls `visit` with the number of each sphere that a line may meet, until it returns true.
template <class Visit>
bool sift_line(const SphereGroups& spheres, const Ray& ray, const Visit& visit) {
  if (spheres.groups.empty()) return false;
  const Line line(ray);
  for (std::size_t k = 0; k < spheres.around.size(); ++k) {
    std::uint32_t groups = HWY_DYNAMIC_DISPATCH(sift_spheres)(spheres.around[k], line.values);
    for (; groups != 0; groups &= groups - 1) {
      const auto number = SphereGroups::Sieve::size * k + static_cast<std::size_t>(__builtin_ctz(groups));
      const SphereGroups::Group& group = spheres.groups[number];
      std::uint32_t may = HWY_DYNAMIC_DISPATCH(sift_spheres)(group.sieve, line.values);
      for (; may != 0; may &= may - 1) {
        if (visit(group.first + static_cast<std::size_t>(__builtin_ctz(may)))) return true;
      }
    }
  }
  return false;
}

}  // namespace

std::optional<ShapeList::Crossing> ShapeList::nearest(const Ray& ray) const {
  std::optional<Crossing> best;
  Ray rest = ray;
  const auto take = [&](const auto& shape, std::uint32_t object) {
    if (const auto t = intersect(shape, rest)) best = Crossing{rest.t_max = *t, object};
  };
  for (const PlaneEntry& p : planes_) take(p.plane, p.object);
  sift_line(spheres_, ray, [&](std::size_t i) {
    take(spheres_.entries[i].sphere, spheres_.entries[i].object);
    return false;
  });
  for (const OtherEntry& o : others_) {
    std::visit([&](const auto& shape) { take(shape, o.object); }, o.shape);
  }
  return best;
}

bool ShapeList::occluded(const Ray& ray) const {
  for (const PlaneEntry& p : planes_) {
    if (intersect(p.plane, ray)) return true;
  }
  const auto is_met = [&](std::size_t i) { return intersect(spheres_.entries[i].sphere, ray).has_value(); };
  if (sift_line(spheres_, ray, is_met)) return true;
  for (const OtherEntry& o : others_) {
    if (std::visit([&](const auto& shape) { return intersect(shape, ray).has_value(); }, o.shape)) return true;
  }
  return false;
}

void ShapeList::nearest(const RayPacket& rays, HitPacket& hits) const {
  alignas(64) double t[RayPacket::size];
  alignas(64) double entry[RayPacket::size];
  const std::uint32_t active = active_bits(rays);
  HWY_DYNAMIC_DISPATCH(nearest_lanes)(rays, spheres_, planes_, slack, active, t, entry);
  for (int i = 0; i < RayPacket::size; ++i) {
    hits.object[i] = HitPacket::no_hit;
    hits.t[i] = rays.t_max[i];
    if ((active >> i & 1U) == 0) continue;
    Vec3d normal(0);
    if (entry[i] >= 0) {
      const auto number = static_cast<std::size_t>(entry[i]);
      const std::size_t spheres = spheres_.entries.size();
      hits.object[i] = number < spheres ? spheres_.entries[number].object : planes_[number - spheres].object;
      const auto along = [&](float from, float way) { return static_cast<double>(from) + t[i] * way; };
      normal = number < spheres
                   ? Vec3d(along(rays.origin_x[i], rays.direction_x[i]), along(rays.origin_y[i], rays.direction_y[i]),
                           along(rays.origin_z[i], rays.direction_z[i])) -
                         spheres_.entries[number].sphere.centre
                   : planes_[number - spheres].plane.normal;
    }
    for (const OtherEntry& o : others_) {
      const Ray rest = lane_ray(rays, i, t[i]);
      const auto at = std::visit([&](const auto& shape) { return intersect(shape, rest); }, o.shape);
      if (!at) continue;
      t[i] = *at;
      hits.object[i] = o.object;
      normal = shape_normal(o.shape, rest.at(*at));
    }
    if (hits.object[i] == HitPacket::no_hit) continue;
    hits.t[i] = static_cast<float>(t[i]);
    hits.normal_x[i] = static_cast<float>(normal.x);
    hits.normal_y[i] = static_cast<float>(normal.y);
    hits.normal_z[i] = static_cast<float>(normal.z);
    hits.u[i] = hits.v[i] = 0;
    hits.primitive[i] = 0;
  }
}

void ShapeList::occluded(RayPacket& rays) const {
  std::uint32_t free = HWY_DYNAMIC_DISPATCH(free_lanes)(rays, spheres_, planes_, slack, active_bits(rays));
  for (int i = 0; i < RayPacket::size; ++i) {
    if (others_.empty() || (free >> i & 1U) == 0) continue;
    const Ray ray = lane_ray(rays, i, rays.t_max[i]);
    for (const OtherEntry& o : others_) {
      if (std::visit([&](const auto& shape) { return intersect(shape, ray).has_value(); }, o.shape)) {
        free &= ~(1U << i);
        break;
      }
    }
  }
  for (int i = 0; i < RayPacket::size; ++i) {
    if ((free >> i & 1U) == 0) rays.active[i] = 0;
  }
}

}  // namespace penumbra

#endif
