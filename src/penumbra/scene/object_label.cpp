#include "penumbra/scene/object_label.h"

#include <fmt/format.h>

namespace penumbra {

std::string object_label(const Scene& scene, std::size_t object) {
  const std::string& name = scene.object_name(object);
  if (!name.empty()) return name;
  if (object < scene.instances.size()) {
    const std::string& mesh_name = scene.meshes[scene.instances[object].mesh].name;
    if (!mesh_name.empty()) return mesh_name;
  }
  return fmt::format("object {}", object + 1);
}

}  // namespace penumbra
