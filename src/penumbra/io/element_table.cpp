#include "penumbra/io/element_table.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <string_view>

#include "penumbra/file/file_error.h"
#include "penumbra/file/output_file.h"
#include "penumbra/io/csv_table.h"
#include "penumbra/io/npy_array.h"
#include "penumbra/io/npz_reader.h"
#include "penumbra/io/zip_writer.h"

namespace penumbra {
namespace {

constexpr std::size_t chunk = std::size_t{1} << 18;
constexpr const char* axes[] = {"x", "y", "z"};
constexpr const char* bands[] = {"r", "g", "b"};

/// A column of numbers: its name and where each row's value stands.
struct Column {
  std::string name;
  std::function<double(std::size_t row)> value;
};

std::vector<Column> number_columns(const ElementTable& t, bool with_caustics) {
  std::vector<Column> columns;
  for (int k = 0; k < 3; ++k) {
    columns.push_back({fmt::format("c{}", axes[k]), [&t, k](std::size_t i) { return t.centres[i][k]; }});
  }
  for (int k = 0; k < 3; ++k) {
    columns.push_back({fmt::format("n{}", axes[k]), [&t, k](std::size_t i) { return t.normals[i][k]; }});
  }
  columns.push_back({"area", [&t](std::size_t i) { return t.areas[i]; }});
  const auto add_bands = [&](const char* name, const std::vector<double>& values) {
    for (std::size_t b = 0; b < 3; ++b) {
      columns.push_back(
          {fmt::format("{}_{}", name, bands[b]), [&values, b](std::size_t i) { return values[3 * i + b]; }});
    }
  };
  add_bands("reflectance", t.reflectance);
  add_bands("emission", t.emission);
  add_bands("irradiance", t.irradiance);
  add_bands("radiosity", t.radiosity);
  if (with_caustics && !t.caustics.empty()) add_bands("caustics", t.caustics);
  return columns;
}

std::vector<std::string> sides_of(const ElementTable& t) {
  std::vector<std::string> sides;
  for (const bool back : t.backs) sides.emplace_back(back ? "back" : "front");
  return sides;
}

void write_npz(const std::filesystem::path& path, const ElementTable& t) {
  OutputFile out(path);
  ZipWriter zip(out);
  std::vector<double> values(t.rows());
  for (const Column& column : number_columns(t, true)) {
    for (std::size_t i = 0; i < t.rows(); ++i) values[i] = column.value(i);
    zip.add(column.name + ".npy", npy_array(values));
  }
  zip.add("surface.npy", npy_array(t.surfaces));
  zip.add("object.npy", npy_array(t.objects));
  zip.add("side.npy", npy_array(sides_of(t)));
  std::string vertices = npy_header("<f8", fmt::format("({}, 3)", t.vertices.size()));
  vertices.append(reinterpret_cast<const char*>(t.vertices.data()), t.vertices.size() * sizeof(Vec3d));
  zip.add("vertices.npy", vertices);
  if (!t.wavelength_edges.empty()) {
    zip.add("wavelength_edges.npy", npy_array(t.wavelength_edges));
    std::string values_of_bands = npy_header("<f8", fmt::format("({}, {})", t.rows(), t.wavelength_edges.size() - 1));
    values_of_bands.append(reinterpret_cast<const char*>(t.spectral_radiosity.data()),
                           t.spectral_radiosity.size() * sizeof(double));
    zip.add("spectral_radiosity.npy", values_of_bands);
  }
  zip.add("corner_offsets.npy", npy_array(t.corner_offsets));
  zip.add("corners.npy", npy_array(t.corners));
  zip.add("partial.npy", npy_truth(t.partial));
  if (!t.fingerprints.empty()) zip.add("fingerprints.npy", npy_array(t.fingerprints));
  zip.finish();
  out.commit();
}

void write_csv(const std::filesystem::path& path, const ElementTable& t) {
  OutputFile out(path);
  const std::vector<Column> columns = number_columns(t, false);
  std::string text = t.partial ? "# partial: the computation was stopped, light is missing\n" : "";
  for (const Column& column : columns) text += column.name + ",";
  text += "surface,object,side\n";
  for (std::size_t i = 0; i < t.rows(); ++i) {
    for (const Column& column : columns) fmt::format_to(std::back_inserter(text), "{},", column.value(i));
    fmt::format_to(std::back_inserter(text), "{},{},{}\n", t.surfaces[i], csv_word(t.objects[i]),
                   t.backs[i] ? "back" : "front");
    if (text.size() < chunk) continue;
    out.write(text);
    text.clear();
  }
  out.write(text);
  out.commit();
}

/// Arrays of a file that must all be of one length.
class Columns {
 public:
  explicit Columns(const std::filesystem::path& path) : path_(path.string()), file_(path) {}

