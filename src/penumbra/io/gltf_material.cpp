#include "penumbra/io/gltf_material.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string_view>

namespace penumbra {
namespace {

constexpr double unbounded = std::numeric_limits<float>::max();

/// Reads one material; the steps follow the file's own layout.
class MaterialReader {
 public:
  MaterialReader(GltfDocument& document, GltfTextures& textures, const JsonPlace& place)
      : warnings_(&document.warnings()), textures_(&textures), place_(place) {}

  Material read() {
    made_ = gltf_default_material();
    made_.name = place_.text("name");
    if (made_.name.empty()) made_.name = place_.place();
    read_base();
    read_surface();
    if (const auto extensions = place_.object("extensions")) read_extensions(*extensions);
    if (const auto extras = place_.extras("penumbra")) read_extras(*extras);
    made_.extras = place_.extras_without("penumbra");
    if (emission_unreadable_) made_.emission = Rgb(0.0F);
    return made_;
  }

 private:
  float clamped(double value, double least, double most, const JsonPlace& at) {
    if (value < least || value > most) {
      warnings_->count("a material's value outside its range was clamped", at.place());
    }
    return static_cast<float>(std::clamp(value, least, most));
  }
  float factor(const JsonPlace& at, std::string_view key, float fallback, double least = 0, double most = 1) {
    return clamped(at.number(key, static_cast<double>(fallback)), least, most, at);
  }
  Rgb colour(const JsonPlace& at, std::string_view key, const Rgb& fallback, double most = 1) {
    const auto c = at.numbers<3>(key, {double(fallback.x), double(fallback.y), double(fallback.z)});
    return {clamped(c[0], 0, most, at), clamped(c[1], 0, most, at), clamped(c[2], 0, most, at)};
  }
  std::optional<TextureRef> texture(const JsonPlace& at, std::string_view key) {
    bool unreadable = false;
    const auto ref = textures_->read(at, key, unreadable);
    if (key == "emissiveTexture") emission_unreadable_ = at.has(key) && !ref;
    return ref;
  }

  void read_base() {
    const auto base = place_.object("pbrMetallicRoughness");
    if (!base) return;
    const auto rgba = base->numbers<4>("baseColorFactor", {1, 1, 1, 1});
    made_.base_colour = {clamped(rgba[0], 0, 1, *base), clamped(rgba[1], 0, 1, *base), clamped(rgba[2], 0, 1, *base)};
    made_.alpha = clamped(rgba[3], 0, 1, *base);
    made_.metallic = factor(*base, "metallicFactor", 1);
    made_.roughness = factor(*base, "roughnessFactor", 1);
    made_.base_colour_texture = texture(*base, "baseColorTexture");
    made_.metallic_roughness_texture = texture(*base, "metallicRoughnessTexture");
  }

  void read_surface() {
    made_.emission = colour(place_, "emissiveFactor", Rgb(0.0F), unbounded);
    made_.emission_texture = texture(place_, "emissiveTexture");
    made_.normal_texture = texture(place_, "normalTexture");
    if (const auto normal = place_.object("normalTexture")) {
      made_.normal_scale = factor(*normal, "scale", 1, -unbounded, unbounded);
    }
    made_.double_sided = place_.flag("doubleSided", false);
    made_.alpha_cutoff = factor(place_, "alphaCutoff", 0.5F, 0, unbounded);
    const std::string mode = place_.text("alphaMode");
    if (mode == "MASK") made_.alpha_mode = AlphaMode::mask;
    if (mode == "BLEND") made_.alpha_mode = AlphaMode::blend;
    if (!mode.empty() && mode != "OPAQUE" && mode != "MASK" && mode != "BLEND") {
      place_.fail("its alphaMode is none of OPAQUE, MASK and BLEND; export the file again");
    }
  }

