#include <fmt/core.h>

#include <cmath>
#include <optional>

#include "command.h"
#include "common_options.h"
#include "console.h"
#include "exit_code.h"
#include "heat_surfaces.h"
#include "interrupt.h"
#include "penumbra/file/output_file.h"
#include "penumbra/io/csv_table.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/form_factors/normalization.h"
#include "report.h"
#include "run_limits.h"
#include "usage_error.h"

namespace penumbra::cli {
namespace {

struct ExchangeArguments {
  std::string factors, surfaces, output;
  bool enclosure = false;
  double surroundings = 0;
  CommonOptions common;
};

std::optional<ExchangeArguments> parse(const std::vector<std::string>& arguments) {
  ExchangeArguments a;
  OptionParser parser("exchange", "FACTORS --surfaces CSV -o OUT.csv [options]",
                      "computes the exchange of heat by radiation between grey, diffuse surfaces");
  parser.positional("FACTORS",
                    "form factors: .npz, .mtx or .csv, as penumbra factors or scipy.sparse.save_npz writes them",
                    a.factors);
  parser.group("Exchange");
  parser.value("--surfaces", "CSV",
               "a line a surface: name,emissivity and temperature_K or heat_flux_W_m2, one of the two filled in; heat "
               "given to the enclosure is positive, 0 is an insulated surface; area_m2 where FACTORS says no areas",
               [&](const OptionValue& v) { a.surfaces = v.text; });
  parser.value("-o,--output", "OUT.csv",
               "temperature (K), radiosity, irradiance, net heat flux (W/m^2) and net heat (W) of each surface",
               [&](const OptionValue& v) { a.output = v.text; });
  parser.flag("--enclosure", "the surfaces are closed: make the rows sum to 1 (least squares, reciprocal)",
              a.enclosure);
  parser.value("--surroundings-temperature", "K",
               "temperature of the black surroundings that an open arrangement sees, K (default: 0)",
               [&](const OptionValue& v) {
                 a.surroundings = real_number(v, "a temperature of 0 K or more");
                 if (a.surroundings < 0) {
                   throw UsageError(v.option + " takes a temperature of 0 K or more, not '" + v.text + "'");
                 }
               });
  add_common_options(parser, a.common);
  parser.examples({"penumbra exchange furnace.npz --surfaces furnace.csv -o heat.csv",
                   "penumbra exchange room.npz --surfaces walls.csv --enclosure --json -o heat.csv"});
  if (!parser.parse(arguments)) return std::nullopt;
  if (a.factors.empty()) throw UsageError("no FACTORS given: penumbra exchange FACTORS --surfaces CSV -o OUT.csv");
  if (a.surfaces.empty()) throw UsageError("no surfaces given; add --surfaces CSV");
  if (a.output.empty()) throw UsageError("no file to write to; add -o OUT.csv");
  if (!a.output.ends_with(".csv") && a.output != "/dev/stdout") {
    throw UsageError(fmt::format("-o {}: the exchange is written as .csv; end the name in it", a.output));
  }
  check_report(a.common);
  check_creatable(a.output);
  return a;
}

std::string cell(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

void write_table(const std::string& path, const HeatModel& model, const HeatExchange& heat) {
  OutputFile out(path);
  if (heat.partial) out.write("# partial: the computation was stopped\n");
  out.write("name,area_m2,emissivity,temperature_K,radiosity_W_m2,irradiance_W_m2,heat_flux_W_m2,heat_W\n");
  for (std::size_t i = 0; i < model.surfaces.size(); ++i) {
    const HeatSurface& s = model.surfaces[i];
    out.write(fmt::format("{},{},{},{},{},{},{},{}\n", csv_word(s.name), model.factors.areas[i], s.emissivity,
                          cell(heat.temperature[i]), cell(heat.radiosity[i]), cell(heat.irradiance[i]),
                          cell(heat.heat_flux[i]), cell(heat.heat[i])));
  }
  out.commit();
}

Report report_on(const ExchangeArguments& a, const HeatModel& model, const HeatExchange& heat) {
  return {{"command", "exchange"},
          {"version", PENUMBRA_VERSION},
          {"output", a.output},
          {"surfaces", model.surfaces.size()},
          {"balance_W",
           {{"supplied", heat.supplied},
            {"removed", heat.removed},
            {"to_surroundings", heat.to_surroundings},
            {"imbalance", heat.imbalance}}},
          {"iterations", heat.iterations},
          {"residual", heat.residual},
          {"converged", heat.converged},
          {"threads", thread_count()},
          {"peak_rss_bytes", peak_memory()},
          {"partial", heat.partial}};
}

void warn_of_openings(const HeatModel& model, const ExchangeArguments& a, Console& console) {
  double largest = 0;
  std::size_t row = 0;
  for (std::size_t i = 0; i < model.factors.rows(); ++i) {
    const double miss = std::abs(1 - model.factors.row_sum(i));
    if (miss > largest) {
      largest = miss;
      row = i;
    }
  }
  if (model.factors.partial) console.warn(a.factors + ": partial factors; what is missing reads as 0");
  // Between the errors of factors and a true opening nothing can be told apart: say it.
  if (largest > 1e-9 && largest < 0.01) {
    console.warn(
        fmt::format("rows miss the sum 1 by up to {:.2g} (surface {}); if the surfaces are closed, add "
                    "--enclosure, or compute the factors to a smaller --tolerance",
                    largest, model.surfaces[row].name));
  }
}

}  // namespace

int run_exchange(const std::vector<std::string>& arguments) {
  const auto parsed = parse(arguments);
  if (!parsed) return exit_done;
  Console console(parsed->common);
  Interrupt interrupt;
  const RunLimits limits(parsed->common);
  HeatModel model = read_heat_model(parsed->factors, parsed->surfaces);
  if (parsed->enclosure) normalize_least_squares(model.factors);
  warn_of_openings(model, *parsed, console);

  HeatExchangeOptions options;
  options.surroundings_temperature = parsed->surroundings;
  options.progress = {[&](std::string_view stage, double done) { console.progress(stage, done); }, interrupt.token()};
  interrupt.something_to_keep();
  const HeatExchange heat = solve_heat_exchange(model.surfaces, model.factors, options);
  if (heat.partial) console.insist(parsed->output + ": partial, the computation was stopped");
  if (!heat.converged && !heat.partial) {
    console.warn(fmt::format("the system is not solved to its tolerance (residual {:.2g})", heat.residual));
  }
  write_table(parsed->output, model, heat);
  console.say(fmt::format(
      "{}: {} surfaces, {:.6g} W supplied, {:.6g} W removed, {:.6g} W to the surroundings, "
      "imbalance {:.2g} W",
      parsed->output, model.surfaces.size(), heat.supplied, heat.removed, heat.to_surroundings, heat.imbalance));
  write_report(parsed->common, report_on(*parsed, model, heat));
  return interrupt.requested() ? exit_interrupted : exit_done;
}

}  // namespace penumbra::cli
