#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common_options.h"
#include "factor_geometry.h"
#include "penumbra/radiosity/form_factors/adaptive.h"
#include "penumbra/radiosity/form_factors/form_factor_method.h"
#include "penumbra/radiosity/form_factors/hemicube.h"

namespace penumbra::cli {

enum class NormalizationKind { none, rows, least_squares };

/// Everything that the `factors` command was told.
struct FactorArguments {
  FactorGeometryOptions geometry;
  std::string output;
  std::string method = "auto";
  std::optional<double> tolerance;
  std::optional<int> rays;
  std::optional<int> resolution;
  std::optional<double> hemicube_near;
  std::optional<HemicubeVisibility> hemicube_visibility;
  bool hemicube_rotate = false;
  std::optional<AdaptiveVisibility> adaptive_visibility;
  NormalizationKind normalization = NormalizationKind::none;
  std::optional<std::string> row;  ///< of the .vtu: a name or an index
  CommonOptions common;

  /// The tolerance that holds when none was given.
  [[nodiscard]] double used_tolerance() const { return tolerance.value_or(1e-4); }
};

/// Reads and checks them. Nothing when the user asked for help. Throws UsageError.
[[nodiscard]] std::optional<FactorArguments> parse_factor_arguments(const std::vector<std::string>& arguments);

/// The method that was asked for, prepared. Throws std::invalid_argument.
[[nodiscard]] std::unique_ptr<FormFactorMethod> make_method(const FactorArguments& arguments, const PatchMesh& mesh);

}  // namespace penumbra::cli
