#include "penumbra/scene/energy.h"

#include <fmt/format.h>

namespace penumbra {
namespace {

constexpr float rounding = 1e-4F;  // of a reflectance in a file

SentOn sent_on(const Material& m, const Rgb& base_colour) {
  const float transmitting = (1 - m.metallic) * m.transmission;
  SentOn most;
  for (int band = 0; band < 3; ++band) {
    const SentOn here{.reflected = m.mirror[band] + (1 - transmitting) * base_colour[band],
                      .transmitted = transmitting * base_colour[band]};
    if (here.sum() > most.sum()) most = here;
  }
  return most;
}

}  // namespace

SentOn sent_on(const Material& material) {
  SentOn most = sent_on(material, material.base_colour);
  const auto keep_larger = [&](const SentOn& other) {
    if (other.sum() > most.sum()) most = other;
  };
  if (material.checker_colour) keep_larger(sent_on(material, *material.checker_colour));
  // All that light of one band becomes, at its own and at longer wavelengths.
  if (material.fluorescence) {
    keep_larger({.reflected = static_cast<float>(material.fluorescence->largest_column_sum())});
  }
  return most;
}

std::vector<std::uint32_t> materials_beyond_energy(const Scene& scene) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < scene.materials.size(); ++i) {
    if (!scene.materials[i].unlit && sent_on(scene.materials[i]).sum() > 1 + rounding) found.push_back(i);
  }
  return found;
}

void fix_energy(Scene& scene) {
  for (const std::uint32_t i : materials_beyond_energy(scene)) {
    Material& m = scene.materials[i];
    const float scale = 1 / sent_on(m).sum();
    m.base_colour *= scale;
    m.mirror *= scale;
    if (m.checker_colour) *m.checker_colour *= scale;
    if (!m.fluorescence) continue;
    for (double& share : m.fluorescence->matrix) share *= static_cast<double>(scale);
  }
}

std::string material_label(const Scene& scene, std::size_t material) {
  const std::string& name = scene.materials[material].name;
  return name.empty() ? fmt::format("material {}", material + 1) : fmt::format("material \"{}\"", name);
}

}  // namespace penumbra
