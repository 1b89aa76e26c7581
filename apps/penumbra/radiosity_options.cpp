#include "radiosity_options.h"

#include <algorithm>
#include <initializer_list>
#include <limits>

#include "memory_limit.h"
#include "penumbra/radiosity/solvers/solver.h"
#include "usage_error.h"

namespace penumbra::cli {
namespace {

constexpr long long most_elements = 100'000'000;
constexpr long long most_iterations = 1'000'000'000;
constexpr double share_of_memory = 0.8;
// From here on `auto` takes minutes (DamagedHelmet, 30,904 elements: 6e9); rays take seconds, however many polygons
// there are.
constexpr double most_crowding = 1e9;

const std::vector<std::pair<std::string, Subdivision>> subdivisions{
    {"none", Subdivision::none}, {"uniform", Subdivision::uniform}, {"adaptive", Subdivision::adaptive}};

template <class Names>
std::vector<std::pair<std::string, std::string>> choices_of(const Names& names) {
  std::vector<std::pair<std::string, std::string>> choices;
  for (const std::string_view name : names) choices.emplace_back(name, name);
  return choices;
}

void add_mesh_options(OptionParser& parser, RadiosityOptions& o) {
  parser.value(
      "--subdivide", "none|uniform|adaptive",
      "none keeps one element an input polygon, uniform cuts all to one size, adaptive cuts along shadow lines "
      "and where the light varies (default: uniform)",
      [&](const OptionValue& v) {
        o.subdivision = choice<Subdivision>(v, subdivisions);
        o.given = true;
      });
  parser.value(
      "--element-size", "M",
      "longest edge of an element, m; a rectangle becomes a grid of ceil(edge / M) each way (adaptive: to begin "
      "with)",
      [&](const OptionValue& v) {
        o.element_size = number_above_zero(v, "a length in metres above 0");
        o.given = true;
      });
  parser.value("--elements", "N",
               "cut the scene into about this many elements, both sides counted (adaptive: at most) (default: 5000)",
               [&](const OptionValue& v) {
                 o.elements = static_cast<std::size_t>(whole_number(v, 1, most_elements, "elements"));
                 o.given = true;
               });
}

void add_contrast_option(OptionParser& parser, RadiosityOptions& o) {
  parser.value("--contrast", "X",
               "adaptive: elements whose interpolated light is within this share of the scene's brightest are not cut "
               "further (default: 1e-3)",
               [&](const OptionValue& v) {
                 o.contrast = number_above_zero(v, "a share above 0, such as 1e-3");
                 o.given = true;
               });
}

void add_factor_options(OptionParser& parser, RadiosityOptions& o) {
  parser.value(
      "--form-factors", "NAME",
      "point, nusselt, hemicube, analytic, adaptive, ray-cast or auto, which casts rays where very many polygons "
      "stand between the elements and no --factor-tolerance is given (default: auto)",
      [&](const OptionValue& v) {
        o.form_factors = choice<std::string>(v, choices_of(form_factor_method_names()));
        o.given = true;
      });
  parser.value("--factor-tolerance", "X",
               "for each element, the sum over j of |error of F_ij| is at most this (auto, adaptive; ray-cast at its 3 "
               "sigma) (default: 1e-3)",
               [&](const OptionValue& v) {
                 o.factor_tolerance = number_above_zero(v, "a number above 0, such as 1e-3");
                 o.given = true;
               });
  parser.value("--rays", "N", "rays an element (ray-cast) (default: doubled until the tolerance is met)",
               [&](const OptionValue& v) {
                 o.rays = static_cast<int>(whole_number(v, 16, 1 << 28, "rays an element"));
                 o.given = true;
               });
  parser.value("--resolution", "N", "pixels along the hemicube's top, even (hemicube) (default: 128)",
               [&](const OptionValue& v) {
                 o.resolution = static_cast<int>(whole_number(v, 2, 4096, "pixels"));
                 if (*o.resolution % 2 != 0)
                   throw UsageError("--resolution takes an even number, not '" + v.text + "'");
                 o.given = true;
               });
}

void add_specular_option(OptionParser& parser, RadiosityOptions& o) {
  parser.value(
      "--specular-rays", "N",
      "rays from each element to the mirrors, metals and glass that it sees, for light that comes that way; 0: "
      "they absorb what they do not reflect diffusely (default: 256)",
      [&](const OptionValue& v) {
        o.specular_rays = static_cast<int>(whole_number(v, 0, 1 << 24, "rays an element"));
        if (*o.specular_rays == 1) throw UsageError("--specular-rays takes 0, or 2 and more, not '1'");
        o.given = true;
      });
}

void add_iteration_options(OptionParser& parser, RadiosityOptions& o) {
  parser.value(
      "--tolerance", "R",
      "stop when the largest residual is at most this share of the largest emission (default: 1e-4, and no more "
      "than 1e-4 of the emitted energy is unshot)",
      [&](const OptionValue& v) {
        o.tolerance = real_number(v, "a number of 0 or more, such as 1e-4");
        if (*o.tolerance < 0) throw UsageError("--tolerance takes 0 or more, not '" + v.text + "'");
        o.given = true;
      });
  parser.value("--stop-at", "FRACTION",
               "stop when this share of the emitted energy was shot (shooting, progressive) (default: 0.9999)",
               [&](const OptionValue& v) {
                 o.stop_at = real_number(v, "a share above 0 and at most 1");
                 if (!(*o.stop_at > 0 && *o.stop_at <= 1)) {
                   throw UsageError("--stop-at takes a share above 0 and at most 1, not '" + v.text + "'");
                 }
                 o.given = true;
               });
  parser.value("--max-iterations", "N",
               "stop after this many sweeps, bounces or shots (default: when it has converged)",
               [&](const OptionValue& v) {
                 o.max_iterations = static_cast<std::size_t>(whole_number(v, 1, most_iterations, "iterations"));
                 o.given = true;
               });
}

}  // namespace

void add_radiosity_options(OptionParser& parser, RadiosityOptions& o) {
  parser.group("Radiosity");
  parser.value("--solver", "NAME",
               "direct (dense LU, small scenes), jacobi, gauss-seidel, shooting (the brightest shoot first) or "
               "progressive (bounce by bounce) (default: gauss-seidel)",
               [&](const OptionValue& v) {
                 o.solver = choice<std::string>(v, choices_of(solver_names()));
                 o.given = true;
               });
  add_mesh_options(parser, o);
  add_contrast_option(parser, o);
  add_factor_options(parser, o);
  add_specular_option(parser, o);
  add_iteration_options(parser, o);
}

void check(const RadiosityOptions& o) {
  const auto only_for = [](bool given, std::string_view option, std::string_view choice_option,
                           const std::string& chosen, std::initializer_list<std::string_view> those) {
    if (!given || std::find(those.begin(), those.end(), chosen) != those.end()) return;
    throw UsageError(fmt::format("{} does not apply to {} {}; it belongs to {}", option, choice_option, chosen,
                                 fmt::join(those, ", ")));
  };
  const auto iterative = {std::string_view("jacobi"), std::string_view("gauss-seidel"), std::string_view("shooting"),
                          std::string_view("progressive")};
  only_for(o.tolerance.has_value(), "--tolerance", "--solver", o.solver, iterative);
  only_for(o.max_iterations.has_value(), "--max-iterations", "--solver", o.solver, iterative);
  only_for(o.stop_at.has_value(), "--stop-at", "--solver", o.solver, {"shooting", "progressive"});
  only_for(o.factor_tolerance.has_value(), "--factor-tolerance", "--form-factors", o.form_factors,
           {"auto", "adaptive", "ray-cast"});
  only_for(o.rays.has_value(), "--rays", "--form-factors", o.form_factors, {"ray-cast"});
  only_for(o.resolution.has_value(), "--resolution", "--form-factors", o.form_factors, {"hemicube"});
  if (o.rays && o.factor_tolerance) {
    throw UsageError("--rays fixes the work, --factor-tolerance lets it grow; give one of them");
  }
  if (o.subdivision == Subdivision::none && (o.element_size || o.elements)) {
    throw UsageError(fmt::format("{} does not apply to --subdivide none, which keeps the input polygons; leave it away",
                                 o.element_size ? "--element-size" : "--elements"));
  }
  if (o.contrast && o.subdivision != Subdivision::adaptive) {
    throw UsageError("--contrast belongs to --subdivide adaptive");
  }
  if (o.element_size && o.elements && o.subdivision != Subdivision::adaptive) {
    throw UsageError("--element-size and --elements both set the size of elements; give one of them");
  }
}

RadiositySetupOptions setup_options(const RadiosityOptions& o, bool front_sides_only, std::uint64_t seed) {
  RadiositySetupOptions setup;
  setup.subdivision = o.subdivision;
  setup.element_size = o.element_size.value_or(0);
  setup.element_count = o.elements.value_or(setup.element_count);
  setup.contrast = o.contrast.value_or(setup.contrast);
  setup.front_sides_only = front_sides_only;
  setup.form_factors = o.form_factors;
  if (!o.factor_tolerance) setup.most_crowding = most_crowding;
  setup.factors.tolerance = o.factor_tolerance.value_or(1e-3);
  setup.factors.rays = o.rays.value_or(0);
  setup.factors.resolution = o.resolution.value_or(0);
  setup.solver = o.solver;
  setup.specular_rays = o.specular_rays.value_or(setup.specular_rays);
  setup.factor_memory = share_of_memory * memory_left();
  setup.seed = seed;
  return setup;
}

SolverOptions solver_options(const RadiosityOptions& o) {
  SolverOptions solver;
  solver.tolerance = o.tolerance.value_or(solver.tolerance);
  if (o.tolerance) solver.most_unshot = std::numeric_limits<double>::infinity();  // it alone was asked for
  solver.stop_at = o.stop_at.value_or(solver.stop_at);
  solver.max_iterations = o.max_iterations.value_or(0);
  return solver;
}

}  // namespace penumbra::cli
