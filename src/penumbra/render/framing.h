#pragma once

#include <optional>

#include "penumbra/scene/camera.h"
#include "penumbra/tracing/ray_tracer.h"

namespace penumbra {

/// A camera for a scene that has none: outside an object, three-quarter view with all of it in the picture; inside,
/// where there is most to see, when the scene is a room (surfaces that show their fronts all around).
/// @param vertical_fov rad; none: 40 degrees for an object, 65 in a room. @param aspect width / height. @param up unit.
[[nodiscard]] Camera framing_camera(const RayTracer& tracer, std::optional<double> vertical_fov, double aspect,
                                    const Vec3d& up);

}  // namespace penumbra
