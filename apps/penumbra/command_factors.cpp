#include <fmt/core.h>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>

#include "command.h"
#include "console.h"
#include "exit_code.h"
#include "factor_arguments.h"
#include "interrupt.h"
#include "memory_limit.h"
#include "penumbra/file/output_file.h"
#include "penumbra/io/matrix_writer.h"
#include "penumbra/io/triplet_spill.h"
#include "penumbra/io/vtk_writer.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/form_factors/normalization.h"
#include "report.h"
#include "run_limits.h"
#include "standard_output.h"

namespace penumbra::cli {
namespace {

struct Seconds {
  double load = 0, factors = 0, write = 0;
};

/// What a run found out about its matrix, whichever way that was assembled.
struct FactorSummary {
  std::uint64_t nonzeros = 0;
  std::vector<double> row_sums;
  double reciprocity_error = 0;  ///< largest |A_i F_ij - A_j F_ji| / A_i
  double dropped = 0;            ///< largest sum of a row's factors left out
  double estimated_error = 0;    ///< largest of a row's sums of |error|
  bool partial = false;
  std::optional<Normalization> normalization;
  std::vector<double> shown_row;  ///< for the .vtu
};

/// Takes the rows one by one: sums, the chosen row, the file.
class RowSink {
 public:
  RowSink(FactorSummary& summary, MatrixWriter* writer, std::optional<std::size_t> shown, std::size_t rows)
      : summary_(summary), writer_(writer), shown_(shown) {
    if (shown) summary.shown_row.assign(rows, 0.0);
  }

  void take(std::size_t row, std::span<const std::uint32_t> columns, std::span<const double> values) {
    double sum = 0;
    for (const double f : values) sum += f;
    summary_.row_sums.push_back(sum);
    summary_.nonzeros += values.size();
    if (shown_ && *shown_ == row) {
      for (std::size_t k = 0; k < columns.size(); ++k) summary_.shown_row[columns[k]] = values[k];
    }
    if (writer_ != nullptr) writer_->add_row(columns, values);
  }

