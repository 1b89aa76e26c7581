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
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench_arguments.h"
#include "penumbra/math/rng.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/form_factors/auto.h"
#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/form_factors/form_factor_method.h"
#include "penumbra/radiosity/patch_mesh.h"

namespace {

using namespace penumbra;
using Clock = std::chrono::steady_clock;

/// How a wall is cut up.
enum class Pieces {
  squares,
  triangles,
  uneven,  ///< triangles whose corners inside the walls are moved a little, so that no two lie in one plane
};

/// The walls of cubes, corners shared.
class CubeMesh {
 public:
  explicit CubeMesh(Pieces pieces) : pieces_(pieces) {}

  /// Six walls, each as n x n squares or twice as many triangles; `sign` +1: normals outwards.
  void append_cube(double lower, double upper, int n, int sign) {
    for (int axis = 0; axis < 3; ++axis)
      for (int end = 0; end < 2; ++end)
        for (int v = 0; v < n; ++v)
          for (int u = 0; u < n; ++u) {
            const auto at = [&](int du, int dv) {
              std::array<int, 3> place{};
              place[static_cast<std::size_t>(axis)] = end != 0 ? n : 0;
              place[static_cast<std::size_t>((axis + 1) % 3)] = u + du;
              place[static_cast<std::size_t>((axis + 2) % 3)] = v + dv;
              return vertex(lower, upper, n, sign, place);
            };
            std::array<std::uint32_t, 4> q{at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
            if ((end != 0) != (sign > 0)) std::reverse(q.begin(), q.end());
            if (pieces_ == Pieces::squares) {
              faces_.push_back({q.begin(), q.end()});
            } else {
              faces_.push_back({q[0], q[1], q[2]});
              faces_.push_back({q[0], q[2], q[3]});
            }
          }
  }

  PatchMesh finish() {
    mesh_.surfaces.resize(faces_.size());
    for (std::uint32_t f = 0; f < faces_.size(); ++f) add_patch(mesh_, faces_[f], f, f);
    return std::move(mesh_);
  }

 private:
  std::uint32_t vertex(double lower, double upper, int n, int sign, const std::array<int, 3>& place) {
    const auto [at, fresh] = vertices_.emplace(std::pair{sign, place}, mesh_.vertices.size());
    if (!fresh) return at->second;
    Vec3d p;
    int inside = 0, wall = 0;
    for (int a = 0; a < 3; ++a) {
      const int k = place[static_cast<std::size_t>(a)];
      p[a] = lower + (upper - lower) * k / n;
      if (k > 0 && k < n)
        ++inside;
      else
        wall = a;
    }
    if (pieces_ == Pieces::uneven && inside == 2)
      p[wall] += 0.2 * (upper - lower) / n * (0.5 - CounterRng(at->second).next());
    mesh_.vertices.push_back(p);
    return at->second;
  }

  Pieces pieces_;
  PatchMesh mesh_;
  std::vector<std::vector<std::uint32_t>> faces_;
  std::map<std::pair<int, std::array<int, 3>>, std::uint32_t> vertices_;
};

PatchMesh room_with_box(int n, Pieces pieces) {
  CubeMesh cubes(pieces);
  cubes.append_cube(0, 1, n, -1);
  cubes.append_cube(0.25, 0.75, n, +1);
  return cubes.finish();
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
  std::vector<int> loose_sizes;
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
  bench::BenchArguments command_line;
  command_line.add("--tolerance", "X", [&](const std::string& v) { a.tolerance = std::stod(v); });
  command_line.add("--sizes", "n,n", [&](const std::string& v) {
    for (const std::string& size : split_list(v)) a.sizes.push_back(std::stoi(size));
  });
  command_line.add("--loose-sizes", "n,n", [&](const std::string& v) {
    for (const std::string& size : split_list(v)) a.loose_sizes.push_back(std::stoi(size));
  });
  command_line.add("--methods", "a,b", [&](const std::string& v) { a.methods = split_list(v); });
  command_line.add_flag("--no-reference", [&] { a.reference = false; });
  command_line.parse(count, values);
  a.json = command_line.json;
  a.quick = command_line.quick;
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
constexpr int largest_uneven = 6;  // by itself; --loose-sizes asks for more

void run(const Arguments& arguments) {
  nlohmann::json out{{"bench", "factors"}, {"tolerance", arguments.tolerance}, {"threads", thread_count()}};
  print_header();
  std::vector<std::vector<Measured>> by_method(arguments.methods.size());
  for (int n : arguments.sizes) {
    const PatchMesh mesh = room_with_box(n, Pieces::squares);
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
      if (n > largest_size(method, arguments.quick)) {
        out["skipped"].push_back(
            {{"method", method}, {"scene", "box"}, {"n", n}, {"reason", "slow: minutes and more"}});
        continue;
      }
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
  // The same room in triangles; with every triangle hiding for itself; and with walls so uneven that no two triangles
  // lie in one plane.
  struct Loose {
    const char* scene;
    Pieces pieces;
    bool merge;
  };
  const std::vector<int> loose_sizes = arguments.quick ? std::vector<int>{6} : std::vector<int>{6, 17};
  for (const Loose& l : {Loose{"triangles", Pieces::triangles, true}, Loose{"unmerged", Pieces::triangles, false},
                         Loose{"uneven", Pieces::uneven, true}}) {
    for (int n : arguments.loose_sizes.empty() ? loose_sizes : arguments.loose_sizes) {
      if (l.pieces == Pieces::uneven && arguments.loose_sizes.empty() && n > largest_uneven) {
        out["skipped"].push_back({{"method", "auto"},
                                  {"scene", l.scene},
                                  {"n", n},
                                  {"reason", "nearly all pairs are partly hidden: an hour and more"}});
        continue;
      }
      const PatchMesh mesh = room_with_box(n, l.pieces);
      FormFactorOptions options;
      options.tolerance = arguments.tolerance;
      Measured m = measure("auto", mesh, options, l.merge, nullptr);
      m.method = "auto";
      m.scene = l.scene;
      m.n = n;
      m.patches = mesh.patch_count();
      print_row(m);
      out["runs"].push_back(to_json(m));
    }
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
