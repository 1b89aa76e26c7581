#include "penumbra/scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "penumbra/math/transform.h"

namespace penumbra {
namespace {

/// What is being checked, for messages: "mesh 3 'chair'".
struct Subject {
  std::string_view kind;
  std::size_t index;
  std::string_view name;

  void require(bool condition, std::string_view sentence) const {
    if (!condition) fail(sentence);
  }
  [[noreturn]] void fail(std::string_view sentence) const {
    const std::string called = name.empty() ? "" : fmt::format(" '{}'", name);
    throw std::invalid_argument(fmt::format("{} {}{}: {}", kind, index, called, sentence));
  }
};

bool finite(double v) { return std::isfinite(v); }
bool finite(float v) { return std::isfinite(v); }
template <glm::length_t size, class Value>
bool finite(const glm::vec<size, Value>& v) {
  for (glm::length_t i = 0; i < size; ++i) {
    if (!std::isfinite(v[i])) return false;
  }
  return true;
}
template <glm::length_t columns, glm::length_t rows, class Value>
bool finite(const glm::mat<columns, rows, Value>& m) {
  for (glm::length_t i = 0; i < columns; ++i) {
    if (!finite(m[i])) return false;
  }
  return true;
}
template <class Value>
bool all_finite(const std::vector<Value>& values) {
  return std::ranges::all_of(values, [](const auto& v) { return finite(v); });
}

bool all_below(std::span<const std::uint32_t> indices, std::size_t count) {
  return std::ranges::all_of(indices, [count](std::uint32_t i) { return i < count; });
}

void validate_vertices(const Mesh& mesh, const Subject& subject) {
  subject.require(all_finite(mesh.positions), "a position is not finite");
  const auto check = [&](const auto& values, std::string_view what) {
    subject.require(values.empty() || values.size() == mesh.positions.size(),
                    fmt::format("has {} positions but {} {}", mesh.positions.size(), values.size(), what));
    subject.require(all_finite(values), fmt::format("one of its {} is not finite", what));
  };
  check(mesh.normals, "normals");
  check(mesh.tangents, "tangents");
  check(mesh.uv[0], "texture coordinates");
  check(mesh.uv[1], "texture coordinates of the second set");
  check(mesh.colours, "colours");
}

void validate_faces(const Mesh& mesh, const Subject& subject) {
  if (mesh.face_offsets.empty()) {
    subject.require(mesh.face_vertices.empty() && mesh.face_of_triangle.empty(),
                    "has corners of faces but no face_offsets");
    return;
  }
  subject.require(mesh.face_offsets.front() == 0 && mesh.face_offsets.back() == mesh.face_vertices.size(),
                  "face_offsets do not span face_vertices");
  for (std::size_t f = 0; f + 1 < mesh.face_offsets.size(); ++f) {
    const bool has_corners =
        mesh.face_offsets[f + 1] >= mesh.face_offsets[f] && mesh.face_offsets[f + 1] - mesh.face_offsets[f] >= 3;
    if (!has_corners) subject.fail(fmt::format("face {} has fewer than 3 corners", f));
  }
  subject.require(all_below(mesh.face_vertices, mesh.positions.size()), "a face has a corner beyond the positions");
  subject.require(mesh.face_of_triangle.size() == mesh.triangles.size(),
                  "face_of_triangle is not as long as the triangles");
  subject.require(all_below(mesh.face_of_triangle, mesh.face_count()), "a triangle belongs to a face beyond the last");
}

void validate_mesh(const Mesh& mesh, const Subject& subject, std::size_t material_count) {
  validate_vertices(mesh, subject);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!all_below(mesh.triangles[t], mesh.positions.size())) {
      subject.fail(fmt::format("triangle {} has a corner beyond its {} positions", t, mesh.positions.size()));
    }
  }
  subject.require(mesh.materials.size() == 1 || mesh.materials.size() == mesh.triangles.size(),
                  fmt::format("has {} material numbers for {} triangles; it needs one for all or one each",
                              mesh.materials.size(), mesh.triangles.size()));
  subject.require(mesh.triangles.empty() || all_below(mesh.materials, material_count),
                  fmt::format("names a material beyond the {} of the scene", material_count));
  validate_faces(mesh, subject);
}

struct ShapeCheck {
  Subject subject;

