#include <array>
#include <stdexcept>
#include <string>

#include "penumbra/radiosity/form_factors/auto.h"
#include "penumbra/radiosity/form_factors/form_factor_method.h"

// The methods by name. A new one is added to `names` and to make_form_factor_method.

namespace penumbra {
namespace {

constexpr std::array<std::string_view, 1> names{"auto"};

}  // namespace

std::span<const std::string_view> form_factor_method_names() { return names; }

std::unique_ptr<FormFactorMethod> make_form_factor_method(std::string_view name, const PatchMesh& mesh,
                                                          const FormFactorOptions& options) {
  if (name == "auto") return std::make_unique<AutoFormFactors>(mesh, options);

  std::string known;
  for (std::string_view n : names) known += (known.empty() ? "" : ", ") + std::string(n);
  throw std::invalid_argument("unknown form factor method \"" + std::string(name) + "\"; known are: " + known);
}

}  // namespace penumbra
