#include "penumbra/radiosity/specular/specular_surfaces.h"

#include <algorithm>

#include "penumbra/radiosity/meshing/face_table.h"
#include "penumbra/tracing/shading/bsdf.h"
#include "penumbra/tracing/shading/specular_tree.h"

namespace penumbra {
namespace {

bool all_zero(const std::vector<double>& values, std::size_t element) {
  return values[3 * element] == 0 && values[3 * element + 1] == 0 && values[3 * element + 2] == 0;
}

}  // namespace

bool is_specular(const Material& m) {
  if (m.unlit) return false;
  if (!is_black(m.mirror) || m.metallic > 0 || m.transmission > 0) return true;
  return m.specular > 0 && !m.metallic_roughness_texture && m.roughness <= static_cast<float>(followed_roughness);
}

bool SpecularElements::any() const { return std::find(specular.begin(), specular.end(), true) != specular.end(); }

SpecularElements find_specular_elements(const Scene& scene, const PatchMesh& elements, int shape_segments) {
  const FaceTable faces(scene, shape_segments);
  SpecularElements found;
  for (std::size_t i = 0; i < elements.surface_count(); ++i) {
    found.materials.push_back(faces.material(elements.surfaces[i].face));
    found.specular.push_back(is_specular(scene.materials[found.materials.back()]));
    found.only_specular.push_back(found.specular[i] && all_zero(elements.reflectance, i) &&
                                  all_zero(elements.emission, i));
  }
  return found;
}

void share_reflectance(const Scene& scene, const SpecularElements& specular, PatchMesh& elements) {
  std::vector<Rgb> share(scene.materials.size());
  for (std::size_t m = 0; m < share.size(); ++m) {
    share[m] = Bsdf(surface_material(scene.materials[m]), Frame(), Vec3d(0, 0, 1)).share_of_base();
  }
  for (std::size_t i = 0; i < elements.surface_count(); ++i) {
    if (!specular.specular[i]) continue;
    for (int b = 0; b < 3; ++b) {
      elements.reflectance[3 * i + static_cast<std::size_t>(b)] *= static_cast<double>(share[specular.materials[i]][b]);
    }
  }
}

}  // namespace penumbra
