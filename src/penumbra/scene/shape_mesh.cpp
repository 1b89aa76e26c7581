#include "penumbra/scene/shape_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "penumbra/math/frame.h"

namespace penumbra {

namespace {

constexpr std::uint32_t around = 64;
constexpr std::uint32_t down = 32;

/// Exact at the quarters, so that opposite vertices are opposite.
Vec2d on_circle(std::uint32_t step, std::uint32_t steps) {
  const double angle = 2 * std::numbers::pi * step / steps;
  return {std::cos(angle), std::sin(angle)};
}

void add_vertex(Mesh& mesh, const Vec3d& position, const Vec3d& normal) {
  mesh.positions.push_back(position);
  mesh.normals.emplace_back(normal);
}

Mat4d standing(const Vec3d& x, const Vec3d& y, const Vec3d& z, const Vec3d& at) {
  return {Vec4d(x, 0), Vec4d(y, 0), Vec4d(z, 0), Vec4d(at, 1)};
}

}  // namespace

Mesh unit_sphere_mesh() {
  Mesh mesh;
  mesh.name = "sphere";
  add_vertex(mesh, {0, 0, 1}, {0, 0, 1});
  for (std::uint32_t j = 1; j < down; ++j) {
    const Vec2d ring = on_circle(j, 2 * down);
    for (std::uint32_t i = 0; i < around; ++i) {
      const Vec2d c = on_circle(i, around);
      const Vec3d p(ring.y * c.x, ring.y * c.y, ring.x);
      add_vertex(mesh, p, p);
    }
  }
  add_vertex(mesh, {0, 0, -1}, {0, 0, -1});
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  const auto at = [](std::uint32_t j, std::uint32_t i) { return 1 + j * around + i % around; };
  for (std::uint32_t i = 0; i < around; ++i) {
    mesh.triangles.push_back({0, at(0, i), at(0, i + 1)});
    for (std::uint32_t j = 0; j + 2 < down; ++j) {
      mesh.triangles.push_back({at(j, i), at(j + 1, i), at(j + 1, i + 1)});
      mesh.triangles.push_back({at(j, i), at(j + 1, i + 1), at(j, i + 1)});
    }
    mesh.triangles.push_back({last, at(down - 2, i + 1), at(down - 2, i)});
  }
  return mesh;
}

Mesh unit_disk_mesh() {
  Mesh mesh;
  mesh.name = "disk";
  add_vertex(mesh, {0, 0, 0}, {0, 0, 1});
  for (std::uint32_t i = 0; i < around; ++i) add_vertex(mesh, Vec3d(on_circle(i, around), 0), {0, 0, 1});
  for (std::uint32_t i = 0; i < around; ++i) mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % around});
  return mesh;
}

Mesh unit_cylinder_mesh() {
  Mesh mesh;
  mesh.name = "cylinder";
  for (const double z : {0.0, 1.0}) {
    for (std::uint32_t i = 0; i < around; ++i) {
      const Vec2d c = on_circle(i, around);
      add_vertex(mesh, Vec3d(c, z), Vec3d(c, 0));
    }
  }
  for (std::uint32_t i = 0; i < around; ++i) {
    const std::uint32_t next = (i + 1) % around;
    mesh.triangles.push_back({i, next, around + next});
    mesh.triangles.push_back({i, around + next, around + i});
  }
  return mesh;
}

Mesh unit_square_mesh() {
  Mesh mesh;
  mesh.name = "square";
  for (const Vec2d& corner : {Vec2d(-1, -1), Vec2d(1, -1), Vec2d(1, 1), Vec2d(-1, 1)}) {
    add_vertex(mesh, Vec3d(corner, 0), {0, 0, 1});
  }
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

Mat4d placement(const Sphere& sphere) {
  const double r = sphere.radius;
  return standing({r, 0, 0}, {0, r, 0}, {0, 0, r}, sphere.centre);
}

Mat4d placement(const Disk& disk) {
  const Frame frame(disk.normal);
  return standing(disk.radius * frame.tangent, disk.radius * frame.bitangent, frame.normal, disk.centre);
}

Mat4d placement(const Cylinder& cylinder) {
  const Vec3d axis = cylinder.top - cylinder.base;
  const Frame frame(normalize(axis));
  return standing(cylinder.radius * frame.tangent, cylinder.radius * frame.bitangent, axis, cylinder.base);
}

Mat4d placement(const Plane& plane, const Vec3d& around_point, double half) {
  const Frame frame(plane.normal);
  const Vec3d centre = around_point - dot(around_point - plane.point, plane.normal) * plane.normal;
  return standing(half * frame.tangent, half * frame.bitangent, frame.normal, centre);
}

Mesh unit_mesh(const Shape& shape) {
  static constexpr Mesh (*makers[])() = {unit_sphere_mesh, unit_disk_mesh, unit_cylinder_mesh, unit_square_mesh};
  return makers[shape.index()]();
}

PlaneCut plane_cut(const Scene& scene) {
  Bounds bounds = scene.bounds();
  for (const Camera& camera : scene.cameras) bounds.grow(Vec3d(camera.to_world[3]));
  if (bounds.empty()) return {};
  return {bounds.centre(), std::max(50.0, std::ceil(5 * bounds.diagonal()))};
}

Mat4d placement(const Shape& shape, const PlaneCut& cut) {
  if (const auto* plane = std::get_if<Plane>(&shape)) return placement(*plane, cut.centre, cut.half);
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return placement(*sphere);
  if (const auto* disk = std::get_if<Disk>(&shape)) return placement(*disk);
  return placement(std::get<Cylinder>(shape));
}

Scene tessellated(Scene scene) {
  const PlaneCut cut = plane_cut(scene);
  std::map<std::pair<std::size_t, std::uint32_t>, std::uint32_t> mesh_of;  // by kind and material
  for (const ShapeObject& object : scene.shapes) {
    const auto [mesh, fresh] =
        mesh_of.try_emplace({object.shape.index(), object.material}, static_cast<std::uint32_t>(scene.meshes.size()));
    if (fresh) {
      scene.meshes.push_back(unit_mesh(object.shape));
      scene.meshes.back().materials = {object.material};
    }
    scene.instances.push_back({.name = object.name, .mesh = mesh->second, .to_world = placement(object.shape, cut)});
  }
  scene.shapes.clear();
  return scene;
}

}  // namespace penumbra