  void read_extensions(const JsonPlace& extensions) {
    if (const auto strength = extensions.object("KHR_materials_emissive_strength")) {
      made_.emission *= factor(*strength, "emissiveStrength", 1, 0, unbounded);
      if (max_component(made_.emission) > std::numeric_limits<float>::max())
        strength->fail("its emission is not finite");
    }
    if (const auto ior = extensions.object("KHR_materials_ior")) {
      // 0 is allowed and means a Fresnel reflectance of 1.
      const double value = ior->number("ior", 1.5);
      made_.ior = value == 0 ? 0.0F : clamped(value, 1, unbounded, *ior);
    }
    if (const auto specular = extensions.object("KHR_materials_specular")) {
      made_.specular = factor(*specular, "specularFactor", 1);
      made_.specular_colour = colour(*specular, "specularColorFactor", Rgb(1.0F), unbounded);
      made_.specular_texture = texture(*specular, "specularTexture");
      made_.specular_colour_texture = texture(*specular, "specularColorTexture");
    }
    if (const auto transmission = extensions.object("KHR_materials_transmission")) {
      made_.transmission = factor(*transmission, "transmissionFactor", 0);
      made_.transmission_texture = texture(*transmission, "transmissionTexture");
    }
    read_volume(extensions.object("KHR_materials_volume"));
    if (const auto dispersion = extensions.object("KHR_materials_dispersion")) {
      // 20 over Abbe's number.
      const double value = dispersion->number("dispersion", 0);
      if (value < 0) dispersion->fail("its dispersion must not be negative");
      if (value > 0 && made_.ior > 1) made_.dispersion = cauchy_of_abbe(double{made_.ior}, 20 / value);
    }
    made_.unlit = extensions.object("KHR_materials_unlit").has_value();
  }

  // Without a volume, or at thickness 0, glTF's surface is infinitely thin: light goes straight through it.
  void read_volume(const std::optional<JsonPlace>& volume) {
    made_.thin_walled = made_.transmission > 0 && !(volume && volume->number("thicknessFactor", 0) > 0);
    if (!volume || made_.thin_walled) return;
    made_.attenuation_colour = colour(*volume, "attenuationColor", Rgb(1.0F));
    if (const auto distance = volume->number("attenuationDistance")) {
      if (!(*distance > 0)) volume->fail("its attenuationDistance must be more than 0 metres");
      made_.attenuation_distance = clamped(*distance, std::numeric_limits<float>::min(), unbounded, *volume);
    }
  }

  void read_extras(const JsonPlace& extras) {
    made_.mirror = colour(extras, "mirror", Rgb(0.0F));
    if (const auto checker = extras.object("checker")) {
      made_.checker_colour = colour(*checker, "colour", Rgb(0.0F));
      made_.checker_size = static_cast<float>(checker->number("size", 1));
      if (!(made_.checker_size > 0)) checker->fail("its size must be more than 0 metres");
    }
    read_spectra(extras);
  }

  void read_spectra(const JsonPlace& extras) {
    if (const auto glass = extras.object("sellmeier")) {
      made_.dispersion = Sellmeier{glass->numbers<3>("b", {}), glass->numbers<3>("c_um2", {})};
    }
    if (const auto glass = extras.object("cauchy")) {
      made_.dispersion = Cauchy{glass->number("a", 1.5), glass->number("b_um2", 0), glass->number("c_um4", 0)};
    }
    if (made_.dispersion) {
      const double index = refractive_index(*made_.dispersion, line_d);
      if (!(index >= 1 && index <= 100)) extras.fail("its dispersion gives no index of refraction at 587.6 nm");
      made_.ior = static_cast<float>(index);
    }
    if (const auto dye = extras.object("fluorescence")) {
      made_.fluorescence = Fluorescence{dye->number_list("edges_nm"), dye->number_list("matrix")};
      refuse_invalid(*made_.fluorescence, *dye);
    }
    if (const auto lamp = extras.object("emission_spectrum")) {
      made_.emission_spectrum = EmissionSpectrum{lamp->number_list("edges_nm"), lamp->number_list("radiance")};
      refuse_invalid(*made_.emission_spectrum, *lamp);
      made_.emission = made_.emission_spectrum->colour();
    }
  }

  template <class Part>
  static void refuse_invalid(const Part& part, const JsonPlace& at) {
    try {
      validate(part);
    } catch (const std::invalid_argument& wrong) {
      at.fail(wrong.what());
    }
  }

  WarningTally* warnings_;
  GltfTextures* textures_;
  JsonPlace place_;
  Material made_;
  bool emission_unreadable_ = false;
};

}  // namespace

Material gltf_default_material() {
  Material made;
  made.name = "default";
  made.base_colour = Rgb(1.0F);
  made.metallic = 1;
  made.roughness = 1;
  return made;
}

Material read_gltf_material(GltfDocument& document, GltfTextures& textures, std::uint64_t index) {
  return MaterialReader(document, textures, document.item("materials", "material", index, document.root())).read();
}

}  // namespace penumbra
