#include "penumbra/scene/scene.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <string_view>

#include "penumbra/math/transform.h"

namespace penumbra {

namespace {

[[noreturn]] void refuse(std::string_view kind, std::size_t index, std::string_view name, std::string_view complaint) {
  throw std::invalid_argument(
      fmt::format("{} {}{}: {}", kind, index, name.empty() ? "" : fmt::format(" ('{}')", name), complaint));
}

bool finite(double v) { return std::isfinite(v); }
template <int size, class T>
bool finite(const glm::vec<size, T>& v) {
  for (int k = 0; k < size; ++k) {
    if (!std::isfinite(v[k])) return false;
  }
  return true;
}
template <int columns, int rows, class T>
bool finite(const glm::mat<columns, rows, T>& m) {
  for (int k = 0; k < columns; ++k) {
    if (!finite(m[k])) return false;
  }
  return true;
}

template <class Range>
bool all_finite(const Range& values) {
  for (const auto& v : values) {
    if (!finite(v)) return false;
  }
  return true;
}

/// Complaints about one thing, which throw with its kind, number and name.
struct Checker {
  std::string_view kind;
  std::size_t index;
  std::string_view name;

  void require(bool good, std::string_view complaint) const {
    if (!good) refuse(kind, index, name, complaint);
  }
  void in_range(std::uint32_t value, std::size_t count, std::string_view what) const {
    if (value >= count) refuse(kind, index, name, fmt::format("its {} is {}, but there are {}", what, value, count));
  }
};

void validate_faces(const Mesh& mesh, const Checker& check) {
  if (mesh.face_offsets.empty()) {
    check.require(mesh.face_vertices.empty() && mesh.face_of_triangle.empty(), "its face arrays disagree");
    return;
  }
  check.require(mesh.face_offsets.front() == 0 && mesh.face_offsets.back() == mesh.face_vertices.size(),
                "its face offsets do not span its face vertices");
  for (std::size_t f = 0; f + 1 < mesh.face_offsets.size(); ++f) {
    check.require(mesh.face_offsets[f] <= mesh.face_offsets[f + 1], "its face offsets decrease");
  }
  for (const std::uint32_t v : mesh.face_vertices) check.in_range(v, mesh.positions.size(), "face's vertex");
  check.require(mesh.face_of_triangle.size() == mesh.triangles.size(), "it does not tell the face of each triangle");
  for (const std::uint32_t f : mesh.face_of_triangle) check.in_range(f, mesh.face_count(), "triangle's face");
}

void validate_mesh(const Scene& scene, std::size_t index) {
  const Mesh& mesh = scene.meshes[index];
  const Checker check{"mesh", index, mesh.name};
  const std::size_t vertices = mesh.positions.size();
  check.require(all_finite(mesh.positions), "a position is not finite");
  for (const Mesh::Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) check.in_range(v, vertices, "triangle's vertex");
  }
  check.require(mesh.materials.size() == 1 || mesh.materials.size() == mesh.triangles.size(),
                "it has neither one material nor one for each triangle");
  for (const std::uint32_t m : mesh.materials) check.in_range(m, scene.materials.size(), "material");
  const auto per_vertex = [&](const auto& values, std::string_view what) {
    if (!values.empty() && values.size() != vertices) {
      refuse(check.kind, index, mesh.name, fmt::format("it has {} {} for {} vertices", values.size(), what, vertices));
    }
    if (!all_finite(values)) refuse(check.kind, index, mesh.name, fmt::format("its {} are not all finite", what));
  };
  per_vertex(mesh.normals, "normals");
  per_vertex(mesh.tangents, "tangents");
  per_vertex(mesh.uv[0], "texture coordinates");
  per_vertex(mesh.uv[1], "second texture coordinates");
  per_vertex(mesh.colours, "colours");
  validate_faces(mesh, check);
}

void validate_texture_refs(const Scene& scene, const Material& m, const Checker& check) {
  for (const auto* ref : {&m.base_colour_texture, &m.metallic_roughness_texture, &m.normal_texture, &m.emission_texture,
                          &m.transmission_texture, &m.specular_texture, &m.specular_colour_texture}) {
    if (!*ref) continue;
    check.in_range((*ref)->texture, scene.textures.size(), "texture");
    check.in_range((*ref)->uv_set, 2, "texture coordinate set");
    check.require(finite((*ref)->transform), "a texture transform is not finite");
  }
}

void validate_material(const Scene& scene, std::size_t index) {
  const Material& m = scene.materials[index];
  const Checker check{"material", index, m.name};
  for (const Rgb& colour : {m.base_colour, m.specular_colour, m.attenuation_colour, m.mirror, m.emission}) {
    check.require(finite(colour), "a colour is not finite");
  }
  for (const float v : {m.alpha, m.alpha_cutoff, m.metallic, m.roughness, m.specular, m.ior, m.transmission,
                        m.normal_scale, m.checker_size}) {
    check.require(finite(v), "a factor is not finite");
  }
  check.require(!std::isnan(m.attenuation_distance), "its attenuation distance is not a number");
  check.require(!m.checker_colour || (finite(*m.checker_colour) && m.checker_size > 0), "its checker is not valid");
  check.require(!m.conductor || (finite(m.conductor->eta) && finite(m.conductor->k)), "its metal is not finite");
  validate_texture_refs(scene, m, check);
}

void validate_image(const Scene& scene, std::size_t index) {
  const TextureImage& image = scene.images[index];
  const Checker check{"image", index, image.name};
  check.require(image.width >= 1 && image.height >= 1 && image.channels >= 1 && image.channels <= 4,
                "its size or channels are out of range");
  const std::size_t wanted = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) *
                             static_cast<std::size_t>(image.channels);
  const std::size_t has = std::visit([](const auto& texels) { return texels.size(); }, image.texels);
  check.require(has == wanted, "it has not as many texels as its size says");
}

