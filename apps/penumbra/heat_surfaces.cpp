#include "heat_surfaces.h"

#include <fmt/format.h>

#include <map>
#include <optional>
#include <utility>

#include "nearest_word.h"
#include "penumbra/file/file_error.h"
#include "penumbra/io/csv_table.h"

namespace penumbra::cli {
namespace {

/// The table of surfaces and where its columns stand.
struct SurfaceTable {
  CsvTable table;
  std::size_t name, emissivity;
  std::optional<std::size_t> temperature, heat_flux, area;

  explicit SurfaceTable(const std::string& path)
      : table(read_csv_table(path)),
        name(table.needed_column("name")),
        emissivity(table.needed_column("emissivity")),
        temperature(table.column("temperature_K")),
        heat_flux(table.column("heat_flux_W_m2")),
        area(table.column("area_m2")) {
    if (!temperature && !heat_flux) {
      throw FileError(path, "", "the headline should name a column temperature_K or heat_flux_W_m2, or both");
    }
  }

  [[nodiscard]] std::optional<double> value(const CsvTable::Row& row, std::optional<std::size_t> column) const {
    if (!column || row.words[*column].empty()) return std::nullopt;
    return table.number(row, *column);
  }

  [[nodiscard]] HeatSurface surface(const CsvTable::Row& row) const {
    HeatSurface s;
    s.name = row.words[name];
    s.emissivity = table.number(row, emissivity);
    s.temperature = value(row, temperature);
    s.heat_flux = value(row, heat_flux);
    if (!(s.emissivity >= 0 && s.emissivity <= 1)) table.fail(row, "emissivity should be from 0 to 1");
    if (s.temperature.has_value() == s.heat_flux.has_value()) {
      table.fail(row, "fill in temperature_K or heat_flux_W_m2, one of the two");
    }
    if (s.temperature && *s.temperature < 0) table.fail(row, "temperature_K should be 0 or more");
    return s;
  }
};

std::optional<std::map<std::string, std::size_t>> rows_by_name(const std::vector<std::string>& names) {
  std::map<std::string, std::size_t> rows;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty() || !rows.emplace(names[i], i).second) return std::nullopt;
  }
  if (rows.empty()) return std::nullopt;
  return rows;
}

// For each row of the matrix the line of the table.
std::vector<const CsvTable::Row*> match(const MatrixFile& matrix, const SurfaceTable& surfaces,
                                        const std::string& factors) {
  const CsvTable& table = surfaces.table;
  std::vector<const CsvTable::Row*> lines(matrix.rows(), nullptr);
  const auto rows = rows_by_name(matrix.names);
  if (!rows) {
    if (table.rows.size() != matrix.rows()) {
      throw FileError(table.path, "",
                      fmt::format("describes {} surfaces, but {} has {} rows; one line a row is needed",
                                  table.rows.size(), factors, matrix.rows()));
    }
    for (std::size_t i = 0; i < lines.size(); ++i) lines[i] = &table.rows[i];
    return lines;
  }
  for (const CsvTable::Row& line : table.rows) {
    const std::string& name = line.words[surfaces.name];
    const auto found = rows->find(name);
    if (found == rows->end()) {
      table.fail(line, fmt::format("{} has no surface {}{}", factors, name, did_you_mean(name, matrix.names)));
    }
    if (lines[found->second] != nullptr) table.fail(line, fmt::format("surface {} is described twice", name));
    lines[found->second] = &line;
  }
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i] == nullptr) {
      throw FileError(table.path, "", fmt::format("does not describe surface {} of {}", matrix.names[i], factors));
    }
  }
  return lines;
}

}  // namespace

HeatModel read_heat_model(const std::string& factors, const std::string& surfaces) {
  MatrixFile matrix = read_matrix(factors);
  const SurfaceTable table(surfaces);
  if (matrix.areas.empty() && !table.area) {
    throw FileError(factors, "", "says no areas; add a column area_m2 to " + surfaces);
  }
  HeatModel model;
  for (const CsvTable::Row* line : match(matrix, table, factors)) {
    model.surfaces.push_back(table.surface(*line));
    if (!matrix.areas.empty()) continue;
    model.factors.areas.push_back(table.table.number(*line, *table.area));
    if (!(model.factors.areas.back() > 0)) table.table.fail(*line, "area_m2 should be above 0");
  }
  if (!matrix.areas.empty()) model.factors.areas = std::move(matrix.areas);
  model.factors.offsets = std::move(matrix.offsets);
  model.factors.columns = std::move(matrix.columns);
  model.factors.values = std::move(matrix.values);
  model.factors.partial = matrix.partial;
  model.factors.row_errors.assign(model.factors.rows(), 0.0);
  model.factors.row_dropped.assign(model.factors.rows(), 0.0);
  return model;
}

}  // namespace penumbra::cli
