#pragma once

#include "penumbra/scene/camera.h"
#include "penumbra/tracing/ray_tracer.h"

namespace penumbra {

/// A camera for a scene that has none: outside an object, three-quarter view with all of it in the picture; inside,
/// along the longest view, when the scene is a room (its walls surround its middle).
/// @param vertical_fov rad. @param aspect width / height. @param up unit.
[[nodiscard]] Camera framing_camera(const RayTracer& tracer, double vertical_fov, double aspect, const Vec3d& up);

}  // namespace penumbra
