#include "penumbra/radiosity/solvers/solver.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <stdexcept>

#include "penumbra/radiosity/solvers/direct.h"
#include "penumbra/radiosity/solvers/gauss_seidel.h"
#include "penumbra/radiosity/solvers/jacobi.h"
#include "penumbra/radiosity/solvers/progressive.h"
#include "penumbra/radiosity/solvers/shooting.h"

namespace penumbra {
namespace {

constexpr std::array<std::string_view, 5> names{"direct", "jacobi", "gauss-seidel", "shooting", "progressive"};

}  // namespace

std::span<const std::string_view> solver_names() { return names; }

RadiositySolution solve_radiosity(std::string_view name, const RadiosityProblem& problem, const FactorMatrix& factors,
                                  const SolverOptions& options) {
  if (name == "direct") return solve_direct(problem, factors, options);
  if (name == "jacobi") return solve_jacobi(problem, factors, options);
  if (name == "gauss-seidel") return solve_gauss_seidel(problem, factors, options);
  if (name == "shooting") return solve_shooting(problem, factors, options);
  if (name == "progressive") return solve_progressive(problem, factors, options);
  throw std::invalid_argument(fmt::format("unknown radiosity solver '{}' (solvers: {})", name, fmt::join(names, ", ")));
}

}  // namespace penumbra
