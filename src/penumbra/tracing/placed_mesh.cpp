#include "penumbra/tracing/placed_mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>

#include "penumbra/math/transform.h"

namespace penumbra {
namespace {

// A triangle's attributes, interpolated: weight of vertex 0 is what the barycentric pair leaves.
template <class T>
T interpolate(const std::vector<T>& values, const Mesh::Triangle& triangle, const Vec2d& b) {
  const auto w0 = static_cast<float>(1 - b.x - b.y);
  return w0 * values[triangle[0]] + static_cast<float>(b.x) * values[triangle[1]] +
         static_cast<float>(b.y) * values[triangle[2]];
}

// Sets tangent and bitangent from a direction that grows with u. @param hand of (tangent, bitangent, normal), 1 or -1.
void set_tangents(const Vec3d& along_u, double hand, SurfacePoint& p) {
  const Vec3d flat = along_u - dot(along_u, p.shading_normal) * p.shading_normal;
  if (!(length_squared(flat) > 0)) return;
  p.tangent = normalize(flat);
  p.bitangent = hand * cross(p.shading_normal, p.tangent);
}

}  // namespace

PlacedMesh::ObjectSpace::ObjectSpace(const Mat4d& to_world) {
  const auto magnitude = [](const Mat3d& m) { return Mat3d(glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2])); };
  const Vec3d t = glm::abs(Vec3d(to_world[3]));
  absolute = magnitude(Mat3d(to_world));
  there_back = absolute * magnitude(glm::inverse(Mat3d(to_world)));
  shift = there_back * t + t;
}

double PlacedMesh::ObjectSpace::size(const Vec3d& local, const Vec3d& world) const {
  return largest_component(absolute * glm::abs(local) + there_back * glm::abs(world) + shift);
}

PlacedMesh::PlacedMesh(const Mesh& mesh, const Mat4d& to_world, bool by_instance)
    : mesh_(&mesh),
      to_world_(to_world),
      normal_matrix_(normal_matrix(to_world) * (is_mirroring(to_world) ? -1.0 : 1.0)),
      mirrors_(is_mirroring(to_world)) {
  if (by_instance && !mesh.triangles.empty()) space_ = ObjectSpace(to_world);
}

SurfacePoint PlacedMesh::point(std::uint32_t triangle, const Vec2d& barycentric) const {
  const Vec2d& b = barycentric;
  const Mesh::Triangle& corner = mesh_->triangles[triangle];
  const Vec3d v0 = transform_point(to_world_, mesh_->positions[corner[0]]);
  const Vec3d v1 = transform_point(to_world_, mesh_->positions[corner[1]]);
  const Vec3d v2 = transform_point(to_world_, mesh_->positions[corner[2]]);
  const Vec3d e1 = v1 - v0;
  const Vec3d e2 = v2 - v0;
  SurfacePoint p;
  p.position = v0 + b.x * e1 + b.y * e2;
  p.error = rounding_error(std::max({largest_component(v0), largest_component(v1), largest_component(v2)}) +
                           std::max(largest_component(e1), largest_component(e2)) +
                           space_.size(mesh_->positions[corner[0]], p.position));
  const Vec3d ng = (mirrors_ ? -1.0 : 1.0) * cross(e1, e2);
  const double area2 = length(ng);
  if (area2 > 0) p.geometric_normal = ng / area2;
  p.shading_normal = p.geometric_normal;
  if (!mesh_->normals.empty()) {
    const Vec3d n = normal_matrix_ * Vec3d(interpolate(mesh_->normals, corner, b));
    const double size = length(n);
    if (size > 0 && std::isfinite(size)) p.shading_normal = n / size;
    if (dot(p.shading_normal, p.geometric_normal) < 0) p.shading_normal = -p.shading_normal;
  }
  add_tangents(corner, e1, e2, b, p);
  for (int set = 0; set < 2; ++set) {
    if (!mesh_->uv[set].empty()) p.uv[set] = interpolate(mesh_->uv[set], corner, b);
  }
  if (!mesh_->colours.empty()) p.colour = interpolate(mesh_->colours, corner, b);
  p.material = mesh_->material_of(triangle);
  return p;
}

