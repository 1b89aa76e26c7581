#include "penumbra/radiosity/meshing/polygon_shadows.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "penumbra/math/transform.h"
#include "penumbra/radiosity/form_factors/nusselt.h"
#include "penumbra/radiosity/meshing/shadow_pyramid.h"

namespace penumbra {
namespace {

constexpr std::uint32_t leaf_size = 4;
constexpr std::size_t most_corners = 16;
constexpr double flat = 1e-9;  // of a polygon's size: how far its corners may lie from its plane

/// A convex polygon of an instance: a face of the input, or a triangle of one that is bent or hollow.
struct Piece {
  std::vector<Vec3d> corners;  // world, counter-clockwise seen from the front
  std::uint32_t material;
};

std::vector<Piece> convex_pieces(const Scene& scene, const Instance& instance) {
  const Mesh& mesh = scene.meshes[instance.mesh];
  const bool mirrored = is_mirroring(instance.to_world);
  std::vector<Piece> pieces;
  const auto add = [&](std::span<const std::uint32_t> corners, std::uint32_t material) {
    Piece piece{{}, material};
    for (const std::uint32_t c : corners)
      piece.corners.push_back(transform_point(instance.to_world, mesh.positions[c]));
    if (mirrored) std::reverse(piece.corners.begin(), piece.corners.end());
    const bool whole = corners.size() == 3 || (corners.size() <= most_corners && is_convex(piece.corners) &&
                                               planarity_error(piece.corners) <= flat * polygon_size(piece.corners));
    if (whole) pieces.push_back(std::move(piece));
    return whole;
  };
  std::vector<char> is_whole(mesh.face_offsets.empty() ? 0 : mesh.face_count(), 0);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.face_offsets.empty()) {
      add(mesh.triangles[t], mesh.material_of(t));
      continue;
    }
    const std::uint32_t face = mesh.face_of_triangle[t];
    const bool first = t == 0 || mesh.face_of_triangle[t - 1] != face;
    if (first) is_whole[face] = add(mesh.face(face), mesh.material_of(t)) ? 1 : 0;
    if (is_whole[face] == 0) add(mesh.triangles[t], mesh.material_of(t));
  }
  return pieces;
}

bool lets_light_pass(const Material& m, bool through_glass) {
  return m.alpha_mode != AlphaMode::opaque || (through_glass && m.transmission > 0);
}

Bounds bounds_of(const Shape& shape) {
  Bounds box;
  const auto grow = [&](const Vec3d& centre, double radius) {
    box.grow(centre - Vec3d(radius));
    box.grow(centre + Vec3d(radius));
  };
  if (const auto* sphere = std::get_if<Sphere>(&shape)) grow(sphere->centre, sphere->radius);
  if (const auto* disk = std::get_if<Disk>(&shape)) grow(disk->centre, disk->radius);
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    grow(cylinder->base, cylinder->radius);
    grow(cylinder->top, cylinder->radius);
  }
  return box;
}

}  // namespace

PolygonShadows::PolygonShadows(const Scene& scene, const LightSampler& lights, bool through_glass,
                               bool with_occluders) {
  for (std::size_t i = 0; i < lights.light_count(); ++i) add_lamp(scene, lights.light(i));
  if (with_occluders) add_occluders(scene, through_glass);
}

void PolygonShadows::add_lamp(const Scene& scene, const LightSampler::Source& source) {
  Lamp& lamp = lamps_.emplace_back();
  if (source.kind != LightSampler::Kind::mesh || !source.middle) return;
  const Instance& instance = scene.instances[source.index];
  const std::uint32_t material = scene.meshes[instance.mesh].material_of(source.triangles.front());
  for (Piece& piece : convex_pieces(scene, instance)) {
    const Material& m = scene.materials[piece.material];
    if (piece.material == material || (m.emits() && !m.unlit)) lamp.polygons.push_back(std::move(piece.corners));
  }
  lamp.radiance = source.middle->radiance;
  lamp.both_sides = source.middle->both_sides;
}

