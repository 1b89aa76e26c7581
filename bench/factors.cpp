// How long do the form factors of a room take, how much memory, and how exact are they?
//
// The scene: a closed unit cube that holds a box of half its size in its middle, each of the twelve walls subdivided
// n x n: N = 12 n^2 patches, the benchmark on which View3D's time grows as N^1.95. Every row must sum to 1; the mean
// and the largest sum over j of |error of F_ij| are taken against the same scene at a hundredth of the tolerance.

#include <fmt/core.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/form_factors/auto.h"
#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/form_factors/form_factor_method.h"
#include "penumbra/radiosity/patch_mesh.h"

namespace {

using namespace penumbra;
using Clock = std::chrono::steady_clock;

/// Appends the six walls of a cube, each as n x n squares (or twice as many triangles); `sign` +1: normals outwards.
void append_cube(PatchMesh& mesh, std::vector<std::vector<std::uint32_t>>& faces, double lower, double upper, int n,
                 int sign, bool triangles) {
  for (int axis = 0; axis < 3; ++axis) {
    for (int end = 0; end < 2; ++end) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (int v = 0; v <= n; ++v) {
        for (int u = 0; u <= n; ++u) {
          Vec3d p;
          p[axis] = end != 0 ? upper : lower;
          p[(axis + 1) % 3] = lower + (upper - lower) * u / n;
          p[(axis + 2) % 3] = lower + (upper - lower) * v / n;
          mesh.vertices.push_back(p);
        }
      }
      const bool keep = (end != 0) == (sign > 0);
      for (int v = 0; v < n; ++v) {
        for (int u = 0; u < n; ++u) {
          const auto at = [&](int du, int dv) {
            return first + static_cast<std::uint32_t>((v + dv) * (n + 1) + u + du);
          };
          std::array<std::uint32_t, 4> q{at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
          if (!keep) std::reverse(q.begin(), q.end());
          if (triangles) {
            faces.push_back({q[0], q[1], q[2]});
            faces.push_back({q[0], q[2], q[3]});
          } else {
            faces.push_back({q.begin(), q.end()});
          }
        }
      }
    }
  }
}

PatchMesh room_with_box(int n, bool triangles) {
  PatchMesh mesh;
  std::vector<std::vector<std::uint32_t>> faces;
  append_cube(mesh, faces, 0, 1, n, -1, triangles);
  append_cube(mesh, faces, 0.25, 0.75, n, +1, triangles);
  mesh.surfaces.resize(faces.size());
  for (std::uint32_t f = 0; f < faces.size(); ++f) add_patch(mesh, faces[f], f, f);
  return mesh;
}

struct CoreTime {
  double user = 0, system = 0;
};
CoreTime core_time() {
  rusage u{};
  getrusage(RUSAGE_SELF, &u);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return {seconds(u.ru_utime), seconds(u.ru_stime)};
}

/// What the process uses now, bytes.
double resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  double pages = 0, resident = 0;
  statm >> pages >> resident;
  return resident * 4096;
}

struct Measured {
  std::string method;
  std::string scene;
  int n = 0;
  std::size_t patches = 0;
  double seconds = 0, core_seconds = 0, bytes = 0;
  double nonzeros = 0;
  double row_sum_error_max = 0, row_sum_error_mean = 0;
  std::optional<double> row_error_max, row_error_mean;  // sum over j of |dF| against the tight reference
  double estimated_error_max = 0;
};

std::unique_ptr<FormFactorMethod> make_method(const std::string& name, const PatchMesh& mesh,
                                              const FormFactorOptions& options, bool merge) {
  if (name != "auto" || merge) return make_form_factor_method(name, mesh, options);
  AutoFormFactors::Settings settings;
  settings.merge_occluders = false;
  return std::make_unique<AutoFormFactors>(mesh, options, settings);
}

/// Sums rows while the blocks pass by: the matrix is never whole in memory.
Measured measure_streamed(const std::string& method, const PatchMesh& mesh, const FormFactorOptions& options) {
  Measured m;
  std::vector<double> sums(mesh.surface_count(), 0.0), errors(mesh.surface_count(), 0.0);
  const double before = resident_bytes();
  const auto start = Clock::now();
  const CoreTime cores = core_time();
  const auto factors = make_form_factor_method(method, mesh, options);
  double largest = 0;
  visit_factors(*factors, [&](const FactorBlock& block) {
    for (const PairFactor& p : block.pairs) {
      sums[p.i] += p.exchange / mesh.areas[p.i];
      sums[p.j] += p.exchange / mesh.areas[p.j];
      errors[p.i] += static_cast<double>(p.error) / mesh.areas[p.i];
      errors[p.j] += static_cast<double>(p.error) / mesh.areas[p.j];
    }
    for (const DroppedExchange& d : block.dropped) errors[d.patch] += d.exchange / mesh.areas[d.patch];
    m.nonzeros += 2 * static_cast<double>(block.pairs.size());
    largest = std::max(largest, resident_bytes());
  });
  m.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  const CoreTime end = core_time();
  m.core_seconds = end.user - cores.user + end.system - cores.system;
  m.bytes = largest - before;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    m.row_sum_error_max = std::max(m.row_sum_error_max, std::abs(sums[i] - 1));
    m.row_sum_error_mean += std::abs(sums[i] - 1) / static_cast<double>(sums.size());
    m.estimated_error_max = std::max(m.estimated_error_max, errors[i]);
  }
  return m;
}