// Barycentric weights are linear over the triangle, and with them all but the length of the interpolated normal
// (Igehy 1999, section 3.2.1).
SurfaceChange PlacedMesh::change(std::uint32_t triangle, const Vec3d& position, const Vec3d& step) const {
  SurfaceChange change;
  const Mesh::Triangle& corner = mesh_->triangles[triangle];
  const Vec3d v0 = transform_point(to_world_, mesh_->positions[corner[0]]);
  const Vec3d e1 = transform_point(to_world_, mesh_->positions[corner[1]]) - v0;
  const Vec3d e2 = transform_point(to_world_, mesh_->positions[corner[2]]) - v0;
  const Vec3d ng = cross(e1, e2);
  const double area2 = length_squared(ng);
  if (!(area2 > 0)) return change;
  const auto weights = [&](const Vec3d& v) { return Vec2d(dot(cross(v, e2), ng), dot(cross(e1, v), ng)) / area2; };
  const Vec2d by = weights(step);
  for (int set = 0; set < 2; ++set) {
    const auto& uv = mesh_->uv[set];
    if (uv.empty()) continue;
    change.uv[set] = by.x * Vec2d(uv[corner[1]] - uv[corner[0]]) + by.y * Vec2d(uv[corner[2]] - uv[corner[0]]);
  }
  if (mesh_->normals.empty()) return change;
  const Vec3d n0(mesh_->normals[corner[0]]), n1(mesh_->normals[corner[1]]), n2(mesh_->normals[corner[2]]);
  const Vec2d b = weights(position - v0);
  const Vec3d n = normal_matrix_ * ((1 - b.x - b.y) * n0 + b.x * n1 + b.y * n2);
  const double size = length(n);
  if (!(size > 0) || !std::isfinite(size)) return change;
  const Vec3d moved = normal_matrix_ * (by.x * (n1 - n0) + by.y * (n2 - n0));
  const Vec3d unit = n / size;
  const double side = dot(unit, (mirrors_ ? -1.0 : 1.0) * ng) < 0 ? -1.0 : 1.0;
  change.normal = side / size * (moved - dot(moved, unit) * unit);
  return change;
}

// The tangent runs along u; the bitangent along -v, as normal-map +Y is up in texture space.
void PlacedMesh::add_tangents(const Mesh::Triangle& triangle, const Vec3d& e1, const Vec3d& e2, const Vec2d& b,
                              SurfacePoint& p) const {
  const Frame fallback(p.shading_normal);
  p.tangent = fallback.tangent;
  p.bitangent = fallback.bitangent;
  if (!mesh_->tangents.empty()) {
    const Vec4f t = interpolate(mesh_->tangents, triangle, b);
    const double hand = (mesh_->tangents[triangle[0]].w < 0) != mirrors_ ? -1.0 : 1.0;
    set_tangents(transform_vector(to_world_, Vec3d(t)), hand, p);
    return;
  }
  if (mesh_->uv[0].empty()) return;
  const Vec2d d1 = Vec2d(mesh_->uv[0][triangle[1]] - mesh_->uv[0][triangle[0]]);
  const Vec2d d2 = Vec2d(mesh_->uv[0][triangle[2]] - mesh_->uv[0][triangle[0]]);
  const double determinant = d1.x * d2.y - d2.x * d1.y;
  if (determinant == 0) return;
  // v grows downwards, so a texture the right way round (seen from the front) has a negative determinant.
  const double hand = (determinant < 0) != mirrors_ ? 1.0 : -1.0;
  set_tangents((d2.y * e1 - d1.y * e2) / determinant, hand, p);
}

}  // namespace penumbra
