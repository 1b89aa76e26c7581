#include "penumbra/render/framing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <vector>

#include "penumbra/math/sampling.h"
#include "penumbra/math/sobol.h"

namespace penumbra {
namespace {

constexpr int probe_rays = 64;
constexpr double enclosed_share = 0.9;  // of directions that must meet a surface, indoors
constexpr double object_fov = 40 * std::numbers::pi / 180;
constexpr double room_fov = 65 * std::numbers::pi / 180;
constexpr double margin = 1.06;  // room around an object in the picture
constexpr std::size_t most_framed_points = 200000;

// What surrounds a point in space.
struct Surroundings {
  double enclosed = 0;   // share of directions that meet a surface
  double fronts = 0;     // share of those that meet its front
  double clearance = 0;  // m to the nearest surface met
};

Surroundings look_around(const RayTracer& tracer, const Vec3d& eye) {
  Surroundings around;
  around.clearance = std::numeric_limits<double>::infinity();
  int met = 0;
  int fronts = 0;
  for (std::uint32_t i = 0; i < probe_rays; ++i) {
    const Ray ray{.origin = eye, .direction = sample_sphere(owen_sobol_2d(i, 0))};
    const auto hit = tracer.nearest(ray);
    if (!hit) continue;
    ++met;
    fronts += dot(tracer.surface_point(ray, *hit).geometric_normal, ray.direction) < 0 ? 1 : 0;
    around.clearance = std::min(around.clearance, hit->t);
  }
  around.enclosed = static_cast<double>(met) / probe_rays;
  around.fronts = met > 0 ? static_cast<double>(fronts) / met : 0;
  return around;
}

// How much there is to see through a picture: far walls and many objects please, a surface right before the lens does
// not.
double view_quality(const RayTracer& tracer, const Camera& camera, double aspect, double size) {
  constexpr int columns = 12;
  constexpr int rows = 8;
  std::set<std::uint32_t> objects;
  double log_depth = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const auto hit = tracer.nearest(camera.ray((x + 0.5) / columns, (y + 0.5) / rows, aspect));
      if (!hit) return 0;  // looks out of the room
      objects.insert(hit->object);
      log_depth += std::log(std::max(hit->t / size, 1e-6)) / (columns * rows);
      nearest = std::min(nearest, hit->t);
    }
  }
  const double space = std::min(1.0, nearest / (0.05 * size));
  return std::exp(log_depth) * std::sqrt(static_cast<double>(objects.size())) * space;
}

// The best of many views from inside, when the scene is a room: places from which nearly every direction meets the
// front of a surface. None when it is an object, to be seen from outside.
std::optional<Camera> room_camera(const RayTracer& tracer, const Bounds& bounds, double fov, double aspect,
                                  const Vec3d& up) {
  constexpr int places = 8;
  constexpr int headings = 16;
  const double size = bounds.diagonal();
  const Frame ground(up);
  std::optional<Camera> best;
  double best_quality = 0;
  int indoors = 0;
  for (int place = 0; place < places * places * 3; ++place) {
    const Vec3d at((place % places + 0.5) / places, (place / places % places + 0.5) / places,
                   0.35 + 0.15 * (place / (places * places)));
    // Heights are measured along `up`, places across it.
    const Vec3d across = (at.x - 0.5) * ground.tangent + (at.y - 0.5) * ground.bitangent + (at.z - 0.5) * up;
    const Vec3d eye = bounds.centre() + across * bounds.extent();
    const Surroundings around = look_around(tracer, eye);
    if (around.enclosed < enclosed_share || around.fronts < 0.7 || around.clearance < 0.005 * size) continue;
    ++indoors;
    for (int heading = 0; heading < headings; ++heading) {
      const double angle = 2 * std::numbers::pi * heading / headings;
      const Vec3d level = std::cos(angle) * ground.tangent + std::sin(angle) * ground.bitangent;
      const Vec3d view = normalize(level - 0.08 * up);
      Camera camera{.name = "framed", .to_world = look_at(eye, eye + view, up), .lens = PerspectiveLens{fov}};
      const double quality = view_quality(tracer, camera, aspect, size);
      if (quality > best_quality) {
        best_quality = quality;
        best = camera;
      }
    }
  }
  // Objects may be hollow here and there; a room is so in much of its bounds.
  return indoors >= places * places * 3 / 8 ? best : std::nullopt;
}

// World positions that must be in the picture: vertices, thinned out in large scenes, and the boxes of exact shapes.
std::vector<Vec3d> framed_points(const RayTracer& tracer, const Bounds& bounds) {
  const Scene& scene = tracer.scene();
  std::size_t vertices = 0;
  for (const Instance& i : scene.instances) vertices += scene.meshes[i.mesh].positions.size();
  std::vector<Vec3d> points;
  if (vertices > 0 && vertices <= most_framed_points && scene.shapes.empty()) {
    for (const Instance& i : scene.instances) {
      for (const Vec3d& p : scene.meshes[i.mesh].positions) points.push_back(transform_point(i.to_world, p));
    }
    return points;
  }
  for (int corner = 0; corner < 8; ++corner) {
    points.emplace_back(corner & 1 ? bounds.upper.x : bounds.lower.x, corner & 2 ? bounds.upper.y : bounds.lower.y,
                        corner & 4 ? bounds.upper.z : bounds.lower.z);
  }
  return points;
}

// Three-quarter view from the front, right and above, every point inside the picture.
Camera object_camera(const std::vector<Vec3d>& points, const Vec3d& centre, double fov, double aspect,
                     const Vec3d& up) {
  const Vec3d side = std::abs(up.x) < 0.9 ? Vec3d(1, 0, 0) : Vec3d(0, 0, 1);
  const Vec3d front = normalize(cross(side, up));  // +z when +y is up
  const Vec3d right = cross(up, front);
  const Vec3d back = normalize(0.55 * right + 0.45 * up + front);
  const Mat4d turn = look_at(centre + back, centre, up);
  const double half_height = std::tan(fov / 2);
  const double slope[2] = {half_height * aspect / margin, half_height / margin};
  // A point at (a, b, c) right, above and towards the eye is inside when |a - shift| <= slope (distance - c): the eye
  // stands where the outermost planes through points on either side meet.
  double distance = 0;
  double shift[2] = {0, 0};
  for (int axis = 0; axis < 2; ++axis) {
    double most = -std::numeric_limits<double>::infinity();
    double least = most;
    for (const Vec3d& p : points) {
      const double across = dot(p - centre, Vec3d(turn[axis]));
      const double towards = slope[axis] * dot(p - centre, back);
      most = std::max(most, towards + across);
      least = std::max(least, towards - across);
    }
    distance = std::max(distance, 0.5 * (most + least) / slope[axis]);
    shift[axis] = 0.5 * (most - least);
  }
  if (!(distance > 0)) distance = 1;
  const Vec3d aim = centre + shift[0] * Vec3d(turn[0]) + shift[1] * Vec3d(turn[1]);
  return {.name = "framed", .to_world = look_at(aim + distance * back, aim, up), .lens = PerspectiveLens{fov}};
}

}  // namespace

Camera framing_camera(const RayTracer& tracer, std::optional<double> vertical_fov, double aspect, const Vec3d& up) {
  Bounds bounds = tracer.bounds();
  if (bounds.empty()) bounds = Bounds{Vec3d(-1), Vec3d(1)};
  if (auto inside = room_camera(tracer, bounds, vertical_fov.value_or(room_fov), aspect, up)) return *inside;
  return object_camera(framed_points(tracer, bounds), bounds.centre(), vertical_fov.value_or(object_fov), aspect, up);
}

}  // namespace penumbra