/// The sum over j of |F_ij - reference_ij|.
double row_difference(const FactorMatrix& a, const FactorMatrix& b, std::size_t i) {
  const auto ca = a.row_columns(i), cb = b.row_columns(i);
  const auto va = a.row_values(i), vb = b.row_values(i);
  double sum = 0;
  std::size_t k = 0, l = 0;
  while (k < ca.size() || l < cb.size()) {
    if (l == cb.size() || (k < ca.size() && ca[k] < cb[l])) {
      sum += std::abs(va[k++]);
    } else if (k == ca.size() || cb[l] < ca[k]) {
      sum += std::abs(vb[l++]);
    } else {
      sum += std::abs(va[k++] - vb[l++]);
    }
  }
  return sum;
}

Measured measure(const std::string& method, const PatchMesh& mesh, const FormFactorOptions& options, bool merge,
                 const FactorMatrix* reference) {
  Measured m;
  const double before = resident_bytes();
  const auto start = Clock::now();
  const CoreTime cores = core_time();
  const auto factors = make_method(method, mesh, options, merge);
  const FactorMatrix f = assemble_factor_matrix(*factors, mesh);
  m.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  const CoreTime end = core_time();
  m.core_seconds = end.user - cores.user + end.system - cores.system;
  m.bytes = resident_bytes() - before;
  m.nonzeros = static_cast<double>(f.values.size());
  double l1_max = 0, l1_mean = 0;
  for (std::size_t i = 0; i < f.rows(); ++i) {
    const double off = std::abs(f.row_sum(i) - 1);
    m.row_sum_error_max = std::max(m.row_sum_error_max, off);
    m.row_sum_error_mean += off / static_cast<double>(f.rows());
    m.estimated_error_max = std::max(m.estimated_error_max, f.row_errors[i]);
    if (!reference) continue;
    const double l1 = row_difference(f, *reference, i);
    l1_max = std::max(l1_max, l1);
    l1_mean += l1 / static_cast<double>(f.rows());
  }
  if (reference) {
    m.row_error_max = l1_max;
    m.row_error_mean = l1_mean;
  }
  return m;
}

void print_header() {
  fmt::print("{:<10} {:<10} {:>3} {:>7} {:>9} {:>9} {:>8} {:>11} {:>10} {:>10} {:>10} {:>10}\n", "method", "scene", "n",
             "N", "seconds", "core s", "MB", "non-zeros", "max |sum-1|", "mean L1", "max L1", "estimated");
}

void print_row(const Measured& m) {
  const auto optional = [](const std::optional<double>& v) { return v ? fmt::format("{:.1e}", *v) : std::string("-"); };
  fmt::print("{:<10} {:<10} {:>3} {:>7} {:>9.3f} {:>9.3f} {:>8.0f} {:>11.0f} {:>10.1e} {:>10} {:>10} {:>10.1e}\n",
             m.method, m.scene, m.n, m.patches, m.seconds, m.core_seconds, m.bytes / 1e6, m.nonzeros,
             m.row_sum_error_max, optional(m.row_error_mean), optional(m.row_error_max), m.estimated_error_max);
  std::fflush(stdout);
}

nlohmann::json to_json(const Measured& m) {
  nlohmann::json j{{"method", m.method},
                   {"scene", m.scene},
                   {"n", m.n},
                   {"patches", m.patches},
                   {"seconds", m.seconds},
                   {"core_seconds", m.core_seconds},
                   {"bytes", m.bytes},
                   {"nonzeros", m.nonzeros},
                   {"row_sum_error_max", m.row_sum_error_max},
                   {"row_sum_error_mean", m.row_sum_error_mean},
                   {"estimated_error_max", m.estimated_error_max}};
  if (m.row_error_max) {
    j["row_error_max"] = *m.row_error_max;
    j["row_error_mean"] = *m.row_error_mean;
  }
  return j;
}

/// Slope of log(seconds) against log(N) by least squares.
double slope(const std::vector<Measured>& runs) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const Measured& m : runs) {
    const double x = std::log(static_cast<double>(m.patches)), y = std::log(m.seconds);
    n += 1;
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  return n > 1 ? (n * sxy - sx * sy) / (n * sxx - sx * sx) : 0;
}

