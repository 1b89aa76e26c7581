#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "penumbra/math/bounds.h"
#include "penumbra/scene/camera.h"
#include "penumbra/scene/light.h"
#include "penumbra/scene/material.h"
#include "penumbra/scene/medium.h"
#include "penumbra/scene/mesh.h"
#include "penumbra/scene/motion.h"
#include "penumbra/scene/shape.h"
#include "penumbra/scene/texture.h"

namespace penumbra {

/// A mesh placed in the world.
struct Instance {
  std::string name;
  std::uint32_t mesh = 0;  ///< index into Scene::meshes
  Mat4d to_world{1.0};     ///< affine; when it mirrors, the front of each triangle stays the front
  Motion motion{};         ///< where it is while the shutter is open; empty: it rests at `to_world`
  std::string extras{};    ///< what the file says besides, as JSON: glTF's extras of its node; empty: nothing
};

/// An exact primitive with its material.
struct ShapeObject {
  std::string name;
  Shape shape;
  std::uint32_t material = 0;  ///< index into Scene::materials
};

/// What is to be lit and seen: plain values, right-handed world, +Y up, metres, W, linear Rec. 709.
///
/// Objects are numbered: the instances first, then the shapes.
struct Scene {
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<ShapeObject> shapes;
  std::vector<Material> materials;  ///< never empty in a valid scene with objects
  std::vector<Texture> textures;
  std::vector<TextureImage> images;
  std::vector<Light> lights;
  std::vector<PhotometricWeb> webs;  ///< of lights that have one
  std::optional<Environment> environment;
  std::vector<Medium> media;
  /// Indices into media: what fills the open air. Inside closed surfaces that are seen through (glass, or a material
  /// with a medium) their own medium stands instead. At most `most_media_in_air`; where several are, they add up.
  std::vector<std::uint32_t> air;
  std::vector<Camera> cameras;
  std::string extras{};  ///< as Instance::extras, of the file's scene

  [[nodiscard]] std::size_t object_count() const { return instances.size() + shapes.size(); }
  [[nodiscard]] const std::string& object_name(std::size_t object) const {
    return object < instances.size() ? instances[object].name : shapes[object - instances.size()].name;
  }
  /// Triangles drawn, instances counted each time.
  [[nodiscard]] std::size_t triangle_count() const;
  /// World bounds of everything but infinite planes.
  [[nodiscard]] Bounds bounds() const;
};

/// Throws std::invalid_argument that names the object when an index points outside its array, an array's length is
/// not what its docstring says, or a value is not finite. Readers call it last.
void validate(const Scene& scene);

}  // namespace penumbra
