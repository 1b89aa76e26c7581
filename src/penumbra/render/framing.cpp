#include "penumbra/render/framing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "penumbra/math/sampling.h"
#include "penumbra/math/sobol.h"

namespace penumbra {
namespace {

constexpr int probe_rays = 256;
constexpr double margin = 1.05;  // room around an object in the picture

// Distances to the nearest surface all around a point; infinite where a ray leaves the scene.
struct Surroundings {
  std::vector<Vec3d> directions;
  std::vector<double> distances;
  double enclosed = 0;  // share of directions that meet a surface

  Surroundings(const RayTracer& tracer, const Vec3d& eye) {
    int met = 0;
    for (std::uint32_t i = 0; i < probe_rays; ++i) {
      const Vec3d direction = sample_sphere(owen_sobol_2d(i, 0));
      const auto hit = tracer.nearest({.origin = eye, .direction = direction});
      directions.push_back(direction);
      distances.push_back(hit ? hit->t : std::numeric_limits<double>::infinity());
      met += hit ? 1 : 0;
    }
    enclosed = static_cast<double>(met) / probe_rays;
  }

  [[nodiscard]] double nearest() const { return *std::min_element(distances.begin(), distances.end()); }
};

// The point of a coarse grid that stands freest inside the scene; a room has one with surfaces all around it.
struct Standpoint {
  Vec3d eye{0};
  double clearance = -1;  // m to the nearest surface
};

Standpoint find_standpoint(const RayTracer& tracer, const Bounds& bounds, const Vec3d& up) {
  Standpoint best;
  constexpr int grid = 5;
  for (int z = 1; z < grid; ++z) {
    for (int y = 1; y < grid; ++y) {
      for (int x = 1; x < grid; ++x) {
        const Vec3d eye = bounds.lower + bounds.extent() * Vec3d(x, y, z) / static_cast<double>(grid);
        const Surroundings around(tracer, eye);
        if (around.enclosed < 0.9) continue;
        // Of equal places the middle one, a little above the floor's centre, as one stands in a room.
        const double off_centre = length(eye - bounds.centre()) / std::max(1e-300, bounds.diagonal());
        const double clearance = around.nearest() * (1 - 0.5 * off_centre);
        if (clearance > best.clearance) best = {eye, clearance};
      }
    }
  }
  (void)up;
  return best;
}

// A scene is a room when it encloses its middle and shows its surfaces' fronts inwards.
bool is_room(const RayTracer& tracer, const Standpoint& standpoint, const Bounds& bounds) {
  if (standpoint.clearance < 0.02 * bounds.diagonal()) return false;
  int fronts = 0;
  int met = 0;
  for (std::uint32_t i = 0; i < probe_rays; ++i) {
    const Ray ray{.origin = standpoint.eye, .direction = sample_sphere(owen_sobol_2d(i, 1))};
    const auto hit = tracer.nearest(ray);
    if (!hit) continue;
    ++met;
    fronts += dot(tracer.surface_point(ray, *hit).geometric_normal, ray.direction) < 0 ? 1 : 0;
  }
  return fronts > 0.6 * met;
}

// Looks along the longest level view, from as far back as the room lets.
Camera room_camera(const Surroundings& around, const Vec3d& eye, double fov, const Vec3d& up) {
  double longest = -1;
  Vec3d view(0, 0, -1);
  for (std::size_t i = 0; i < around.directions.size(); ++i) {
    const double climb = std::abs(dot(around.directions[i], up));
    const double reach = std::isfinite(around.distances[i]) ? around.distances[i] : 0;
    if (climb < 0.25 && reach > longest) {
      longest = reach;
      view = around.directions[i];
    }
  }
  view = normalize(view - 0.8 * dot(view, up) * up);
  double behind = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < around.directions.size(); ++i) {
    if (dot(around.directions[i], -view) > 0.97) behind = std::min(behind, around.distances[i]);
  }
  const Vec3d stand = std::isfinite(behind) ? eye - 0.6 * behind * view : eye;
  return {.name = "framed", .to_world = look_at(stand, stand + view, up), .lens = PerspectiveLens{fov}};
}

// Three-quarter view from the front, right and above, all corners of the bounds inside the picture.
Camera object_camera(const Bounds& bounds, double fov, double aspect, const Vec3d& up) {
  const Vec3d side = std::abs(up.x) < 0.9 ? Vec3d(1, 0, 0) : Vec3d(0, 0, 1);
  const Vec3d front = normalize(cross(side, up));  // +z when +y is up
  const Vec3d right = cross(up, front);
  const Vec3d view = -normalize(0.55 * right + 0.45 * up + front);
  const Vec3d centre = bounds.centre();
  const Mat4d turn = look_at(centre - view, centre, up);
  const double half_height = std::tan(fov / 2);
  double distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d p(corner & 1 ? bounds.upper.x : bounds.lower.x, corner & 2 ? bounds.upper.y : bounds.lower.y,
                  corner & 4 ? bounds.upper.z : bounds.lower.z);
    const Vec3d offset = p - centre;
    const double x = std::abs(dot(offset, Vec3d(turn[0])));
    const double y = std::abs(dot(offset, Vec3d(turn[1])));
    const double towards = dot(offset, Vec3d(turn[2]));
    distance = std::max(distance, towards + margin * std::max(y / half_height, x / (half_height * aspect)));
  }
  if (!(distance > 0)) distance = 1;
  return {.name = "framed", .to_world = look_at(centre - distance * view, centre, up), .lens = PerspectiveLens{fov}};
}

}  // namespace

Camera framing_camera(const RayTracer& tracer, double vertical_fov, double aspect, const Vec3d& up) {
  Bounds bounds = tracer.bounds();
  if (bounds.empty()) bounds = Bounds{Vec3d(-1), Vec3d(1)};
  const Standpoint standpoint = find_standpoint(tracer, bounds, up);
  if (is_room(tracer, standpoint, bounds)) {
    return room_camera(Surroundings(tracer, standpoint.eye), standpoint.eye, vertical_fov, up);
  }
  return object_camera(bounds, vertical_fov, aspect, up);
}

}  // namespace penumbra
