#pragma once

#include <cmath>
#include <string>

#include "penumbra/render/render.h"
#include "tracing/soup.h"

namespace penumbra::testing {

/// Purely Lambertian.
inline Material matt(const Rgb& reflectance) {
  Material m;
  m.base_colour = reflectance;
  m.specular = 0;
  return m;
}

/// Black, and shining with radiance `L` from its front.
inline Material glow(const Rgb& radiance) {
  Material m = matt(Rgb(0));
  m.emission = radiance;
  return m;
}

inline Material mirror(const Rgb& reflectance) {
  Material m = matt(Rgb(0));
  m.mirror = reflectance;
  return m;
}

/// Clear and smooth.
inline Material glass(float ior) {
  Material m;
  m.base_colour = Rgb(1);
  m.roughness = 0;
  m.transmission = 1;
  m.ior = ior;
  return m;
}

/// A camera that sees next to nothing but one ray.
inline Camera probe_camera(const Vec3d& eye, const Vec3d& direction) {
  const Vec3d up = std::abs(direction.y) > 0.9 * length(direction) ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
  return {.name = "probe", .to_world = look_at(eye, eye + direction, up), .lens = OrthographicLens{1e-9}};
}

struct Seen {
  double value = 0;  ///< green
  double error = 0;  ///< standard error of it
  Rgb radiance{0};
  RayCounts rays;
  Rgb errors{0};  ///< standard error of each band
};

/// What a single ray sees.
inline Seen look(const RayTracer& tracer, const Vec3d& eye, const Vec3d& direction, RenderOptions options) {
  options.width = options.height = 1;
  options.aovs = {Aov::variance};
  const RenderResult result = render(tracer, probe_camera(eye, direction), options);
  const float* pixel = result.image.pixel(0, 0);
  const Rgb errors(std::sqrt(pixel[3]), std::sqrt(pixel[4]), std::sqrt(pixel[5]));
  return {pixel[1], static_cast<double>(errors.y), result.image.rgb(0, 0), result.rays, errors};
}

inline RenderOptions whitted(int samples = 1) {
  RenderOptions options;
  options.integrator = IntegratorKind::whitted;
  options.samples_per_pixel = samples;
  options.max_depth = 64;
  options.min_throughput = 0;
  return options;
}

inline RenderOptions path(int samples) {
  RenderOptions options = whitted(samples);
  options.integrator = IntegratorKind::path;
  options.max_depth = 0;
  return options;
}

/// An infinite plane with its front towards `normal`.
inline void add_plane(Scene& scene, const Vec3d& point, const Vec3d& normal, const Material& material) {
  scene.shapes.push_back({"plane", Plane{point, normal}, static_cast<std::uint32_t>(scene.materials.size())});
  scene.materials.push_back(material);
}

inline void add_shape(Scene& scene, const Shape& shape, const Material& material) {
  scene.shapes.push_back({"shape", shape, static_cast<std::uint32_t>(scene.materials.size())});
  scene.materials.push_back(material);
}

inline void add_mesh(Scene& scene, Mesh mesh, const Material& material, const std::string& name = "mesh") {
  mesh.materials = {static_cast<std::uint32_t>(scene.materials.size())};
  scene.materials.push_back(material);
  scene.instances.push_back({name, static_cast<std::uint32_t>(scene.meshes.size()), Mat4d(1.0)});
  scene.meshes.push_back(std::move(mesh));
}

}  // namespace penumbra::testing
