// How long does each radiosity solver take, how much memory, and how near does it come?
//
// Scenes: the Cornell box and the atrium, cut into about the given numbers of elements. The matrix solvers share the
// `auto` factors, whose time and memory stand in a line of their own; `shooting` is run on that matrix and, as it is
// meant, with rows computed for the shooters alone; `refining` is shooting that cuts elements as light arrives. Two
// errors, each an area-weighted root mean square over the
// area-weighted mean radiosity:
//   same mesh   against Gauss-Seidel to 1e-11 on the matrix of the same mesh: what solver and rows leave open;
//   faces       mean radiosities of the input faces against the finest matrix solution of the run: elements as well.
// Where the matrix would not fit, rows are all there is. A run is cut off after --limit seconds; `unshot` says how much
// of the light it had not sent by then. Factors are as exact as `penumbra bake` wants them (1e-3). The whole takes some
// 6 minutes on two cores, --quick under a minute.

#include <fmt/core.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "bench_arguments.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/direct_irradiance.h"
#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/form_factors/hemicube.h"
#include "penumbra/radiosity/meshing/uniform.h"
#include "penumbra/radiosity/pipeline/refining_shooting.h"
#include "penumbra/radiosity/solvers/direct.h"
#include "penumbra/radiosity/solvers/shooting.h"
#include "penumbra/radiosity/solvers/solver.h"
#include "penumbra/scene/builtin_scenes.h"

namespace {

using namespace penumbra;
using Clock = std::chrono::steady_clock;

/// A value of /proc/self/status in bytes.
double status_bytes(const std::string& key) {
  std::ifstream in("/proc/self/status");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(key)) return 1024 * std::stod(line.substr(key.size() + 1));
  }
  return 0;
}

/// Time and memory of a piece of work: what it takes at most beyond what was there before.
class Gauge {
 public:
  Gauge() {
    ::malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << 5;  // the peak starts anew
    before_ = status_bytes("VmRSS:");
    began_ = Clock::now();
  }
  [[nodiscard]] double seconds() const { return std::chrono::duration<double>(Clock::now() - began_).count(); }
  [[nodiscard]] double bytes() const { return std::max(0.0, status_bytes("VmHWM:") - before_); }

 private:
  double before_;
  Clock::time_point began_;
};

struct Measured {
  Measured(std::string by, std::string with) : solver(std::move(by)), factors(std::move(with)) {}

  std::string scene, solver, factors;
  std::size_t elements = 0;
  double seconds = 0, bytes = 0;
  std::size_t iterations = 0;
  double unshot = 0;
  bool cut_off = false;
  std::optional<double> same_mesh, faces;
};

/// The area-weighted RMS of a - b over the area-weighted mean of b.
double relative_rms(const std::vector<double>& areas, std::size_t bands, const std::vector<double>& a,
                    const std::vector<double>& b) {
  double square = 0, mean = 0, area = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    square += areas[k / bands] * (a[k] - b[k]) * (a[k] - b[k]);
    mean += areas[k / bands] * b[k];
    area += areas[k / bands];
  }
  return std::sqrt(square / area) / (mean / area);
}

/// Mean radiosities of the input faces' sides.
struct FaceMeans {
  std::vector<double> areas, radiosity;
};

FaceMeans face_means(const PatchMesh& mesh, const std::vector<double>& radiosity) {
  std::map<std::pair<std::uint32_t, bool>, std::vector<double>> sums;  // area, then power a band
  for (std::size_t i = 0; i < mesh.surface_count(); ++i) {
    std::vector<double>& sum = sums[{mesh.surfaces[i].face, mesh.surfaces[i].back}];
    sum.resize(1 + mesh.bands);
    sum[0] += mesh.surfaces[i].area;
    for (std::size_t b = 0; b < mesh.bands; ++b) sum[1 + b] += mesh.surfaces[i].area * radiosity[i * mesh.bands + b];
  }
  FaceMeans means;
  for (const auto& [side, sum] : sums) {
    means.areas.push_back(sum[0]);
    for (std::size_t b = 1; b < sum.size(); ++b) means.radiosity.push_back(sum[b] / sum[0]);
  }
  return means;
}

struct Arguments {
  std::string json;
  bool quick = false;
  double limit = 20;
  std::vector<std::size_t> sizes;
  std::size_t most_in_matrix = 20000;
};