struct FiniteLight {
  bool operator()(const PointLight& l) const {
    return finite(l.position) && finite(l.intensity) && !std::isnan(l.range);
  }
  bool operator()(const SpotLight& l) const {
    return finite(l.position) && finite(l.direction) && finite(l.intensity) && !std::isnan(l.range) &&
           finite(l.inner_angle) && finite(l.outer_angle);
  }
  bool operator()(const DirectionalLight& l) const { return finite(l.direction) && finite(l.irradiance); }
  bool operator()(const AmbientLight& l) const { return finite(l.radiance); }
};

struct FiniteShape {
  bool operator()(const Sphere& s) const { return finite(s.centre) && finite(s.radius); }
  bool operator()(const Disk& s) const { return finite(s.centre) && finite(s.normal) && finite(s.radius); }
  bool operator()(const Cylinder& s) const { return finite(s.base) && finite(s.top) && finite(s.radius); }
  bool operator()(const Plane& s) const { return finite(s.point) && finite(s.normal); }
};

struct ShapeBounds {
  Bounds operator()(const Sphere& s) const { return {s.centre - Vec3d(s.radius), s.centre + Vec3d(s.radius)}; }
  Bounds operator()(const Disk& s) const {
    const Vec3d reach = rim(s.normal, s.radius);
    return {s.centre - reach, s.centre + reach};
  }
  Bounds operator()(const Cylinder& s) const {
    const Vec3d reach = rim(normalize(s.top - s.base), s.radius);
    return {glm::min(s.base, s.top) - reach, glm::max(s.base, s.top) + reach};
  }
  Bounds operator()(const Plane&) const { return {}; }

 private:
  /// How far a circle reaches along each axis.
  static Vec3d rim(const Vec3d& axis, double radius) {
    return radius * glm::sqrt(glm::max(Vec3d(0), Vec3d(1) - axis * axis));
  }
};

}  // namespace

std::size_t Scene::triangle_count() const {
  std::size_t count = 0;
  for (const Instance& instance : instances) count += meshes[instance.mesh].triangles.size();
  return count;
}

Bounds Scene::bounds() const {
  Bounds all;
  for (const Instance& instance : instances) {
    for (const Vec3d& p : meshes[instance.mesh].positions) all.grow(transform_point(instance.to_world, p));
  }
  for (const ShapeObject& object : shapes) all.grow(std::visit(ShapeBounds{}, object.shape));
  return all;
}

void validate(const Scene& scene) {
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) validate_mesh(scene, i);
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Checker check{"object", i, scene.instances[i].name};
    check.in_range(scene.instances[i].mesh, scene.meshes.size(), "mesh");
    check.require(finite(scene.instances[i].to_world), "its placement is not finite");
  }
  for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
    const Checker check{"object", scene.instances.size() + i, scene.shapes[i].name};
    check.in_range(scene.shapes[i].material, scene.materials.size(), "material");
    check.require(std::visit(FiniteShape{}, scene.shapes[i].shape), "its shape is not finite");
  }
  for (std::size_t i = 0; i < scene.materials.size(); ++i) validate_material(scene, i);
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    Checker{"texture", i, ""}.in_range(scene.textures[i].image, scene.images.size(), "image");
  }
  for (std::size_t i = 0; i < scene.images.size(); ++i) validate_image(scene, i);
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    Checker{"light", i, scene.lights[i].name}.require(std::visit(FiniteLight{}, scene.lights[i].kind),
                                                      "a value is not finite");
  }
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    Checker{"camera", i, scene.cameras[i].name}.require(finite(scene.cameras[i].to_world), "its place is not finite");
  }
  if (scene.environment) {
    const Checker check{"environment", 0, ""};
    check.require(finite(scene.environment->radiance), "its radiance is not finite");
    if (scene.environment->image) check.in_range(*scene.environment->image, scene.images.size(), "image");
  }
}

}  // namespace penumbra
