#pragma once

#include "penumbra/render/diffuse_light.h"
#include "penumbra/render/integrator.h"

namespace penumbra {

/// Two-pass rendering (Wallace, Cohen & Greenberg 1987; Sillion & Puech 1989): diffuse surfaces have the light that the
/// first pass found, the lamps' own part of it exactly; mirrors, glass and polished layers are followed by Whitted's
/// recursion, rougher gloss by one ray by chance and shadow rays to the lights. Glass stops shadow rays: what it lets
/// through is in the solution. Reads max_depth, min_throughput, final_gather, seed and sides of the options.
[[nodiscard]] std::unique_ptr<Integrator> make_two_pass(const RayTracer& tracer, const DiffuseLight& light,
                                                        const CameraRays& camera, const RenderOptions& options);

/// Draws a picture that way. `light` is of the tracer's scene. Bit-identical for any number of threads. Throws
/// std::invalid_argument for options out of range.
[[nodiscard]] RenderResult render(const RayTracer& tracer, const DiffuseLight& light, const Camera& camera,
                                  const RenderOptions& options, const Progress& progress = {});

}  // namespace penumbra