  void operator()(const Sphere& s) const { check(finite(s.centre), s.radius); }
  void operator()(const Disk& d) const {
    check(finite(d.centre), d.radius);
    check_normal(d.normal);
  }
  void operator()(const Cylinder& c) const {
    check(finite(c.base) && finite(c.top), c.radius);
    subject.require(c.base != c.top, "has no length");
  }
  void operator()(const Plane& p) const {
    check(finite(p.point), 1);
    check_normal(p.normal);
  }

 private:
  void check(bool place_is_finite, double radius) const {
    subject.require(place_is_finite, "its place is not finite");
    subject.require(finite(radius) && radius > 0, "its radius is not a positive number");
  }
  void check_normal(const Vec3d& normal) const {
    subject.require(std::abs(length(normal) - 1) < 1e-6, "its normal is not of unit length");
  }
};

// What a part of a material says of itself, with the material's name.
template <class Part>
void validate_part(const std::optional<Part>& part, const Subject& subject, const char* what) {
  if (!part) return;
  try {
    validate(*part);
  } catch (const std::invalid_argument& wrong) {
    subject.require(false, fmt::format("{} {}", what, wrong.what()));
  }
}

void validate_spectra(const Material& m, const Subject& subject) {
  validate_part(m.fluorescence, subject, "its fluorescence");
  validate_part(m.emission_spectrum, subject, "its emission spectrum");
  const bool matt = m.specular == 0 && m.metallic == 0 && m.transmission == 0 && is_black(m.mirror);
  subject.require(!m.fluorescence || matt,
                  "only matt surfaces can fluoresce: its specular, metallic, transmission and mirror must be 0");
  subject.require(!m.emission_spectrum || (!m.emission_texture && m.alpha_mode == AlphaMode::opaque),
                  "an emission spectrum goes with an opaque surface that has no emission texture");
  if (!m.dispersion) return;
  for (double nm = 380; nm <= 780; nm += 1) {
    const double n = refractive_index(*m.dispersion, nm);
    subject.require(std::isfinite(n) && n <= 100, fmt::format("its dispersion gives no index at {} nm", nm));
  }
}

void validate_material(const Material& m, const Subject& subject, std::size_t texture_count) {
  const bool numbers_are_finite =
      finite(m.base_colour) && finite(m.alpha) && finite(m.alpha_cutoff) && finite(m.metallic) && finite(m.roughness) &&
      finite(m.specular) && finite(m.specular_colour) && finite(m.ior) && finite(m.transmission) &&
      finite(m.attenuation_colour) && !std::isnan(m.attenuation_distance) && finite(m.mirror) && finite(m.emission) &&
      finite(m.normal_scale) && finite(m.checker_colour.value_or(Rgb(0))) && finite(m.checker_size);
  subject.require(numbers_are_finite, "one of its numbers is not finite");
  if (m.conductor)
    subject.require(finite(m.conductor->eta) && finite(m.conductor->k), "its metal's index is not finite");
  subject.require(!m.checker_colour || m.checker_size > 0, "its checker_size is not positive");
  validate_spectra(m, subject);
  for (const auto* use : {&m.base_colour_texture, &m.metallic_roughness_texture, &m.normal_texture, &m.emission_texture,
                          &m.transmission_texture, &m.specular_texture, &m.specular_colour_texture}) {
    if (!*use) continue;
    subject.require((*use)->texture < texture_count,
                    fmt::format("names texture {}, but the scene has {}", (*use)->texture, texture_count));
    subject.require((*use)->uv_set < 2, "names a set of texture coordinates beyond the second");
    subject.require(finite((*use)->transform), "the transform of a texture is not finite");
  }
}

void validate_image(const TextureImage& image, const Subject& subject) {
  subject.require(image.width > 0 && image.height > 0 && image.channels >= 1 && image.channels <= 4,
                  "an image needs pixels and 1 to 4 channels");
  const auto texels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) *
                      static_cast<std::size_t>(image.channels);
  const std::size_t held = std::visit([](const auto& values) { return values.size(); }, image.texels);
  subject.require(held == texels, fmt::format("holds {} values, but its size asks for {}", held, texels));
  if (const auto* values = std::get_if<std::vector<float>>(&image.texels)) {
    subject.require(all_finite(*values), "one of its texels is not finite");
  }
}