/// A scene in elements, with the light of what is no element.
struct Case {
  std::string name;
  PatchMesh mesh;
  RadiosityProblem problem;

  Scene scene;

  Case(const std::string& source, std::size_t elements)
      : name(source.substr(0, source.find('?'))), scene(make_builtin_scene(source)) {
    MeshingOptions meshing;
    meshing.element_count = elements;
    mesh = make_uniform_elements(scene, meshing).mesh;
    problem = make_radiosity_problem(mesh);
    DirectIrradiance direct = direct_irradiance(scene, mesh);
    problem.irradiance = std::move(direct.irradiance);
    problem.light_power = std::move(direct.light_power);
  }
};

void print_header() {
  fmt::print("{:<12} {:>8}  {:<13} {:<9} {:>9} {:>9} {:>10} {:>9} {:>10} {:>10}\n", "scene", "elements", "solver",
             "factors", "seconds", "MB", "iterations", "unshot", "same mesh", "faces");
}

void print_row(const Measured& m) {
  const auto error = [](const std::optional<double>& e) { return e ? fmt::format("{:.2e}", *e) : std::string("-"); };
  fmt::print("{:<12} {:>8}  {:<13} {:<9} {:>9.2f} {:>9.1f} {:>10} {:>9.1e} {:>10} {:>10}{}\n", m.scene, m.elements,
             m.solver, m.factors, m.seconds, m.bytes / 1e6, m.iterations, m.unshot, error(m.same_mesh), error(m.faces),
             m.cut_off ? "  cut off" : "");
  std::fflush(stdout);
}

FormFactorOptions factor_options() {
  FormFactorOptions options;
  options.tolerance = 1e-3;
  return options;
}

/// All runs on one scene at one element count.
class Series {
 public:
  Series(const Case& scene, const Arguments& arguments, std::vector<Measured>& out)
      : case_(scene), arguments_(arguments), out_(out) {}

  /// Where the matrix fits. Returns the converged radiosity.
  std::vector<double> on_a_matrix() {
    const Gauge gauge;
    const auto method = make_form_factor_method("auto", case_.mesh, factor_options());
    const FactorMatrix factors = assemble_factor_matrix(*method, case_.mesh);
    Measured assembled("(factors)", "auto");
    assembled.seconds = gauge.seconds();
    assembled.bytes = gauge.bytes();
    note(assembled, case_.mesh.surface_count());
    SolverOptions exact;
    exact.tolerance = 1e-11;
    const std::vector<double> reference = solve_radiosity("gauss-seidel", case_.problem, factors, exact).radiosity;
    for (const std::string_view name : solver_names()) {
      if (name == "direct" && case_.mesh.surface_count() > (arguments_.quick ? 2000 : 6000)) continue;
      run(name, "auto", &reference,
          [&](const SolverOptions& options) { return solve_radiosity(name, case_.problem, factors, options); });
    }
    return reference;
  }

  void by_rows(const std::vector<double>* reference) {
    // A pixel should not be much larger than an element is seen.
    HemicubeOptions hemicube;
    const double n = static_cast<double>(case_.mesh.surface_count());
    hemicube.exact_within = 1.5;  // the exact factor for what nearly touches only: each costs as much as many pixels
    hemicube.resolution = 2 * std::clamp(static_cast<int>(std::sqrt(n)), 64, 256);
    const auto method = make_hemicube(case_.mesh, hemicube);
    run("shooting", "hemicube", reference, [&](const SolverOptions& options) {
      const MethodRows rows(*method, case_.mesh);
      return solve_shooting(case_.problem, KeptRows(rows), options);
    });
  }

  /// On a mesh of its own, so that there is no same mesh to compare with.
  void refining(std::size_t elements) {
    RefiningShootingOptions options;
    options.element_count = elements;
    options.factors = factor_options();
    const Gauge gauge;
    RefiningShooting shooting(case_.scene, options);
    solve(gauge, "shooting", "refining", nullptr, shooting.mesh(),
          [&](const SolverOptions& o) { return shooting.solve(o); });
  }

 private:
  template <class Solve>
  void run(std::string_view solver, const std::string& factors, const std::vector<double>* reference,
           const Solve& solve_case) {
    solve(Gauge(), solver, factors, reference, case_.mesh, solve_case);
  }

