#include "penumbra/scene/fingerprint.h"

#include <bit>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <type_traits>

#include "penumbra/math/rng.h"

namespace penumbra {
namespace {

/// A hash of a sequence of words.
class Hash {
 public:
  void add(std::uint64_t word) { value_ = hash_key(value_, word); }
  void add(double x) { add(std::bit_cast<std::uint64_t>(x == 0 ? 0.0 : x)); }
  void add(float x) { add(static_cast<double>(x)); }
  void add(const Vec3d& v) { add(v.x), add(v.y), add(v.z); }
  void add(const Rgb& c) { add(Vec3d(c)); }
  template <class T>
  void add_all(const std::vector<T>& values) {
    add(std::uint64_t{values.size()});
    for (const T& v : values) add_one(v);
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  template <class T>
  void add_one(const T& v) {
    if constexpr (std::is_integral_v<T>) {
      add(static_cast<std::uint64_t>(v));
    } else if constexpr (std::is_same_v<T, Mesh::Triangle>) {
      for (const std::uint32_t c : v) add(std::uint64_t{c});
    } else if constexpr (std::is_same_v<T, Vec2f>) {
      add(v.x), add(v.y);
    } else if constexpr (std::is_same_v<T, Vec4f>) {
      add(v.x), add(v.y), add(v.z), add(v.w);
    } else {
      add(v);
    }
  }
  std::uint64_t value_ = 0;
};

void add_surfaces(const Scene& scene, Hash& ways) {
  for (const Mesh& mesh : scene.meshes) {
    ways.add_all(mesh.positions);
    ways.add_all(mesh.triangles);
    ways.add_all(mesh.materials);
    ways.add_all(mesh.normals);
    ways.add_all(mesh.face_offsets);
    ways.add_all(mesh.face_vertices);
  }
  for (const Instance& instance : scene.instances) {
    ways.add(std::uint64_t{instance.mesh});
    for (int c = 0; c < 4; ++c) ways.add(Vec3d(instance.to_world[c]));
  }
  for (const ShapeObject& object : scene.shapes) {
    ways.add(std::uint64_t{object.shape.index()});
    ways.add(std::uint64_t{object.material});
    if (const auto* s = std::get_if<Sphere>(&object.shape)) ways.add(s->centre), ways.add(s->radius);
    if (const auto* d = std::get_if<Disk>(&object.shape)) ways.add(d->centre), ways.add(d->normal), ways.add(d->radius);
    if (const auto* c = std::get_if<Cylinder>(&object.shape)) ways.add(c->base), ways.add(c->top), ways.add(c->radius);
    if (const auto* p = std::get_if<Plane>(&object.shape)) ways.add(p->point), ways.add(p->normal);
  }
}

void add_material(const Material& m, Hash& ways, Hash& light) {
  for (const float x :
       {m.alpha, m.metallic, m.roughness, m.specular, m.ior, m.transmission, m.attenuation_distance,
        static_cast<float>(m.thin_walled), static_cast<float>(m.unlit), static_cast<float>(m.alpha_mode)}) {
    ways.add(x);
  }
  if (m.medium) ways.add(std::uint64_t{*m.medium});
  ways.add(m.mirror);
  ways.add(m.specular_colour);
  ways.add(m.attenuation_colour);
  if (m.conductor) ways.add(Vec3d(m.conductor->eta)), ways.add(Vec3d(m.conductor->k));
  // Metal and glass have the base colour on light's way.
  (m.metallic > 0 || m.transmission > 0 ? ways : light).add(m.base_colour);
  light.add(m.emission);
  light.add(static_cast<float>(m.double_sided));
  if (m.fluorescence) {
    for (const double x : m.fluorescence->edges) light.add(x);
    for (const double x : m.fluorescence->matrix) light.add(x);
  }
  if (m.emission_spectrum) {
    for (const double x : m.emission_spectrum->edges) light.add(x);
    for (const double x : m.emission_spectrum->radiance) light.add(x);
  }
  light.add(m.checker_colour.value_or(Rgb(-1)));
  light.add(m.checker_size);
  for (const auto* ref : {&m.base_colour_texture, &m.metallic_roughness_texture, &m.normal_texture, &m.emission_texture,
                          &m.transmission_texture, &m.specular_texture, &m.specular_colour_texture}) {
    light.add(std::uint64_t{*ref ? (*ref)->texture + 1 : 0});
  }
}

void add_light(const Light& l, Hash& ways, Hash& light) {
  ways.add(std::uint64_t{l.kind.index()});
  if (const auto* p = std::get_if<PointLight>(&l.kind)) {
    ways.add(p->position), ways.add(p->range), ways.add(static_cast<float>(p->inverse_square));
    light.add(p->intensity);
    if (p->web) ways.add(std::uint64_t{p->web->web}), ways.add(p->web->nadir), ways.add(p->web->zero);
  } else if (const auto* s = std::get_if<SpotLight>(&l.kind)) {
    ways.add(s->position), ways.add(s->direction), ways.add(s->range);
    ways.add(s->inner_angle), ways.add(s->outer_angle);
    light.add(s->intensity);
  } else if (const auto* d = std::get_if<DirectionalLight>(&l.kind)) {
    ways.add(d->direction), ways.add(d->angular_radius);
    light.add(d->irradiance);
  }
}

void add_medium(const Medium& m, Hash& ways) {
  ways.add(m.absorption), ways.add(m.scattering), ways.add(m.asymmetry);
  if (m.box) ways.add(m.box->lower), ways.add(m.box->upper);
  if (m.density) ways.add(m.density->box.lower), ways.add(m.density->box.upper), ways.add_all(m.density->values);
}

}  // namespace

SceneFingerprint fingerprint(const Scene& scene) {
  Hash ways, light;
  add_surfaces(scene, ways);
  for (const Material& m : scene.materials) add_material(m, ways, light);
  for (const Light& l : scene.lights) add_light(l, ways, light);
  for (const PhotometricWeb& web : scene.webs) {
    ways.add_all(web.vertical), ways.add_all(web.horizontal), ways.add_all(web.candela);
  }
  for (const Medium& m : scene.media) add_medium(m, ways);
  if (!scene.air.empty()) ways.add_all(scene.air);
  ways.add(std::uint64_t{scene.environment ? 1U + scene.environment->image.value_or(0xffffffU) : 0U});
  light.add(scene.environment ? scene.environment->radiance : Rgb(0));
  for (const Mesh& mesh : scene.meshes) {
    light.add_all(mesh.uv[0]);
    light.add_all(mesh.colours);
  }
  for (const TextureImage& image : scene.images) {
    std::visit([&](const auto& texels) { light.add_all(texels); }, image.texels);
  }
  return {ways.value(), light.value()};
}

std::string to_text(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

std::uint64_t hash_of_text(const std::string& text) { return std::strtoull(text.c_str(), nullptr, 16); }

}  // namespace penumbra
