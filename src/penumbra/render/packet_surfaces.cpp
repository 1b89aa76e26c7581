#include "penumbra/render/packet_surfaces.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "penumbra/math/transform.h"
#include "penumbra/scene/texture_lookup.h"
#include "penumbra/tracing/shading/bsdf.h"
#include "penumbra/tracing/shading/specular_tree.h"

namespace penumbra {
namespace {

// What a constant mirror leaves to a Lambertian base, see Bsdf.
Rgb below_mirror(const Rgb& base, const Rgb& mirror) { return glm::min(base, Rgb(1) - glm::clamp(mirror, 0.0F, 1.0F)); }

PacketMaterial packet_material(const Material& m) {
  PacketMaterial p;
  if (reads_textures(m) || m.unlit || m.alpha_mode == AlphaMode::blend || m.metallic != 0) return p;
  p.emission = m.emission;
  p.double_sided = m.double_sided;
  // What is followed like a mirror, smoother, is for the scalar way.
  const bool rough_layer = m.specular > 0 && m.specular <= 1 && m.ior != 0 && m.roughness <= 1 &&
                           m.roughness > static_cast<float>(followed_roughness) && is_black(m.mirror);
  if ((m.specular == 0 || rough_layer) && m.transmission == 0) {
    p.kind = PacketMaterial::Kind::matt;
    if (rough_layer) p.gloss.emplace(m);
    p.mirror = glm::clamp(m.mirror, 0.0F, 1.0F);
    p.reflectance[0] = below_mirror(glm::clamp(m.base_colour, 0.0F, 1.0F), p.mirror);
    if (m.checker_colour) {
      p.reflectance[1] = below_mirror(glm::clamp(*m.checker_colour, 0.0F, 1.0F), p.mirror);
      p.checker_size = m.checker_size;
    }
    p.mirrors = !is_black(p.mirror);
    p.scatters = p.gloss || !is_black(p.reflectance[0]) || !is_black(p.reflectance[1]);
    return p;
  }
  const bool smooth = m.roughness * m.roughness < static_cast<float>(Bsdf::ideal_alpha);
  const bool absorbs = m.attenuation_distance < std::numeric_limits<float>::infinity();
  if (m.transmission >= 1 && smooth && !absorbs && !m.thin_walled && m.ior >= 1 && m.specular == 1 &&
      m.specular_colour == Rgb(1) && is_black(m.mirror) && !m.checker_colour) {
    p.kind = PacketMaterial::Kind::glass;
    p.ior = m.ior;
    p.tint = glm::clamp(m.base_colour, 0.0F, 1.0F);
  }
  return p;
}

// Which square of a checker a coordinate lies in; far out, where single precision knows no squares, the first.
std::int64_t square_of(float x, float inverse_size) {
  const float at = x * inverse_size;
  if (!(std::abs(at) < 1e9F)) return 0;
  const auto down = static_cast<std::int64_t>(at);
  return down - (at < static_cast<float>(down) ? 1 : 0);
}

}  // namespace

// As surface_material.cpp has it: squares in the plane of the two axes nearest to the surface's.
bool PacketMaterial::on_second_colour(const PointLanes& points, std::size_t i) const {
  const float nx = std::abs(points.geometric.x[i]), ny = std::abs(points.geometric.y[i]),
              nz = std::abs(points.geometric.z[i]);
  const float x = points.position.x[i], y = points.position.y[i], z = points.position.z[i];
  const bool along_x = nx > ny && nx > nz;
  const bool along_y = !along_x && ny >= nz;
  const float inverse = 1 / checker_size;
  return ((square_of(along_x ? y : x, inverse) + square_of(along_x || along_y ? z : y, inverse)) & 1) != 0;
}

void turn_towards_eye(const RayPacket& rays, std::size_t i, PointLanes& points) {
  const Vec3d wo(-rays.direction_x[i], -rays.direction_y[i], -rays.direction_z[i]);
  const Vec3d normal(points.normal.x[i], points.normal.y[i], points.normal.z[i]);
  const Vec3d geometric(points.geometric.x[i], points.geometric.y[i], points.geometric.z[i]);
  const Vec3d bent = frame_towards(Frame(normalize(normal)), normalize(geometric), normalize(wo)).normal;
  points.normal.set(static_cast<int>(i), Vec3f(bent));
  points.facing[i] = static_cast<float>(dot(bent, wo));
}

PacketSurfaces::PacketSurfaces(const Scene& scene, const RayTracer* tracer) : scene_(&scene) {
  for (const Material& m : scene_->materials) materials_.push_back(packet_material(m));
  for (const Instance& i : scene_->instances) {
    const bool mirrors = is_mirroring(i.to_world);
    places_.push_back({.moves = !i.motion.empty(),
                       .as_is = i.to_world == Mat4d(1.0),
                       .mirrors = mirrors,
                       .to_world = i.to_world,
                       .normals = normal_matrix(i.to_world) * (mirrors ? -1.0 : 1.0),
                       .mesh = &scene_->meshes[i.mesh],
                       .corners = tracer != nullptr ? tracer->world_vertices(static_cast<std::uint32_t>(places_.size()))
                                                    : std::span<const Vec3f>()});
  }
  for (const ShapeObject& o : scene_->shapes) {
    RoundOrFlat& to = shapes_.emplace_back();
    if (const auto* sphere = std::get_if<Sphere>(&o.shape)) {
      to.centre = Vec3f(sphere->centre);
      to.radius = static_cast<float>(sphere->radius);
    } else if (const auto* plane = std::get_if<Plane>(&o.shape)) {
      to.centre = Vec3f(plane->point);
      to.normal = Vec3f(plane->normal);
      to.flat = 1;
    } else {
      continue;
    }
    const PacketMaterial& material = materials_[o.material];
    if (material.kind != PacketMaterial::Kind::other) to.material = &material;
  }
}

bool PacketSurfaces::all_matt() const {
  const auto matt = [&](std::uint32_t m) {
    return materials_[m].kind == PacketMaterial::Kind::matt && !materials_[m].mirrors && !materials_[m].gloss &&
           materials_[m].checker_size == 0;
  };
  for (const ShapeObject& s : scene_->shapes) {
    const bool gathered = std::holds_alternative<Sphere>(s.shape) || std::holds_alternative<Plane>(s.shape);
    if (!gathered || !matt(s.material)) return false;
  }
  for (const Instance& i : scene_->instances) {
    const Mesh& mesh = scene_->meshes[i.mesh];
    if (!i.motion.empty() || !mesh.colours.empty() || !std::all_of(mesh.materials.begin(), mesh.materials.end(), matt))
      return false;
  }
  return true;
}

namespace {

#if defined(__GNUC__)
inline void ask_for(const void* at) { __builtin_prefetch(at); }
#else
inline void ask_for(const void*) {}
#endif

}  // namespace

void PacketSurfaces::fetch_triangles(const HitPacket& hits, int used) const {
  for (int lane = 0; lane < used; ++lane) {
    if (hits.object[lane] >= places_.size()) continue;
    const Mesh& mesh = *places_[hits.object[lane]].mesh;
    ask_for(&mesh.triangles[hits.primitive[lane]]);
    if (mesh.materials.size() > 1) ask_for(&mesh.materials[hits.primitive[lane]]);
  }
}

void PacketSurfaces::fetch_corners(const HitPacket& hits, int used) const {
  for (int lane = 0; lane < used; ++lane) {
    if (hits.object[lane] >= places_.size()) continue;
    const Place& place = places_[hits.object[lane]];
    for (const std::uint32_t vertex : place.mesh->triangles[hits.primitive[lane]]) {
      place.corners.empty() ? ask_for(&place.mesh->positions[vertex]) : ask_for(&place.corners[vertex]);
      if (!place.mesh->normals.empty()) ask_for(&place.mesh->normals[vertex]);
    }
  }
}

const PacketMaterial* PacketSurfaces::gather(const HitPacket& hits, int lane, HitTriangles& triangles,
                                             HitShapes& shapes) const {
  const auto i = static_cast<std::size_t>(lane);
  const std::uint32_t object = hits.object[lane];
  if (object >= scene_->instances.size()) {
    const RoundOrFlat& shape = shapes_[object - scene_->instances.size()];
    if (shape.material == nullptr) return nullptr;
    shapes.centre.set(lane, shape.centre);
    shapes.normal.set(lane, shape.normal);
    shapes.radius[i] = shape.radius;
    shapes.flat[i] = shape.flat;
    shapes.t[i] = hits.t[lane];
    shapes.met[i] = 1;
    return shape.material;
  }
  const Place& place = places_[object];
  const Mesh& mesh = *place.mesh;
  const std::uint32_t primitive = hits.primitive[lane];
  const PacketMaterial& material = materials_[mesh.material_of(primitive)];
  if (material.kind == PacketMaterial::Kind::other || !mesh.colours.empty()) return nullptr;
  if (place.moves) return nullptr;
  const Mesh::Triangle& corner = mesh.triangles[primitive];
  const auto world = [&](std::uint32_t vertex) {
    if (!place.corners.empty()) return place.corners[vertex];
    const Vec3d& p = mesh.positions[vertex];
    return Vec3f(place.as_is ? p : transform_point(place.to_world, p));
  };
  triangles.v0.set(lane, world(corner[0]));
  triangles.v1.set(lane, world(corner[1]));
  triangles.v2.set(lane, world(corner[2]));
  const float u = hits.u[lane];
  const float v = hits.v[lane];
  triangles.u[i] = u;
  triangles.v[i] = v;
  triangles.mirror[i] = place.mirrors ? -1.0F : 1.0F;
  triangles.smooth[i] = mesh.normals.empty() ? 0.0F : 1.0F;
  if (!mesh.normals.empty()) {
    const Vec3f n = (1 - u - v) * mesh.normals[corner[0]] + u * mesh.normals[corner[1]] + v * mesh.normals[corner[2]];
    triangles.normal.set(lane, place.as_is ? n : Vec3f(place.normals * Vec3d(n)));
  }
  return &material;
}

}  // namespace penumbra
