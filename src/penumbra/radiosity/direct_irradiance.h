#pragma once

#include <cstdint>
#include <vector>

#include "penumbra/parallel/progress.h"
#include "penumbra/radiosity/light_irradiance.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

struct DirectIrradianceOptions {
  /// Shadow rays from each element to each point, spot or far light; sixteen times as many where some of them meet the
  /// light and some do not, or where its cone or range ends. At least 1.
  int samples = 16;
  int sky_samples = 256;    ///< rays from each element to the environment
  int shape_segments = 32;  ///< as the elements were made
  std::uint64_t seed = 0;
  Progress progress{};
};

/// What the lights that are no elements bring, for RadiosityProblem.
struct DirectIrradiance {
  std::vector<double> irradiance;   ///< mean over each element, [element * 3 + band], W/m^2; empty without such lights
  std::vector<double> light_power;  ///< [band], W: flux of points and spots; of sun and sky what reaches the elements
  std::vector<LightIrradiance> lights;  ///< the same light by light, for other strengths
  bool partial = false;                 ///< stopped from outside; the rest of the elements have 0
};

/// Mean irradiance of each element straight from point, spot and far lights and the environment. The faces of the scene
/// stand in the way, all opaque, as they do for form factors. Each light shines on the side it is on.
///
/// Visibility is the share of shadow rays from Owen-scrambled Sobol points that get through. What a point light would
/// bring unhindered is exact, its intensity times the polygon's solid angle over its area, and so is a far light's; so
/// a point light in a closed room gives all its flux. Ambient light is left out: interreflection takes its place. A
/// point light without falloff (Whitted's) counts as emitting what reaches the elements.
[[nodiscard]] DirectIrradiance direct_irradiance(const Scene& scene, const PatchMesh& elements,
                                                 const DirectIrradianceOptions& options = {});

}  // namespace penumbra