  template <class Solve>
  void solve(const Gauge& gauge, std::string_view solver, const std::string& factors,
             const std::vector<double>* reference, const PatchMesh& mesh, const Solve& solve_it) {
    std::stop_source stop;
    SolverOptions options;
    options.progress.stop = stop.get_token();
    options.on_stage = [&](const SolverStage&) {
      if (gauge.seconds() > arguments_.limit) stop.request_stop();
    };
    const RadiositySolution solution = solve_it(options);
    Measured m(std::string(solver), factors);
    m.seconds = gauge.seconds();
    m.bytes = gauge.bytes();
    m.iterations = solution.iterations;
    m.unshot = std::abs(solution.unshot_fraction);
    m.cut_off = solution.partial;
    if (reference != nullptr) {
      m.same_mesh = relative_rms(case_.problem.areas, case_.problem.bands, solution.radiosity, *reference);
    }
    means_.push_back(face_means(mesh, solution.radiosity));
    note(m, mesh.surface_count());
  }

  void note(Measured m, std::size_t elements) {
    m.scene = case_.name;
    m.elements = elements;
    out_.push_back(m);
  }

  const Case& case_;
  const Arguments& arguments_;
  std::vector<Measured>& out_;

 public:
  std::vector<FaceMeans> means_;
};

void run_scene(const std::string& source, const Arguments& arguments, std::vector<Measured>& all) {
  std::vector<Measured> rows;
  std::vector<FaceMeans> means;
  std::optional<FaceMeans> finest;
  for (const std::size_t size : arguments.sizes) {
    const Case scene(source, size);
    Series series(scene, arguments, rows);
    std::vector<double> reference;
    if (scene.mesh.surface_count() <= arguments.most_in_matrix) {
      reference = series.on_a_matrix();
      finest = face_means(scene.mesh, reference);
    }
    series.by_rows(reference.empty() ? nullptr : &reference);
    series.refining(size);
    means.insert(means.end(), series.means_.begin(), series.means_.end());
  }
  std::size_t next = 0;
  for (Measured& m : rows) {
    if (m.solver == "(factors)") continue;
    const FaceMeans& found = means[next++];
    if (finest) m.faces = relative_rms(finest->areas, 3, found.radiosity, finest->radiosity);
  }
  for (const Measured& m : rows) print_row(m);
  all.insert(all.end(), rows.begin(), rows.end());
}

nlohmann::json to_json(const Measured& m) {
  nlohmann::json j{{"scene", m.scene},     {"elements", m.elements},     {"solver", m.solver},
                   {"factors", m.factors}, {"seconds", m.seconds},       {"bytes", m.bytes},
                   {"unshot", m.unshot},   {"iterations", m.iterations}, {"cut_off", m.cut_off}};
  if (m.same_mesh) j["rms_same_mesh"] = *m.same_mesh;
  if (m.faces) j["rms_faces"] = *m.faces;
  return j;
}

Arguments parse(int count, char** values) {
  Arguments a;
  bench::BenchArguments command_line;
  command_line.add("--limit", "SECONDS", [&](const std::string& v) { a.limit = std::stod(v); });
  command_line.add("--size", "N", [&](const std::string& v) { a.sizes.push_back(std::stoul(v)); });
  command_line.parse(count, values);
  a.json = command_line.json;
  a.quick = command_line.quick;
  if (a.quick) a.limit = std::min(a.limit, 5.0);
  if (a.sizes.empty()) {
    a.sizes = a.quick ? std::vector<std::size_t>{500, 1500} : std::vector<std::size_t>{1000, 10000, 100000};
  }
  return a;
}

}  // namespace

int main(int count, char** values) try {
  const Arguments arguments = parse(count, values);
  std::vector<Measured> all;
  print_header();
  for (const char* source : {"cornell-box", "atrium?triangles=400"}) run_scene(source, arguments, all);
  if (!arguments.json.empty()) {
    nlohmann::json rows = nlohmann::json::array();
    for (const Measured& m : all) rows.push_back(to_json(m));
    std::ofstream(arguments.json)
        << nlohmann::json{{"benchmark", "radiosity"}, {"threads", thread_count()}, {"runs", rows}}.dump(1) << "\n";
  }
  return 0;
} catch (const std::exception& e) {
  fmt::print(stderr, "bench_radiosity: {}\n", e.what());
  return 2;
}
