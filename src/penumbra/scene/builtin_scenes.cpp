#include "penumbra/scene/builtin_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "penumbra/scene/builtin_parts.h"

namespace penumbra {

namespace {

struct Entry {
  std::string_view name;
  std::string_view description;
  std::vector<BuiltinParameter> parameters;
  Scene (*make)(const BuiltinParameters&);
};

/// The one place to register a scene.
const std::vector<Entry>& entries() {
  static const std::vector<Entry> list{
      {"cornell-box", "the measured Cornell box, Lambertian, lit by its lamp", {}, make_cornell_box},
      {"cornell-spheres",
       "the Cornell box with a mirror and a glass sphere in place of the blocks",
       {},
       make_cornell_spheres},
      {"whitted", "glass, mirror and coloured balls on a checkered floor, two point lights", {}, make_whitted},
      {"furnace",
       "a closed room and box that all emit and reflect alike: the radiance is emission / (1 - rho) everywhere",
       {{.key = "rho", .fallback = 0.5, .lower = 0, .upper = 0.99},
        {.key = "emission", .fallback = 1, .lower = 0, .upper = 1e6, .unit = "W/(m^2 sr)"}},
       make_furnace},
      {"box345",
       "a room of 3 x 4 x 5 m in unit squares with none, one or two floating cubes, known for its view factors",
       {{.key = "cubes", .fallback = 2, .lower = 0, .upper = 2, .whole = true}},
       make_box345},
      {"atrium",
       "a closed colonnade hall of two storeys under a skylight, of the size that you name",
       {{.key = "triangles", .fallback = 10000, .lower = 100, .upper = 10000000, .whole = true}},
       make_atrium},
      {"city",
       "street canyons: flat-roofed buildings of differing heights under an open sky, about as many facets as you name",
       {{.key = "facets", .fallback = 2000, .lower = 100, .upper = 1000000, .whole = true}},
       make_city},
      {"fog",
       "a spot light through fog in a dark hall, and the shadows of columns and a ball in its beam",
       {{.key = "sigma_t", .fallback = 0.15, .lower = 0, .upper = 100, .unit = "1/m"},
        {.key = "albedo", .fallback = 0.95, .lower = 0, .upper = 1},
        {.key = "g", .fallback = 0.3, .lower = -0.99, .upper = 0.99}},
       make_fog},
      {"smoke",
       "a column of smoke from a procedural density grid, under the sun",
       {{.key = "cells", .fallback = 96, .lower = 8, .upper = 512, .whole = true},
        {.key = "density", .fallback = 10, .lower = 0, .upper = 1000, .unit = "1/m"}},
       make_smoke},
      {"prism",
       "a prism of dense flint on a table before a strip lamp, or behind a slit (beam=1), throwing a spectrum; "
       "draw it with --spectral",
       {{.key = "beam", .fallback = 0, .lower = 0, .upper = 1, .whole = true}},
       make_prism},
      {"rainbow",
       "a curtain of rain with the sun behind the eye; draw it with --spectral",
       {{.key = "sun", .fallback = 12, .lower = 0, .upper = 40, .unit = "degrees above the horizon"}},
       make_rainbow},
      {"fluorescent",
       "balls of green and orange dye and a white one under a violet lamp; draw it with --spectral",
       {},
       make_fluorescent},
  };
  return list;
}

/// Insertions, deletions and replacements that make one word of the other (Levenshtein 1966).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

[[noreturn]] void refuse_unknown(std::string_view name) {
  const auto distance = [&](const Entry& e) { return edit_distance(name, e.name); };
  const Entry& nearest = *std::ranges::min_element(entries(), {}, distance);
  const bool alike = distance(nearest) <= std::max(name.size(), nearest.name.size()) / 2;
  std::string known;
  for (const Entry& e : entries()) known += fmt::format("{}{}", known.empty() ? "" : ", ", e.name);
  throw std::invalid_argument(fmt::format("there is no built-in scene '{}'{}; the built-in scenes are {}", name,
                                          alike ? fmt::format("; did you mean '{}'?", nearest.name) : std::string(),
                                          known));
}

}  // namespace

std::span<const BuiltinScene> builtin_scenes() {
  struct List {
    std::vector<std::string> parameters;
    std::vector<BuiltinScene> scenes;
  };
  static const List list = [] {
    List made;
    for (const Entry& e : entries()) made.parameters.push_back(describe(e.parameters));
    for (std::size_t i = 0; i < entries().size(); ++i) {
      made.scenes.push_back({entries()[i].name, made.parameters[i], entries()[i].description});
    }
    return made;
  }();
  return list.scenes;
}

Scene make_builtin_scene(std::string_view name_and_parameters) {
  const std::string_view name = name_and_parameters.substr(0, name_and_parameters.find('?'));
  const std::string_view text = name_and_parameters.substr(std::min(name_and_parameters.size(), name.size() + 1));
  const auto entry = std::ranges::find(entries(), name, &Entry::name);
  if (entry == entries().end()) refuse_unknown(name);
  return entry->make(BuiltinParameters(name, entry->parameters, text));
}

}  // namespace penumbra
