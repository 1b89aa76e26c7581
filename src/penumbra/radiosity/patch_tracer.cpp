#include "penumbra/radiosity/patch_tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "penumbra/math/polygon.h"

namespace penumbra {
namespace {

constexpr double coplanar_tolerance = 1e-7;  // of the mesh's size

std::unique_ptr<Scene> make_scene(const PatchMesh& mesh, std::vector<std::uint32_t>& patch_of_triangle) {
  auto scene = std::make_unique<Scene>();
  Mesh& triangles = scene->meshes.emplace_back();
  triangles.positions = mesh.vertices;
  for (std::uint32_t p = 0; p < mesh.patch_count(); ++p) {
    const auto corners = mesh.patch_corners(p);
    for (std::size_t c = 1; c + 1 < corners.size(); ++c) {
      triangles.triangles.push_back({corners[0], corners[c], corners[c + 1]});
      patch_of_triangle.push_back(p);
    }
  }
  scene->materials.emplace_back();
  scene->instances.push_back({"patches", 0, Mat4d(1.0)});
  return scene;
}

// Planes without their orientation, rounded so that coplanar patches of either side share a key.
struct PlaneKeys {
  double size;

  [[nodiscard]] std::array<std::int64_t, 4> key(const Vec3d& normal, double offset, int shift) const {
    const Vec3d a = glm::abs(normal);
    const double largest = a.x >= a.y ? (a.x >= a.z ? normal.x : normal.z) : (a.y >= a.z ? normal.y : normal.z);
    const double sign = largest < 0 ? -1 : 1;
    return {std::llround(sign * normal.x * 1e4), std::llround(sign * normal.y * 1e4),
            std::llround(sign * normal.z * 1e4), std::llround(sign * offset / (4 * coplanar_tolerance * size)) + shift};
  }
};

}  // namespace

PatchTracer::PatchTracer(const PatchMesh& mesh)
    : mesh_(mesh), scene_(make_scene(mesh, patch_of_triangle_)), tracer_(std::make_unique<RayTracer>(*scene_)) {
  Bounds all;
  for (const Vec3d& v : mesh.vertices) all.grow(v);
  const Vec3d far = glm::max(glm::abs(all.lower), glm::abs(all.upper));
  error_ = 8 * 0x1p-24 * std::max({far.x, far.y, far.z});
  find_opposites();
}

void PatchTracer::find_opposites() {
  Bounds all;
  for (const Vec3d& v : mesh_.vertices) all.grow(v);
  const double size = std::max(length(all.upper - all.lower), 1e-300);
  const PlaneKeys keys{size};
  std::map<std::array<std::int64_t, 4>, std::vector<std::uint32_t>> by_plane;
  std::vector<Bounds> bounds(mesh_.patch_count());
  for (std::uint32_t p = 0; p < mesh_.patch_count(); ++p) {
    for (const Vec3d& v : mesh_.polygon(p)) bounds[p].grow(v);
    by_plane[keys.key(mesh_.normals[p], dot(mesh_.normals[p], mesh_.centroids[p]), 0)].push_back(p);
  }
  opposite_offsets_.assign(1, 0);
  const Vec3d slack(coplanar_tolerance * size);
  for (std::uint32_t p = 0; p < mesh_.patch_count(); ++p) {
    for (int shift = -1; shift <= 1; ++shift) {
      const auto found = by_plane.find(keys.key(mesh_.normals[p], dot(mesh_.normals[p], mesh_.centroids[p]), shift));
      if (found == by_plane.end()) continue;
      for (const std::uint32_t q : found->second) {
        if (q >= mesh_.radiating_count || dot(mesh_.normals[p], mesh_.normals[q]) > -0.999) continue;
        const bool apart = glm::any(glm::greaterThan(bounds[p].lower, bounds[q].upper + slack)) ||
                           glm::any(glm::greaterThan(bounds[q].lower, bounds[p].upper + slack));
        const double distance = dot(mesh_.normals[p], mesh_.centroids[q] - mesh_.centroids[p]);
        if (!apart && std::abs(distance) <= coplanar_tolerance * size) opposites_.push_back(q);
      }
    }
    opposite_offsets_.push_back(static_cast<std::uint32_t>(opposites_.size()));
  }
}

std::uint32_t PatchTracer::facing(std::uint32_t triangle, const Vec3d& origin, const Vec3d& direction) const {
  const std::uint32_t p = patch_of_triangle_[triangle];
  const double towards = dot(mesh_.normals[p], direction);
  if (towards < 0) return p < mesh_.radiating_count ? p : no_patch;
  const std::uint32_t first = opposite_offsets_[p], last = opposite_offsets_[p + 1];
  if (first == last || !(towards > 0)) return no_patch;
  const Vec3d hit = origin + (dot(mesh_.normals[p], mesh_.centroids[p] - origin) / towards) * direction;
  for (std::uint32_t k = first; k < last; ++k) {
    if (convex_contains(mesh_.polygon(opposites_[k]), hit)) return opposites_[k];
  }
  return no_patch;
}

std::uint32_t PatchTracer::first_front(const Ray& ray) const {
  const auto hit = tracer_->nearest(ray);
  return hit ? facing(hit->primitive, ray.origin, ray.direction) : no_patch;
}

void PatchTracer::first_front(const RayPacket& rays, std::uint32_t* patches) const {
  HitPacket hits;
  tracer_->nearest(rays, hits);
  for (int i = 0; i < RayPacket::size; ++i) {
    const bool met = rays.active[i] != 0 && hits.object[i] != HitPacket::no_hit;
    patches[i] = met ? facing(hits.primitive[i], {rays.origin_x[i], rays.origin_y[i], rays.origin_z[i]},
                              {rays.direction_x[i], rays.direction_y[i], rays.direction_z[i]})
                     : no_patch;
  }
}

Ray PatchTracer::leave_patch(std::uint32_t patch, const Vec3d& point, const Vec3d& direction) const {
  SurfacePoint from;
  from.position = point;
  from.error = Vec3d(error_);
  from.geometric_normal = mesh_.normals[patch];
  from.shading_normal = from.geometric_normal;
  return leave(from, direction);
}

}  // namespace penumbra
