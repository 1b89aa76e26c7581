#pragma once

#include <string>
#include <vector>

#include "penumbra/io/matrix_reader.h"
#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/solvers/heat_exchange.h"

namespace penumbra::cli {

/// Factors with the thermal data of each row.
struct HeatModel {
  std::vector<HeatSurface> surfaces;
  FactorMatrix factors;
};

/// Joins a file of factors with a table of surfaces: `name,emissivity` and `temperature_K` or `heat_flux_W_m2`, one of
/// the two filled in each row; `area_m2` where the factors say no areas. Rows are matched by name where the factors
/// have names that differ, else they stand in the factors' order. Throws FileError with the line.
[[nodiscard]] HeatModel read_heat_model(const std::string& factors, const std::string& surfaces);

}  // namespace penumbra::cli
