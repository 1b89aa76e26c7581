#pragma once

#include <span>
#include <string>

#include "penumbra/scene/builtin_parameters.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

// The makers behind builtin_scenes.cpp, one file each.
[[nodiscard]] Scene make_cornell_box(const BuiltinParameters& parameters);
[[nodiscard]] Scene make_cornell_spheres(const BuiltinParameters& parameters);
[[nodiscard]] Scene make_whitted(const BuiltinParameters& parameters);
[[nodiscard]] Scene make_furnace(const BuiltinParameters& parameters);
[[nodiscard]] Scene make_box345(const BuiltinParameters& parameters);
[[nodiscard]] Scene make_atrium(const BuiltinParameters& parameters);
[[nodiscard]] Scene make_city(const BuiltinParameters& parameters);
[[nodiscard]] Scene make_fog(const BuiltinParameters& parameters);
[[nodiscard]] Scene make_smoke(const BuiltinParameters& parameters);
[[nodiscard]] Scene make_prism(const BuiltinParameters& parameters);
[[nodiscard]] Scene make_rainbow(const BuiltinParameters& parameters);
[[nodiscard]] Scene make_fluorescent(const BuiltinParameters& parameters);

// What they share.

/// Pure Lambert: no specular layer. @param emission radiance, W/(m^2 sr).
[[nodiscard]] Material lambertian(std::string name, const Rgb& reflectance, const Rgb& emission = Rgb(0.0F));

/// Appends and returns the index.
std::uint32_t add_material(Scene& scene, Material material);

/// Appends a mesh and its one instance, both called `mesh.name`.
void add_object(Scene& scene, Mesh mesh, const Mat4d& to_world = Mat4d(1.0));

/// Appends a planar convex face with vertices of its own, triangulated as a fan from its first corner.
/// @param corners counter-clockwise seen from the front, three or more.
void add_face(Mesh& mesh, std::span<const Vec3d> corners);

/// The six faces of a box, facing outwards, or inwards for a room. @param half half of its three edges, m.
void add_box(Mesh& mesh, const Mat4d& to_world, const Vec3d& half, bool facing_inwards);

}  // namespace penumbra
