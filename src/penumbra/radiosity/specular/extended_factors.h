#pragma once

#include <cstdint>
#include <vector>

#include "penumbra/parallel/progress.h"
#include "penumbra/radiosity/light_irradiance.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/radiosity/solvers/factor_rows.h"
#include "penumbra/radiosity/specular/specular_surfaces.h"
#include "penumbra/radiosity/specular_transport.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

struct ExtendedFactorOptions {
  int rays = 256;  ///< from each element to the specular elements that it sees; 2 or more
  bool front_sides_only = false;
  std::uint64_t seed = 0;
  Progress progress{};
};

/// What form factors between elements leave out: light by way of mirrors and glass.
struct ExtendedFactors {
  SpecularTransport transport;
  std::vector<LightIrradiance> lights;  ///< what lights without a body bring by that way; their `power` is not set
  std::uint64_t rays = 0;               ///< traced
  bool partial = false;                 ///< stopped from outside; missing entries read as 0
};

/// The extended form factors of a scene beyond its plain ones (Wallace, Cohen & Greenberg 1987; Sillion & Puech 1989).
///
/// Each element sends rays to the specular elements that it sees, all together with the weight that the form factors
/// give them, and the recursion of Whitted goes on from there; what a ray lands on is what the element sees that way.
/// Small lamps would be met by few of these rays (caustics): where elements that emit make up little of the scene,
/// their light is shot the other way instead, from the lamp to where it lands, and so is that of lights without a body.
/// The same bits on any number of threads. @param rows the form factors; those of specular elements are read.
[[nodiscard]] ExtendedFactors make_extended_factors(const Scene& scene, const PatchMesh& elements,
                                                    const SpecularElements& specular, const FactorRowSource& rows,
                                                    const ExtendedFactorOptions& options = {});

}  // namespace penumbra
