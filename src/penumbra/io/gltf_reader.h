#pragma once

#include <filesystem>

#include "penumbra/io/load_report.h"
#include "penumbra/io/read_options.h"

namespace penumbra {

/// Reads .gltf or .glb (by its first bytes): the nodes of the scene chosen, else of the default scene (of the first
/// when none is named, of all roots when there are no scenes), meshes as instances, materials, textures, punctual
/// lights (photometric values divided by 683 lm/W), cameras.
///
/// Extensions: KHR_lights_punctual, KHR_materials_{emissive_strength, ior, transmission, volume, specular, unlit},
/// KHR_texture_transform, KHR_mesh_quantization, KHR_draco_mesh_compression, EXT_meshopt_compression,
/// EXT_texture_webp. An unknown required
/// one is an error that names it; an unknown optional one is one warning. Transmission without a volume of some
/// thickness is thin-walled.
///
/// A glTF mesh becomes one Mesh, with a material for each triangle where its primitives differ; primitives with other
/// vertex attributes than the first's become Meshes of their own. Skins and morph targets bend meshes, at rest or at a
/// time of an animation; each node with one then has a Mesh of its own. Points and lines are warnings. An instance
/// bears the name of its node, else of its mesh; missing normals stay missing. An image that cannot be read is a
/// warning: the factors stand for it, black for emission.
///
/// What glTF has no words for is read from `extras.penumbra` (all optional; colours linear Rec. 709):
/// - of a light: `{"falloff": "none"}`, a point light without distance falloff (PointLight::inverse_square);
/// - of a material: `{"mirror": [r, g, b]}` (Material::mirror) and
///   `{"checker": {"colour": [r, g, b], "size": metres}}` (Material::checker_colour, checker_size);
/// - of a material: `{"medium": {...}}`, what its closed mesh holds (Material::medium); of the scene: `{"media":
///   [{...}]}`, what fills the open air (Scene::air). A medium: `"absorption"` and `"scattering"` [r, g, b] in 1/m,
///   `"g"`, `"name"`; `"lower"` and `"upper"` [x, y, z], the corners of its box, m; `"density": {"file": "smoke.npz"}`
///   (see read_density_grid) or `{"bufferView": n, "cells": [nx, ny, nz]}`, single-precision floats that fill the box;
/// - of a light: `{"ies": "lamp.ies"}`, a photometric file for a point or spot light (see wear_web);
/// `{"angular_radius":
///   rad}`, the disk of a directional one;
/// - of the scene: `{"environment": {"radiance": [r, g, b], "backdrop_only": bool}}` in W/(m^2 sr) and
///   `{"ambient": [r, g, b]}`, an AmbientLight.
///
/// URIs name files in the glTF's folder or below it (AssetFolder), or hold data themselves; schemes such as http: are
/// refused. The unit of `options` does not apply: glTF is in metres. Every bound is checked before a byte is read.
/// Throws FileError.
[[nodiscard]] LoadedScene read_gltf(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace penumbra