void validate_medium(const Medium& m, const Subject& subject) {
  const auto is_coefficient = [](const Rgb& c) { return finite(c) && c.x >= 0 && c.y >= 0 && c.z >= 0; };
  subject.require(is_coefficient(m.absorption) && is_coefficient(m.scattering),
                  "its absorption and scattering must be finite and 0 or more, in 1/m");
  subject.require(std::abs(m.asymmetry) < 1, "its asymmetry g must lie between -1 and 1");
  const auto is_box = [](const Bounds& b) {
    return finite(b.lower) && finite(b.upper) && b.lower.x < b.upper.x && b.lower.y < b.upper.y &&
           b.lower.z < b.upper.z;
  };
  subject.require(!m.box || is_box(*m.box), "its box has no volume");
  if (!m.density) return;
  const DensityGrid& grid = *m.density;
  subject.require(is_box(grid.box), "the box of its density has no volume");
  const std::size_t count = std::size_t{grid.cells[0]} * grid.cells[1] * grid.cells[2];
  subject.require(count > 0 && grid.values.size() == count,
                  fmt::format("its density holds {} values for {} cells", grid.values.size(), count));
  subject.require(std::ranges::all_of(grid.values, [](float v) { return finite(v) && v >= 0; }),
                  "its density must be finite and 0 or more everywhere");
}

void validate_web(const PhotometricWeb& web, const Subject& subject) {
  const auto ascending = [](const std::vector<double>& a) {
    return !a.empty() && std::is_sorted(a.begin(), a.end()) && finite(a.front()) && finite(a.back());
  };
  subject.require(ascending(web.vertical) && ascending(web.horizontal), "its angles do not ascend");
  subject.require(web.candela.size() == web.vertical.size() * web.horizontal.size(),
                  "has not one candela value for each pair of angles");
  subject.require(std::ranges::all_of(web.candela, [](double v) { return finite(v) && v >= 0; }),
                  "its candela values must be finite and 0 or more");
  subject.require(web.tilt.size() == web.tilt_factors.size(), "has not one factor for each angle of tilt");
}

void validate_media(const Scene& scene) {
  for (std::size_t i = 0; i < scene.media.size(); ++i) {
    validate_medium(scene.media[i], {"medium", i, scene.media[i].name});
  }
  const auto exists = [&](std::uint32_t m) { return m < scene.media.size(); };
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const Subject subject{"material", i, scene.materials[i].name};
    subject.require(exists(scene.materials[i].medium.value_or(0)) || !scene.materials[i].medium,
                    "names a medium beyond those of the scene");
  }
  const Subject air{"air", 0, ""};
  air.require(std::ranges::all_of(scene.air, exists), "names a medium beyond those of the scene");
  air.require(scene.air.size() <= most_media_in_air,
              fmt::format("holds {} media, but no more than {} may stand in it", scene.air.size(), most_media_in_air));
}

struct LightCheck {
  Subject subject;

  void operator()(const PointLight& l) const { check(finite(l.position) && finite(l.intensity), l.range); }
  void operator()(const SpotLight& l) const {
    check(finite(l.position) && finite(l.direction) && finite(l.intensity) && finite(l.inner_angle) &&
              finite(l.outer_angle),
          l.range);
    check_direction(l.direction);
  }
  void operator()(const DirectionalLight& l) const {
    check(finite(l.direction) && finite(l.irradiance), 1);
    check_direction(l.direction);
  }
  void operator()(const AmbientLight& l) const { check(finite(l.radiance), 1); }

 private:
  void check(bool numbers_are_finite, double range) const {
    subject.require(numbers_are_finite && !std::isnan(range), "one of its numbers is not finite");
  }
  void check_direction(const Vec3d& d) const {
    subject.require(std::abs(length(d) - 1) < 1e-6, "its direction is not of unit length");
  }
};

void validate_motion(const Motion& motion, const Subject& subject) {
  subject.require(motion.empty() || (motion.size() >= 2 && motion.size() <= most_motion_steps),
                  fmt::format("its motion has {} steps instead of 2 to {}", motion.size(), most_motion_steps));
  subject.require(std::all_of(motion.begin(), motion.end(), [](const Mat4d& m) { return finite(m); }),
                  "its motion is not finite");
}