 private:
  FactorSummary& summary_;
  MatrixWriter* writer_;
  std::optional<std::size_t> shown_;
};

// What the matrix may take of what is left, the rest is for the method that fills it.
double matrix_memory(const CommonOptions& options) {
  constexpr double share = 0.7;
  return share * std::min(options.max_memory.value_or(memory_left()), memory_left());
}

// Even a full matrix fits: 24 bytes an entry while it is assembled, and the sorting's room.
bool fits_in_memory(std::size_t rows, double bytes) {
  const double n = static_cast<double>(rows);
  return 40 * n * n + 200 * n < bytes;
}

double reciprocity_error(const FactorMatrix& m) {
  double worst = 0;
  for (std::size_t i = 0; i < m.rows(); ++i) {
    const auto columns = m.row_columns(i);
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const double there = m.row_values(i)[k] * m.areas[i], back = m.at(columns[k], i) * m.areas[columns[k]];
      worst = std::max(worst, std::abs(there - back) / m.areas[i]);
    }
  }
  return worst;
}

void assemble_in_memory(const FormFactorMethod& method, const PatchMesh& mesh, const FactorArguments& arguments,
                        const Progress& progress, FactorSummary& summary, RowSink& sink) {
  FactorMatrix m = assemble_factor_matrix(method, mesh, progress);
  if (arguments.normalization == NormalizationKind::rows) summary.normalization = normalize_rows(m);
  if (arguments.normalization == NormalizationKind::least_squares) summary.normalization = normalize_least_squares(m);
  summary.partial = m.partial;
  summary.reciprocity_error = reciprocity_error(m);
  for (std::size_t i = 0; i < m.rows(); ++i) {
    summary.dropped = std::max(summary.dropped, m.row_dropped[i]);
    summary.estimated_error = std::max(summary.estimated_error, m.row_errors[i]);
    sink.take(i, m.row_columns(i), m.row_values(i));
  }
}

void normalize_row(std::vector<double>& factors, Normalization& report) {
  double sum = 0;
  for (const double f : factors) sum += f;
  if (!(sum > 0)) return;
  report.largest_defect = std::max(report.largest_defect, std::abs(sum - 1));
  report.largest_row_change = std::max(report.largest_row_change, std::abs(sum - 1));
  for (double& f : factors) {
    report.largest_change = std::max(report.largest_change, std::abs(f / sum - f));
    f /= sum;
  }
}

// Exchanges wait in memory or on disk until their row is written.
void assemble_on_disk(const FormFactorMethod& method, const PatchMesh& mesh, const FactorArguments& arguments,
                      double memory, const Progress& progress, FactorSummary& summary, RowSink& sink) {
  if (arguments.normalization == NormalizationKind::least_squares) {
    throw UsageError("--normalize least-squares needs the whole matrix in memory; raise --max-memory or use rows");
  }
  const std::size_t rows = mesh.surface_count();
  TripletSpill spill(arguments.output, rows, static_cast<std::size_t>(0.8 * memory));
  std::vector<double> errors(rows, 0.0), dropped(rows, 0.0);
  summary.partial = !visit_factors(
      method,
      [&](const FactorBlock& block) {
        for (const PairFactor& p : block.pairs) {
          const std::uint32_t s = mesh.surface_of[p.i], t = mesh.surface_of[p.j];
          spill.add({s, t, p.exchange});
          spill.add({t, s, p.exchange});
          errors[s] += static_cast<double>(p.error);
          errors[t] += static_cast<double>(p.error);
        }
        for (const DroppedExchange& d : block.dropped) dropped[mesh.surface_of[d.patch]] += d.exchange;
      },
      progress);
  for (std::size_t i = 0; i < rows; ++i) {
    const double area = mesh.surfaces[i].area;
    summary.dropped = std::max(summary.dropped, dropped[i] / area);
    summary.estimated_error = std::max(summary.estimated_error, (errors[i] + dropped[i]) / area);
  }
  Normalization normalization;
  std::vector<double> factors;
  spill.for_each_row([&](std::size_t row, std::span<const std::uint32_t> columns, std::span<const double> exchanges) {
    factors.assign(exchanges.begin(), exchanges.end());
    for (std::size_t k = 0; k < factors.size(); ++k) {
      factors[k] /= mesh.surfaces[row].area;
      // The two directions are one number divided by two areas: what rounding leaves.
      summary.reciprocity_error =
          std::max(summary.reciprocity_error,
                   std::abs(factors[k] * mesh.surfaces[row].area - exchanges[k]) / mesh.surfaces[row].area);
    }
    if (arguments.normalization == NormalizationKind::rows) normalize_row(factors, normalization);
    sink.take(row, columns, factors);
  });
  if (arguments.normalization == NormalizationKind::rows) {
    summary.normalization = normalization;
    summary.reciprocity_error = std::max(summary.reciprocity_error, 2 * normalization.largest_change);
  }
}

std::size_t row_named(const std::string& wanted, const PatchMesh& mesh) {
  for (std::size_t s = 0; s < mesh.surface_count(); ++s) {
    if (mesh.surfaces[s].name == wanted) return s;
  }
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
  if (error == std::errc{} && end == wanted.data() + wanted.size() && index < mesh.surface_count()) return index;
  throw UsageError(
      fmt::format("--row {}: no surface has this name, and it is no index below {}", wanted, mesh.surface_count()));
}

void write_cells(const std::string& path, const PatchMesh& mesh, const FactorSummary& summary, std::size_t shown) {
  PolygonCells cells;
  cells.points = mesh.vertices;
  CellValues area{"area", {}}, sum{"row sum", {}}, row{"factor from " + mesh.surfaces[shown].name, {}},
      index{"row", {}};
  for (std::size_t p = 0; p < mesh.radiating_count; ++p) {
    const auto corners = mesh.patch_corners(p);
    cells.corners.insert(cells.corners.end(), corners.begin(), corners.end());
    cells.offsets.push_back(cells.corners.size());
    const std::uint32_t s = mesh.surface_of[p];
    area.values.push_back(mesh.surfaces[s].area);
    sum.values.push_back(summary.row_sums[s]);
    row.values.push_back(summary.shown_row[s]);
    index.values.push_back(s);
  }
  cells.values = {area, sum, row, index};
  write_vtu(path, cells);
}

Report report_on(const FactorArguments& arguments, const FactorSummary& summary, const Seconds& seconds,
                 const std::vector<std::string>& warnings) {
  double least = std::numeric_limits<double>::infinity(), most = 0, sum = 0;
  for (const double s : summary.row_sums) {
    least = std::min(least, s);
    most = std::max(most, s);
    sum += s;
  }
  const double rows = std::max(1.0, static_cast<double>(summary.row_sums.size()));
  Report report{{"command", "factors"},
                {"version", PENUMBRA_VERSION},
                {"output", arguments.output},
                {"method", arguments.method},
                {"seed", arguments.common.seed},
                {"surfaces", summary.row_sums.size()},
                {"nonzeros", summary.nonzeros},
                {"row_sum", {{"min", summary.row_sums.empty() ? 0.0 : least}, {"max", most}, {"mean", sum / rows}}},
                {"dropped_sum_max", summary.dropped},
                {"reciprocity_error_max", summary.reciprocity_error},
                {"estimated_error_max", summary.estimated_error},
                {"seconds", {{"load", seconds.load}, {"factors", seconds.factors}, {"write", seconds.write}}},
                {"threads", thread_count()},
                {"peak_rss_bytes", peak_memory()},
                {"partial", summary.partial},
                {"warnings", warnings}};
  if (summary.normalization) {
    report["normalization"] = {{"largest_change", summary.normalization->largest_change},
                               {"largest_row_change", summary.normalization->largest_row_change},
                               {"largest_defect_before", summary.normalization->largest_defect}};
  }
  return report;
}

bool keeps_a_tolerance(const std::string& method) {
  return method == "auto" || method == "adaptive" || method == "ray-cast";
}

void say_result(const FactorArguments& arguments, const FactorSummary& summary, const Report& report,
                Console& console) {
  if (summary.partial) {
    console.insist(arguments.output + ": partial matrix, the computation was stopped; missing factors read as 0");
  }
  if (!summary.partial && !arguments.rays && keeps_a_tolerance(arguments.method) &&
      summary.estimated_error > 1.0001 * arguments.used_tolerance()) {
    console.warn(fmt::format("the estimated error of a row reaches {:.2g}, above the tolerance {:.2g}",
                             summary.estimated_error, arguments.used_tolerance()));
  }
  if (summary.normalization && summary.normalization->largest_defect > 0.05) {
    console.warn(fmt::format("rows missed 1 by up to {:.3g} before normalising: is it an enclosure, seen from inside?",
                             summary.normalization->largest_defect));
  }
  console.say(fmt::format(
      "{}: {} surfaces, {} factors ({}), row sums {:.6f} to {:.6f}, estimated error {:.2g}, {:.2f} s", arguments.output,
      summary.row_sums.size(), summary.nonzeros, arguments.method, report["row_sum"]["min"].get<double>(),
      report["row_sum"]["max"].get<double>(), summary.estimated_error, report["seconds"]["factors"].get<double>()));
}

PatchMesh load(const FactorArguments& arguments, Console& console, std::vector<std::string>& warnings,
               Seconds& seconds) {
  const Stopwatch watch;
  console.progress("load", 0);
  PatchMesh mesh = load_factor_geometry(arguments.geometry, warnings);
  console.warn(warnings);
  seconds.load = watch.seconds();
  return mesh;
}

int write_matrix(const FactorArguments& arguments) {
  check_creatable(arguments.output);
  Console console(arguments.common);
  Interrupt interrupt;
  const RunLimits limits(arguments.common);
  Seconds seconds;
  std::vector<std::string> warnings;
  const PatchMesh mesh = load(arguments, console, warnings, seconds);

  const Stopwatch factor_watch;
  const Progress progress{[&](std::string_view stage, double fraction) { console.progress(stage, fraction); },
                          interrupt.token()};
  const auto method = make_method(arguments, mesh);
  interrupt.something_to_keep();
  const bool shows = std::filesystem::path(arguments.output).extension() == ".vtu";
  const std::optional<std::size_t> shown =
      shows ? std::optional(row_named(arguments.row.value_or("0"), mesh)) : std::nullopt;
  const auto writer = shows ? nullptr : make_matrix_writer(arguments.output);
  FactorSummary summary;
  RowSink sink(summary, writer.get(), shown, mesh.surface_count());
  const double memory = matrix_memory(arguments.common);
  if (fits_in_memory(mesh.surface_count(), memory)) {
    assemble_in_memory(*method, mesh, arguments, progress, summary, sink);
  } else {
    assemble_on_disk(*method, mesh, arguments, memory, progress, summary, sink);
  }
  seconds.factors = factor_watch.seconds();

  const Stopwatch write_watch;
  console.progress("write", 0);
  if (writer) {
    MatrixDescription description;
    for (const PatchSurface& s : mesh.surfaces) {
      description.areas.push_back(s.area);
      description.names.push_back(s.name);
    }
    description.partial = summary.partial;
    writer->finish(description);
  } else {
    write_cells(arguments.output, mesh, summary, *shown);
  }
  seconds.write = write_watch.seconds();

  const Report report = report_on(arguments, summary, seconds, warnings);
  say_result(arguments, summary, report, console);
  write_report(arguments.common, report);
  return interrupt.requested() ? exit_interrupted : exit_done;
}

/// F from one mesh to the other, summed over their patches.
struct PairFactors {
  double exchange = 0, error = 0;
  bool partial = false;
};

PairFactors pair_factors(const FormFactorMethod& method, const PatchMesh& mesh, const Progress& progress) {
  PairFactors result;
  result.partial = !visit_factors(
      method,
      [&](const FactorBlock& block) {
        for (const PairFactor& p : block.pairs) {
          if (mesh.surface_of[p.i] == mesh.surface_of[p.j]) continue;
          result.exchange += p.exchange;
          result.error += static_cast<double>(p.error);
        }
        // What was dropped may have been between the two: count the radiating mesh's share as error.
        for (const DroppedExchange& d : block.dropped) {
          if (mesh.surface_of[d.patch] == 0) result.error += d.exchange;
        }
      },
      progress);
  return result;
}

int print_pair(const FactorArguments& arguments) {
  Console console(arguments.common);
  Interrupt interrupt;
  const RunLimits limits(arguments.common);
  Seconds seconds;
  std::vector<std::string> warnings;
  const PatchMesh mesh = load(arguments, console, warnings, seconds);
  if (mesh.surface_count() != 2)
    throw UsageError("each of --from and --to should hold at least one face that radiates");

  const Stopwatch watch;
  const Progress progress{[&](std::string_view stage, double fraction) { console.progress(stage, fraction); },
                          interrupt.token()};
  const auto method = make_method(arguments, mesh);
  const PairFactors pair = pair_factors(*method, mesh, progress);
  seconds.factors = watch.seconds();
  const double a = mesh.surfaces[0].area, b = mesh.surfaces[1].area;
  write_report(arguments.common, {{"command", "factors"},
                                  {"version", PENUMBRA_VERSION},
                                  {"from", arguments.geometry.from},
                                  {"to", arguments.geometry.to},
                                  {"blockers", arguments.geometry.blockers},
                                  {"method", arguments.method},
                                  {"factor", pair.exchange / a},
                                  {"estimated_error", pair.error / a},
                                  {"factor_back", pair.exchange / b},
                                  {"estimated_error_back", pair.error / b},
                                  {"area_from", a},
                                  {"area_to", b},
                                  {"patches", mesh.patch_count()},
                                  {"seconds", {{"load", seconds.load}, {"factors", seconds.factors}, {"write", 0.0}}},
                                  {"peak_rss_bytes", peak_memory()},
                                  {"partial", pair.partial},
                                  {"warnings", warnings}});
  if (!arguments.common.json) {
    write_standard_output(fmt::format("F({} to {}) = {:.12g}, estimated error {:.2g}\n", mesh.surfaces[0].name,
                                      mesh.surfaces[1].name, pair.exchange / a, pair.error / a));
  }
  if (pair.partial) console.insist("partial: the computation was stopped, the factor is too small");
  return interrupt.requested() ? exit_interrupted : exit_done;
}

}  // namespace

int run_factors(const std::vector<std::string>& arguments) {
  const auto parsed = parse_factor_arguments(arguments);
  if (!parsed) return exit_done;
  return parsed->geometry.is_pair() ? print_pair(*parsed) : write_matrix(*parsed);
}

}  // namespace penumbra::cli
