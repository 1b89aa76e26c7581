#include <array>
#include <stdexcept>
#include <string>
#include <utility>

#include "penumbra/radiosity/form_factors/adaptive.h"
#include "penumbra/radiosity/form_factors/auto.h"
#include "penumbra/radiosity/form_factors/contact_factors.h"
#include "penumbra/radiosity/form_factors/form_factor_method.h"
#include "penumbra/radiosity/form_factors/hemicube.h"
#include "penumbra/radiosity/form_factors/near_origin.h"
#include "penumbra/radiosity/form_factors/pair_methods.h"
#include "penumbra/radiosity/form_factors/ray_cast.h"

// The methods by name. A new one is added to `names` and to make_by_name.

namespace penumbra {
namespace {

constexpr std::array<std::string_view, 7> names{"point",    "nusselt",  "hemicube", "analytic",
                                                "adaptive", "ray-cast", "auto"};

std::unique_ptr<FormFactorMethod> make_hemicube_of(const PatchMesh& mesh, const FormFactorOptions& options) {
  HemicubeOptions hemicube;
  if (options.resolution != 0) hemicube.resolution = options.resolution;
  hemicube.seed = options.seed;
  return make_hemicube(mesh, hemicube);
}

std::unique_ptr<FormFactorMethod> make_adaptive_of(const PatchMesh& mesh, const FormFactorOptions& options) {
  AdaptiveOptions adaptive;
  adaptive.tolerance = options.tolerance;
  adaptive.between_surfaces_only = options.between_surfaces_only;
  return make_adaptive(mesh, adaptive);
}

std::unique_ptr<FormFactorMethod> make_ray_cast_of(const PatchMesh& mesh, const FormFactorOptions& options) {
  RayCastOptions rays;
  rays.rays = options.rays;
  rays.tolerance = options.tolerance;
  rays.seed = options.seed;
  return make_ray_cast(mesh, rays);
}

std::unique_ptr<FormFactorMethod> make_by_name(std::string_view name, const PatchMesh& mesh,
                                               const FormFactorOptions& options) {
  if (name == "point") return make_point(mesh);
  if (name == "nusselt") return make_nusselt(mesh);
  if (name == "hemicube") return make_hemicube_of(mesh, options);
  if (name == "analytic") return make_analytic(mesh);
  if (name == "adaptive") return make_adaptive_of(mesh, options);
  if (name == "ray-cast") return make_ray_cast_of(mesh, options);
  if (name == "auto") return std::make_unique<AutoFormFactors>(mesh, options);

  std::string known;
  for (std::string_view n : names) known += (known.empty() ? "" : ", ") + std::string(n);
  throw std::invalid_argument("unknown form factor method \"" + std::string(name) + "\"; known are: " + known);
}

}  // namespace

std::span<const std::string_view> form_factor_method_names() { return names; }

std::unique_ptr<FormFactorMethod> make_form_factor_method(std::string_view name, const PatchMesh& mesh,
                                                          const FormFactorOptions& options) {
  auto method = make_near_origin(mesh, [&](const PatchMesh& near) { return make_by_name(name, near, options); });
  return with_contacts(std::move(method), mesh);
}

}  // namespace penumbra
