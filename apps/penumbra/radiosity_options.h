#pragma once

#include <optional>
#include <string>

#include "option_parser.h"
#include "penumbra/radiosity/pipeline/scene_radiosity.h"

namespace penumbra::cli {

/// How to solve a scene's radiosity, as the user gave it; `bake` and `render --integrator radiosity` share it.
struct RadiosityOptions {
  std::string solver = "gauss-seidel";
  std::string form_factors = "auto";
  Subdivision subdivision = Subdivision::uniform;
  std::optional<double> element_size;
  std::optional<std::size_t> elements;
  std::optional<double> contrast;
  std::optional<double> factor_tolerance;
  std::optional<int> rays, resolution;
  std::optional<double> tolerance, stop_at;
  std::optional<std::size_t> max_iterations;
  std::optional<int> specular_rays;
  bool given = false;  ///< any of these was given
};

/// `options` must outlive `parser`'s last parse.
void add_radiosity_options(OptionParser& parser, RadiosityOptions& options);

/// Throws UsageError when an option does not apply to what was chosen.
void check(const RadiosityOptions& options);

/// As the library takes them. Factors may take 80 % of the memory that is free.
[[nodiscard]] RadiositySetupOptions setup_options(const RadiosityOptions& options, bool front_sides_only,
                                                  std::uint64_t seed);
[[nodiscard]] SolverOptions solver_options(const RadiosityOptions& options);

}  // namespace penumbra::cli