struct Arguments {
  std::string json;
  bool quick = false;
  double tolerance = 1e-4;
  std::vector<int> sizes;
  std::vector<std::string> methods;
  bool reference = true;
};

std::vector<std::string> split_list(const std::string& text) {
  std::vector<std::string> out(1);
  for (char c : text) {
    if (c == ',') {
      out.emplace_back();
    } else {
      out.back() += c;
    }
  }
  return out;
}

Arguments parse(int count, char** values) {
  Arguments a;
  for (int k = 1; k < count; ++k) {
    const std::string key = values[k];
    const auto value = [&]() -> std::string {
      if (k + 1 >= count) throw std::invalid_argument(key + " needs a value");
      return values[++k];
    };
    if (key == "--json")
      a.json = value();
    else if (key == "--quick")
      a.quick = true;
    else if (key == "--tolerance")
      a.tolerance = std::stod(value());
    else if (key == "--no-reference")
      a.reference = false;
    else if (key == "--methods")
      a.methods = split_list(value());
    else if (key == "--sizes") {
      for (const std::string& s : split_list(value())) a.sizes.push_back(std::stoi(s));
    } else {
      throw std::invalid_argument(
          "unknown option " + key +
          "; known: --json FILE --quick --tolerance X --sizes n,n --methods a,b --no-reference");
    }
  }
  if (a.methods.empty())
    for (std::string_view name : form_factor_method_names()) a.methods.emplace_back(name);
  if (a.sizes.empty()) a.sizes = a.quick ? std::vector<int>{4, 8, 16} : std::vector<int>{4, 8, 12, 16, 24, 32, 48};
  return a;
}

/// The slow methods are only asked for what they can do in a reasonable time.
int largest_size(const std::string& method, bool quick) {
  if (method == "auto") return 1000;
  return quick ? 4 : 8;
}

constexpr int largest_in_memory = 32;  // beyond it rows are summed as the blocks pass by
constexpr int largest_reference = 24;

void run(const Arguments& arguments) {
  nlohmann::json out{{"bench", "factors"}, {"tolerance", arguments.tolerance}, {"threads", thread_count()}};
  print_header();
  std::vector<std::vector<Measured>> by_method(arguments.methods.size());
  for (int n : arguments.sizes) {
    const PatchMesh mesh = room_with_box(n, false);
    FormFactorOptions options;
    options.tolerance = arguments.tolerance;
    std::optional<FactorMatrix> reference;
    if (arguments.reference && n <= (arguments.quick ? 8 : largest_reference)) {
      FormFactorOptions tight = options;
      tight.tolerance = arguments.tolerance / 100;
      reference = assemble_factor_matrix(AutoFormFactors(mesh, tight), mesh);
    }
    for (std::size_t k = 0; k < arguments.methods.size(); ++k) {
      const std::string& method = arguments.methods[k];
      if (n > largest_size(method, arguments.quick)) continue;
      Measured m = n > largest_in_memory ? measure_streamed(method, mesh, options)
                                         : measure(method, mesh, options, true, reference ? &*reference : nullptr);
      m.method = method;
      m.scene = n > largest_in_memory ? "streamed" : "box";
      m.n = n;
      m.patches = mesh.patch_count();
      print_row(m);
      out["runs"].push_back(to_json(m));
      by_method[k].push_back(m);
    }
  }
  // The same room in triangles without shared corners, as STL has it; and with every patch hiding for itself, as if no
  // two lay in one plane.
  struct Loose {
    const char* scene;
    int n;
    bool merge;
  };
  std::vector<Loose> loose{{"triangles", 6, true}, {"unmerged", 3, false}};
  if (!arguments.quick) loose.push_back({"triangles", 17, true});
  for (const Loose& l : loose) {
    const PatchMesh mesh = room_with_box(l.n, true);
    FormFactorOptions options;
    options.tolerance = arguments.tolerance;
    Measured m = measure("auto", mesh, options, l.merge, nullptr);
    m.method = "auto";
    m.scene = l.scene;
    m.n = l.n;
    m.patches = mesh.patch_count();
    print_row(m);
    out["runs"].push_back(to_json(m));
  }
  for (std::size_t k = 0; k < arguments.methods.size(); ++k) {
    if (by_method[k].size() < 2) continue;
    const double s = slope(by_method[k]);
    fmt::print("{}: seconds grow as N^{:.2f}\n", arguments.methods[k], s);
    out["slope"][arguments.methods[k]] = s;
  }
  if (!arguments.json.empty()) {
    std::ofstream file(arguments.json);
    file << out.dump(2) << '\n';
    if (!file) throw std::runtime_error("cannot write " + arguments.json);
  }
}

}  // namespace

int main(int count, char** values) {
  try {
    run(parse(count, values));
  } catch (const std::exception& e) {
    fmt::print(stderr, "bench_factors: {}\n", e.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