void PolygonShadows::add_occluders(const Scene& scene, bool through_glass) {
  for (const Instance& instance : scene.instances) {
    for (Piece& piece : convex_pieces(scene, instance)) {
      Bounds& box = bounds_.emplace_back();
      for (const Vec3d& p : piece.corners) box.grow(p);
      if (lets_light_pass(scene.materials[piece.material], through_glass)) piece.corners.clear();
      occluders_.push_back(std::move(piece.corners));
    }
  }
  for (const ShapeObject& object : scene.shapes) {
    if (const auto* plane = std::get_if<Plane>(&object.shape)) {
      planes_.push_back({plane->normal, dot(plane->normal, plane->point)});
      continue;
    }
    bounds_.push_back(bounds_of(object.shape));
    occluders_.emplace_back();
  }
  std::vector<std::uint32_t> all(bounds_.size());
  std::iota(all.begin(), all.end(), 0U);
  tree_ = BoxTree(bounds_, std::move(all), leaf_size);
}

// What of a lamp's polygon shines towards the receiver and stands above its horizon, counter-clockwise seen from there.
PolygonShadows::Polygon PolygonShadows::lit_part(const Lamp& lamp, const Polygon& polygon, const Receiver& to) const {
  Polygon facing = polygon;
  if (dot(newell_vector(polygon), to.position - polygon[0]) < 0) {
    if (!lamp.both_sides) return {};
    std::reverse(facing.begin(), facing.end());
  }
  Polygon above;
  clip_polygon(facing, {to.side, dot(to.side, to.position)}, 0, above);
  return above;
}

double PolygonShadows::open_factor(std::size_t light, const Receiver& to) const {
  double sum = 0;
  for (const Polygon& polygon : lamps_[light].polygons) {
    const Polygon lit = lit_part(lamps_[light], polygon, to);
    if (lit.size() >= 3) sum += point_to_polygon(to.position, to.normal, lit);
  }
  return sum;
}

std::optional<double> PolygonShadows::visible_factor(std::size_t light, const Receiver& to) const {
  double sum = 0;
  std::vector<Polygon> between;
  for (const Polygon& polygon : lamps_[light].polygons) {
    Polygon lit = lit_part(lamps_[light], polygon, to);
    if (lit.size() < 3) continue;
    if (!list_occluders(lit, to, between)) return std::nullopt;
    const double whole = point_to_polygon(to.position, to.normal, lit);
    std::vector<Polygon> pieces{std::move(lit)};
    for (const Polygon& occluder : between) cut_shadow(to.position, occluder, pieces);
    double seen = 0;
    for (const Polygon& piece : pieces) seen += point_to_polygon(to.position, to.normal, piece);
    sum += std::min(seen, whole);
  }
  return sum;
}

// The parts of polygons above the receiver, before the lamp and in the pyramid between; false when they are too many or
// no polygons.
bool PolygonShadows::list_occluders(const Polygon& lamp, const Receiver& to, std::vector<Polygon>& between) const {
  between.clear();
  std::vector<Plane3> half_spaces = pyramid_over(lamp, to.position);
  if (half_spaces.empty()) return true;
  const Plane3 horizon{to.side, dot(to.side, to.position)};
  const Plane3 before = polygon_plane(lamp);  // its front faces the receiver
  half_spaces.push_back(horizon);
  half_spaces.push_back(before);
  const double tolerance = 2 * to.rounding;
  for (const Plane3& plane : planes_) {
    const double own = plane.distance(to.position);
    if (std::abs(own) <= tolerance) continue;  // the receiver lies on it
    if (std::any_of(lamp.begin(), lamp.end(), [&](const Vec3d& p) { return plane.distance(p) * own < 0; }))
      return false;
  }
  bool clear = true;
  Polygon above, part;
  tree_.search([&](const Bounds& box) { return !clear || is_outside(box, half_spaces, tolerance); },
               [&](std::uint32_t k) {
                 if (!clear || is_outside(bounds_[k], half_spaces, tolerance)) return;
                 const Polygon& polygon = occluders_[k];
                 if (polygon.empty()) {
                   clear = false;
                   return;
                 }
                 clip_polygon(polygon, horizon, tolerance, above);
                 if (above.size() < 3) return;
                 clip_polygon(above, before, tolerance, part);
                 if (part.size() < 3) return;
                 if (between.size() == most_occluders) {
                   clear = false;
                   return;
                 }
                 between.push_back(part);
               });
  return clear;
}

}  // namespace penumbra