  std::vector<double> numbers(const std::string& name) {
    std::vector<double> values = file_.doubles(name);
    check(name, values.size());
    for (const double v : values) {
      if (!std::isfinite(v)) throw FileError(path_, "array '" + name + "'", "holds a number that is not finite");
    }
    return values;
  }
  void triples(const std::string& base, const char* const (&suffixes)[3], std::vector<double>& into) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::vector<double> values = numbers(base + suffixes[k]);
      into.resize(3 * values.size());
      for (std::size_t i = 0; i < values.size(); ++i) into[3 * i + k] = values[i];
    }
  }
  void vectors(const std::string& base, std::vector<Vec3d>& into) {
    std::vector<double> flat;
    triples(base, axes, flat);
    for (std::size_t i = 0; i + 2 < flat.size(); i += 3) into.emplace_back(flat[i], flat[i + 1], flat[i + 2]);
  }
  void check(const std::string& name, std::size_t size) {
    if (rows_ && *rows_ != size) {
      throw FileError(path_, "array '" + name + "'", fmt::format("has {} rows where others have {}", size, *rows_));
    }
    rows_ = size;
  }
  [[nodiscard]] const NpzReader& file() const { return file_; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
  NpzReader file_;
  std::optional<std::size_t> rows_;
};

void check_polygons(const ElementTable& t, const std::string& path) {
  const auto require = [&](bool good, const char* name) {
    if (!good) throw FileError(path, fmt::format("array '{}'", name), "does not fit the other arrays");
  };
  require(t.corner_offsets.size() == t.rows() + 1 && t.corner_offsets.front() == 0 &&
              t.corner_offsets.back() == static_cast<std::int64_t>(t.corners.size()),
          "corner_offsets");
  for (std::size_t i = 0; i < t.rows(); ++i) {
    require(t.corner_offsets[i + 1] - t.corner_offsets[i] >= 3 &&
                t.corner_offsets[i + 1] <= static_cast<std::int64_t>(t.corners.size()),
            "corner_offsets");
  }
  for (const std::int64_t c : t.corners) {
    require(c >= 0 && c < static_cast<std::int64_t>(t.vertices.size()), "corners");
  }
}

}  // namespace

void write_element_table(const std::filesystem::path& path, const ElementTable& table) {
  const std::string extension = path.extension().string();
  if (extension == ".npz") return write_npz(path, table);
  if (extension == ".csv") return write_csv(path, table);
  throw FileError(path.string(), "", "a table of elements is written as .npz or .csv; end the name in one of them");
}

ElementTable read_element_table(const std::filesystem::path& path) {
  Columns columns(path);
  const NpzReader& file = columns.file();
  ElementTable t;
  columns.vectors("c", t.centres);
  columns.vectors("n", t.normals);
  t.areas = columns.numbers("area");
  constexpr const char* suffixes[] = {"_r", "_g", "_b"};
  columns.triples("reflectance", suffixes, t.reflectance);
  columns.triples("emission", suffixes, t.emission);
  columns.triples("irradiance", suffixes, t.irradiance);
  columns.triples("radiosity", suffixes, t.radiosity);
  if (file.has("caustics_r")) columns.triples("caustics", suffixes, t.caustics);
  t.surfaces = file.integers("surface");
  columns.check("surface", t.surfaces.size());
  t.objects = file.texts("object");
  columns.check("object", t.objects.size());
  const std::vector<std::string> sides = file.texts("side");
  columns.check("side", sides.size());
  for (const std::string& side : sides) t.backs.push_back(side == "back");
  t.partial = file.truth("partial");
  if (file.has("fingerprints")) t.fingerprints = file.texts("fingerprints");
  if (file.has("wavelength_edges")) t.wavelength_edges = file.doubles("wavelength_edges");
  if (!t.wavelength_edges.empty()) t.spectral_radiosity = file.doubles("spectral_radiosity");
  const std::vector<double> flat = file.doubles("vertices");
  for (std::size_t i = 0; i + 2 < flat.size(); i += 3) t.vertices.emplace_back(flat[i], flat[i + 1], flat[i + 2]);
  t.corner_offsets = file.integers("corner_offsets");
  t.corners = file.integers("corners");
  check_polygons(t, columns.path());
  return t;
}

}  // namespace penumbra
