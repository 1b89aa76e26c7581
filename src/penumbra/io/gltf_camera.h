#pragma once

#include "penumbra/io/json_place.h"
#include "penumbra/math/transform.h"
#include "penumbra/scene/camera.h"

namespace penumbra {

/// A glTF camera, placed by the world matrix of its node (whose scale it does not take). Clipping planes and aspect
/// ratio are left out: nothing is clipped, and the picture has its own shape. Throws FileError.
[[nodiscard]] Camera read_gltf_camera(const JsonPlace& place, const Mat4d& to_world);

}  // namespace penumbra
