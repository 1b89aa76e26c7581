#pragma once

#include <filesystem>

#include "penumbra/io/load_report.h"

namespace penumbra {

/// Reads .gltf or .glb: the default scene's nodes (all root nodes when it names none), meshes as instances, materials,
/// textures, punctual lights (photometric values divided by 683 lm/W), cameras.
/// Extensions: KHR_lights_punctual, KHR_materials_{emissive_strength, ior, transmission, volume, specular, unlit},
/// KHR_texture_transform, KHR_mesh_quantization, KHR_draco_mesh_compression, EXT_texture_webp. An unknown required
/// one is an error that names it; an unknown optional one is one warning.
/// Every bound is checked before a byte is read. Throws FileError.
[[nodiscard]] LoadedScene read_gltf(const std::filesystem::path& path);

}  // namespace penumbra
