#include "factor_arguments.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "penumbra/radiosity/form_factors/contact_factors.h"
#include "penumbra/radiosity/form_factors/ray_cast.h"
#include "report.h"
#include "scene_options.h"
#include "usage_error.h"

namespace penumbra::cli {
namespace {

const std::vector<std::pair<std::string, double>> units{{"mm", 0.001}, {"cm", 0.01}, {"m", 1.0}, {"in", 0.0254}};
const std::vector<std::pair<std::string, SurfaceGrouping>> groupings{
    {"face", SurfaceGrouping::face}, {"object", SurfaceGrouping::object}, {"material", SurfaceGrouping::material}};
const std::vector<std::pair<std::string, PatchSides>> sides{{"front", PatchSides::front}, {"both", PatchSides::both}};
const std::vector<std::pair<std::string, NormalizationKind>> normalizations{
    {"none", NormalizationKind::none},
    {"rows", NormalizationKind::rows},
    {"least-squares", NormalizationKind::least_squares}};
const std::vector<std::pair<std::string, HemicubeVisibility>> hemicube_visibilities{
    {"z-buffer", HemicubeVisibility::z_buffer},
    {"bsp", HemicubeVisibility::bsp_tree},
    {"rays", HemicubeVisibility::rays}};
const std::vector<std::pair<std::string, AdaptiveVisibility>> adaptive_visibilities{
    {"clipping", AdaptiveVisibility::clipping}, {"bsp", AdaptiveVisibility::bsp_tree}};

std::vector<std::pair<std::string, std::string>> method_names() {
  std::vector<std::pair<std::string, std::string>> names;
  for (const std::string_view name : form_factor_method_names()) names.emplace_back(name, name);
  return names;
}

void add_geometry(OptionParser& parser, FactorArguments& a) {
  parser.positionals("MESH...",
                     "the surfaces: .glb, .gltf, .obj, .stl, .ply or View3D's .vs3, or builtin:NAME?key=value",
                     a.geometry.meshes);
  parser.group("Surfaces");
  parser.value("--unit", "mm|cm|m|in", "length of one unit of OBJ, STL, PLY and .vs3 files (default: m)",
               [&](const OptionValue& v) { a.geometry.unit = choice<double>(v, units); });
  add_allow_outside(parser, a.geometry.allow_outside);
  parser.value("--surfaces", "face|object|material",
               "what makes one row of the matrix (default: face; of a .vs3 always its own surfaces)",
               [&](const OptionValue& v) { a.geometry.grouping = choice<SurfaceGrouping>(v, groupings); });
  parser.value("--sides", "front|both",
               "which sides of a face radiate (default: front; a reversed coincident pair is a two-sided plate)",
               [&](const OptionValue& v) { a.geometry.sides = choice<PatchSides>(v, sides); });
  parser.group("Pair of meshes (prints the factor; no -o)");
  parser.value("--from", "MESH", "the mesh that radiates, as one surface",
               [&](const OptionValue& v) { a.geometry.from = v.text; });
  parser.value("--to", "MESH", "the mesh that receives, as one surface",
               [&](const OptionValue& v) { a.geometry.to = v.text; });
  parser.values("--blockers", "MESH...", "meshes that stand in between and only hide", a.geometry.blockers);
}

void add_method(OptionParser& parser, FactorArguments& a) {
  parser.group("Method");
  parser.value("--method", "NAME", "point, nusselt, hemicube, analytic, adaptive, ray-cast or auto (default: auto)",
               [&](const OptionValue& v) { a.method = choice<std::string>(v, method_names()); });
  parser.value(
      "--tolerance", "X",
      "for each row, the sum over j of |error of F_ij| is at most this (auto, adaptive; ray-cast at its 3 sigma) "
      "(default: 1e-4)",
      [&](const OptionValue& v) { a.tolerance = number_above_zero(v, "a number above 0, such as 1e-4"); });
  parser.value(
      "--rays", "N",
      "rays a patch (ray-cast), rounded up to 16 times a power of two (default: doubled until the tolerance is "
      "met, at most 65536)",
      [&](const OptionValue& v) { a.rays = static_cast<int>(whole_number(v, 16, 1 << 28, "rays a patch")); });
  parser.value("--resolution", "N", "pixels along the hemicube's top, even (hemicube) (default: 128)",
               [&](const OptionValue& v) {
                 a.resolution = static_cast<int>(whole_number(v, 2, 4096, "pixels"));
                 if (*a.resolution % 2 != 0)
                   throw UsageError("--resolution takes an even number, not '" + v.text + "'");
               });
  parser.value(
      "--hemicube-near", "X",
      "pairs nearer than X times their sizes take the exact factor times the visible share of their pixels; 0 is "
      "the plain hemicube (default: 5)",
      [&](const OptionValue& v) {
        a.hemicube_near = real_number(v, "a number of 0 or more");
        if (*a.hemicube_near < 0) throw UsageError("--hemicube-near takes 0 or more, not '" + v.text + "'");
      });
  parser.value(
      "--hemicube-visibility", "z-buffer|bsp|rays", "how pixels find what they see (default: z-buffer)",
      [&](const OptionValue& v) { a.hemicube_visibility = choice<HemicubeVisibility>(v, hemicube_visibilities); });
  parser.flag("--hemicube-rotate", "turn each hemicube by an angle of its own, against aliasing", a.hemicube_rotate);
  parser.value(
      "--adaptive-visibility", "clipping|bsp",
      "exact clipping along shadow lines, or halving in the order of a BSP tree (default: clipping)",
      [&](const OptionValue& v) { a.adaptive_visibility = choice<AdaptiveVisibility>(v, adaptive_visibilities); });
}

void add_output(OptionParser& parser, FactorArguments& a) {
  parser.group("Output");
  parser.value("-o,--output", "OUT",
               ".npz (scipy.sparse.load_npz), .mtx (Matrix Market), .csv, or .vtu (ParaView: area, row sum, one row)",
               [&](const OptionValue& v) { a.output = v.text; });
  parser.value("--normalize", "none|rows|least-squares",
               "make the rows of an enclosure sum to 1; what it changed is reported (default: none)",
               [&](const OptionValue& v) { a.normalization = choice<NormalizationKind>(v, normalizations); });
  parser.value("--row", "NAME|INDEX", "the row that a .vtu shows, by name or counted from 0 (default: 0)",
               [&](const OptionValue& v) { a.row = v.text; });
}

// An option that a method does not read would be ignored silently; better say so.
void refuse_what_does_not_apply(const FactorArguments& a) {
  const auto only_for = [&](bool given, std::string_view option, std::initializer_list<std::string_view> methods) {
    if (!given || std::find(methods.begin(), methods.end(), a.method) != methods.end()) return;
    throw UsageError(
        fmt::format("{} does not apply to --method {}; it belongs to {}", option, a.method, fmt::join(methods, ", ")));
  };
  only_for(a.tolerance.has_value(), "--tolerance", {"auto", "adaptive", "ray-cast"});
  only_for(a.rays.has_value(), "--rays", {"ray-cast"});
  only_for(a.resolution.has_value(), "--resolution", {"hemicube"});
  only_for(a.hemicube_near.has_value(), "--hemicube-near", {"hemicube"});
  only_for(a.hemicube_visibility.has_value(), "--hemicube-visibility", {"hemicube"});
  only_for(a.hemicube_rotate, "--hemicube-rotate", {"hemicube"});
  only_for(a.adaptive_visibility.has_value(), "--adaptive-visibility", {"adaptive"});
  if (a.rays && a.tolerance) throw UsageError("--rays fixes the work, --tolerance lets it grow; give one of them");
}

void check_matrix_form(const FactorArguments& a) {
  if (a.geometry.meshes.empty()) throw UsageError("no MESH given; name one or more, or --from A --to B");
  if (!a.geometry.blockers.empty()) throw UsageError("--blockers belongs to --from A --to B");
  if (a.output.empty()) throw UsageError("no file to write to; add -o OUT.npz");
  const std::string extension = std::filesystem::path(a.output).extension().string();
  const std::vector<std::string> known{".npz", ".mtx", ".csv", ".vtu"};
  if (std::find(known.begin(), known.end(), extension) == known.end()) {
    throw UsageError(
        fmt::format("-o {}: factors are written as {}; end the name in one of them", a.output, fmt::join(known, ", ")));
  }
  if (a.row && extension != ".vtu") throw UsageError("--row belongs to a .vtu output");
}

void check_pair_form(const FactorArguments& a) {
  if (a.geometry.from.empty() || a.geometry.to.empty()) throw UsageError("a pair needs both --from A and --to B");
  if (!a.geometry.meshes.empty()) {
    throw UsageError(fmt::format("'{}' stands beside --from and --to; name it with --blockers, or leave these away",
                                 a.geometry.meshes.front()));
  }
  if (!a.output.empty()) throw UsageError("--from and --to print one factor and write no file; leave -o away");
  if (a.geometry.grouping != SurfaceGrouping::face) throw UsageError("--surfaces does not apply to --from and --to");
  if (a.normalization != NormalizationKind::none) throw UsageError("--normalize does not apply to --from and --to");
  if (a.row) throw UsageError("--row does not apply to --from and --to");
}

}  // namespace

std::optional<FactorArguments> parse_factor_arguments(const std::vector<std::string>& arguments) {
  FactorArguments result;
  OptionParser parser("factors", "MESH... -o OUT [options] | --from A --to B [--blockers C...]",
                      "computes the form factors (view factors) of a mesh");
  add_geometry(parser, result);
  add_method(parser, result);
  add_output(parser, result);
  add_common_options(parser, result.common);
  parser.examples({"penumbra factors room.vs3 -o factors.npz --tolerance 1e-5",
                   "penumbra factors --from inner.stl --to outer.stl --blockers shield.stl --unit mm"});
  if (!parser.parse(arguments)) return std::nullopt;
  result.geometry.is_pair() ? check_pair_form(result) : check_matrix_form(result);
  refuse_what_does_not_apply(result);
  check_report(result.common);
  return result;
}

std::unique_ptr<FormFactorMethod> make_method(const FactorArguments& a, const PatchMesh& mesh) {
  if (a.method == "hemicube") {
    HemicubeOptions options;
    options.resolution = a.resolution.value_or(options.resolution);
    options.exact_within = a.hemicube_near.value_or(options.exact_within);
    options.visibility = a.hemicube_visibility.value_or(options.visibility);
    options.rotate = a.hemicube_rotate;
    options.seed = a.common.seed;
    return with_contacts(make_hemicube(mesh, options), mesh);
  }
  if (a.method == "adaptive") {
    AdaptiveOptions options;
    options.tolerance = a.used_tolerance();
    options.visibility = a.adaptive_visibility.value_or(options.visibility);
    options.between_surfaces_only = a.geometry.is_pair();
    return with_contacts(make_adaptive(mesh, options), mesh);
  }
  FormFactorOptions options;
  options.tolerance = a.used_tolerance();
  options.seed = a.common.seed;
  options.rays = a.rays.value_or(0);
  options.between_surfaces_only = a.geometry.is_pair();
  return make_form_factor_method(a.method, mesh, options);
}

}  // namespace penumbra::cli