void validate_camera(const Camera& camera, const Subject& subject) {
  subject.require(finite(camera.to_world), "its placement is not finite");
  validate_motion(camera.motion, subject);
  if (const auto* lens = std::get_if<PerspectiveLens>(&camera.lens)) {
    subject.require(lens->vertical_fov > 0 && lens->vertical_fov < 3.141592653589794,
                    "its field of view is not between 0 and 180 degrees");
  } else if (const auto* flat = std::get_if<OrthographicLens>(&camera.lens)) {
    subject.require(finite(flat->height) && flat->height > 0, "the height that it sees is not a positive number");
  } else if (const auto* round = std::get_if<FisheyeLens>(&camera.lens)) {
    subject.require(round->fov > 0 && round->fov < 6.283185307179587,
                    "its field of view is not between 0 and 360 degrees");
  }
}

Bounds bounds_of(const Shape& shape) {
  Bounds b;
  // How far a circle around a unit axis reaches along each coordinate.
  const auto circle_reach = [](const Vec3d& axis, double radius) {
    return radius * glm::sqrt(glm::max(Vec3d(1) - axis * axis, Vec3d(0)));
  };
  const auto grow = [&b](const Vec3d& centre, const Vec3d& reach) {
    b.grow(centre - reach);
    b.grow(centre + reach);
  };
  if (const auto* s = std::get_if<Sphere>(&shape)) {
    grow(s->centre, Vec3d(s->radius));
  } else if (const auto* d = std::get_if<Disk>(&shape)) {
    grow(d->centre, circle_reach(d->normal, d->radius));
  } else if (const auto* c = std::get_if<Cylinder>(&shape)) {
    const Vec3d reach = circle_reach(normalize(c->top - c->base), c->radius);
    grow(c->base, reach);
    grow(c->top, reach);
  }
  return b;
}

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
  for (const ShapeObject& object : shapes) all.grow(bounds_of(object.shape));
  return all;
}

void validate(const Scene& scene) {
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    validate_mesh(scene.meshes[i], {"mesh", i, scene.meshes[i].name}, scene.materials.size());
  }
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const Subject subject{"object", i, instance.name};
    subject.require(instance.mesh < scene.meshes.size(),
                    fmt::format("names mesh {}, but the scene has {}", instance.mesh, scene.meshes.size()));
    subject.require(finite(instance.to_world), "its placement is not finite");
    validate_motion(instance.motion, subject);
  }
  for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
    const ShapeObject& object = scene.shapes[i];
    const Subject subject{"object", scene.instances.size() + i, object.name};
    std::visit(ShapeCheck{subject}, object.shape);
    subject.require(object.material < scene.materials.size(),
                    fmt::format("names material {}, but the scene has {}", object.material, scene.materials.size()));
  }
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    validate_material(scene.materials[i], {"material", i, scene.materials[i].name}, scene.textures.size());
  }
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    const Subject subject{"texture", i, ""};
    subject.require(scene.textures[i].image < scene.images.size(),
                    fmt::format("names image {}, but the scene has {}", scene.textures[i].image, scene.images.size()));
  }
  for (std::size_t i = 0; i < scene.images.size(); ++i) {
    validate_image(scene.images[i], {"image", i, scene.images[i].name});
  }
  for (std::size_t i = 0; i < scene.webs.size(); ++i) validate_web(scene.webs[i], {"web", i, scene.webs[i].name});
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const auto* point = std::get_if<PointLight>(&scene.lights[i].kind);
    Subject{"light", i, scene.lights[i].name}.require(
        point == nullptr || !point->web || point->web->web < scene.webs.size(),
        "names a photometric web beyond those of the scene");
    std::visit(LightCheck{Subject{"light", i, scene.lights[i].name}}, scene.lights[i].kind);
  }
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    validate_camera(scene.cameras[i], {"camera", i, scene.cameras[i].name});
  }
  validate_media(scene);
  if (scene.environment) {
    const Subject subject{"environment", 0, ""};
    subject.require(finite(scene.environment->radiance), "its radiance is not finite");
    subject.require(!scene.environment->image || *scene.environment->image < scene.images.size(),
                    "names an image beyond those of the scene");
  }
}

}  // namespace penumbra
