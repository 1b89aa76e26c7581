#pragma once

#include "penumbra/render/camera_rays.h"
#include "penumbra/render/direct_light.h"
#include "penumbra/render/shadow_boundaries.h"
#include "penumbra/tracing/shading/specular_tree.h"

namespace penumbra {

/// The first pass of selective shadow rays: one camera ray through each pixel, its tree of mirror and refraction rays
/// as far as `options` let it grow (appel follows none), and from each surface one shadow ray to each lamp. The points
/// of a lamp that the 16 pixels of a block of 4 x 4 ask for are spread evenly over it, so that a strip that hides a
/// sixteenth of its length or breadth is met by at least one of them.
///
/// Its random numbers are its own: where extra rays go does not depend on those that make the picture, which keeps the
/// picture's mean (Kirk & Arvo, "Unbiased Sampling Techniques for Image Synthesis", 1991).
/// @param rays counts what is sent.
[[nodiscard]] ShadowBoundaries scout_shadows(const DirectLight& light, const SpecularTree& tree,
                                             const CameraRays& camera, const RenderOptions& options, RayCounts& rays);

}  // namespace penumbra
