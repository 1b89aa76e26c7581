#include "penumbra/io/vs3_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "penumbra/file/file_error.h"
#include "penumbra/file/input_file.h"
#include "penumbra/io/text_cursor.h"

namespace penumbra {
namespace {

constexpr std::int64_t most_number = std::numeric_limits<std::int32_t>::max();

// Exact at the multiples of 90 degrees that rooms are made of.
double sin_degrees(double angle) {
  const double turn = std::remainder(angle, 360.0);
  if (turn == 0 || std::abs(turn) == 180) return 0;
  if (std::abs(turn) == 90) return turn > 0 ? 1 : -1;
  return std::sin(turn * std::numbers::pi / 180);
}
double cos_degrees(double angle) { return sin_degrees(angle + 90); }

bool same_ignoring_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char x, unsigned char y) { return std::toupper(x) == std::toupper(y); });
}

class Vs3Parser {
 public:
  Vs3Parser(std::string path, std::string_view text, double unit)
      : path_(path), cursor_(std::move(path), text, '!'), unit_(unit) {}

  LoadedPolygonModel parse();

 private:
  enum class Format { unknown, vertices_and_surfaces, planes };

  // What a surface line names by number, to be looked up when all lines are read.
  struct Reference {
    std::int64_t base = 0;
    std::int64_t combined_with = 0;
    std::size_t line = 0;
  };

  bool read_element();  // false at the end of data
  void read_controls();
  void read_format();
  void read_vertex();
  void read_surface(PolygonRole role);
  std::vector<std::uint32_t> read_corner_numbers(std::int64_t number);
  void read_surface_data(ModelPolygon& polygon, Reference& reference, std::int64_t number);
  std::vector<std::uint32_t> read_plane(char shape, std::int64_t number);
  void resolve_references();
  void resolve_base(std::size_t p);
  void resolve_combination(std::size_t p);
  /// The polygon that polygon `by` names as its base or combination.
  std::uint32_t polygon_named(std::int64_t number, std::size_t by, std::string_view as) const;
  [[noreturn]] void fail_at(std::size_t line, std::string_view sentence) const {
    throw FileError(path_, fmt::format("line {}", line), sentence);
  }

  double number(std::string_view what) { return cursor_.number(cursor_.word_in_line(), what); }
  std::int64_t integer(std::string_view what, std::int64_t least) {
    return cursor_.integer(cursor_.word_in_line(), what, least, most_number);
  }

  std::string path_;
  TextCursor cursor_;
  double unit_;
  Format format_ = Format::unknown;
  PolygonModel model_;
  std::unordered_map<std::int64_t, std::uint32_t> vertex_of_number_;
  std::unordered_map<std::int64_t, std::uint32_t> polygon_of_number_;
  std::vector<Reference> references_;
  std::vector<std::string> warnings_;
};

LoadedPolygonModel Vs3Parser::parse() {
  bool ended = false;
  while (!ended && cursor_.seek_word()) {
    ended = !read_element();
    cursor_.skip_line();
  }
  if (!ended) {
    cursor_.word();
    cursor_.fail("the file stops without 'End of data'; it may be cut short (add the line 'E' if it is whole)");
  }
  if (references_.empty()) cursor_.fail("there is no surface (S) before the end of data");
  resolve_references();
  return {std::move(model_), std::move(warnings_)};
}

bool Vs3Parser::read_element() {
  const std::string_view key = cursor_.word_in_line();
  if (key[0] == '/') return true;
  if (key[0] == '*' || same_ignoring_case(key, "End")) return false;
  const char letter = key.size() == 1 ? static_cast<char>(std::toupper(static_cast<unsigned char>(key[0]))) : '?';
  switch (letter) {
    case 'T':
      model_.title = cursor_.rest_of_line();
      return true;
    case 'C':
      read_controls();
      return true;
    case 'F':
      read_format();
      return true;
    case 'V':
      read_vertex();
      return true;
    case 'S':
      read_surface(PolygonRole::radiates);
      return true;
    case 'M':
      read_surface(PolygonRole::covers);
      return true;
    case 'N':
      read_surface(PolygonRole::masks);
      return true;
    case 'O':
      read_surface(PolygonRole::obstructs);
      return true;
    case 'E':
      return false;
    default:
      cursor_.fail(fmt::format("unknown keyword {}; a line begins with T, C, F, V, S, M, N, O, E or a comment (! or /)",
                               in_quotes(key)));
  }
}

// Only what would change the factors themselves is worth a word.
void Vs3Parser::read_controls() {
  for (std::string_view word = cursor_.word_in_line(); !word.empty(); word = cursor_.word_in_line()) {
    const std::size_t equals = word.find('=');
    const std::string_view name = word.substr(0, equals);
    const std::string_view value = equals == std::string_view::npos ? "" : word.substr(equals + 1);
    const bool asks_for_other_factors =
        same_ignoring_case(name, "emit") || same_ignoring_case(name, "row") || same_ignoring_case(name, "col");
    if (asks_for_other_factors && !value.empty() && value != "0") {
      warnings_.push_back(
          fmt::format("{}: line {}: the control {} is ignored: all factors are computed, between black surfaces", path_,
                      cursor_.line(), word));
    }
  }
}

void Vs3Parser::read_format() {
  const std::string_view word = cursor_.word_in_line();
  if (!references_.empty() || !vertex_of_number_.empty()) cursor_.fail("F must stand before the vertices and surfaces");
  if (word == "3") {
    format_ = Format::vertices_and_surfaces;
  } else if (same_ignoring_case(word, "3a")) {
    format_ = Format::planes;
  } else {
    cursor_.fail(fmt::format("geometry format {} is not known; only F 3 and F 3a are read", in_quotes(word)));
  }
}

void Vs3Parser::read_vertex() {
  if (format_ != Format::vertices_and_surfaces) cursor_.fail("a vertex (V) needs a line 'F 3' before it");
  const std::int64_t number_of_vertex = integer("the vertex number", 1);
  Vec3d p;
  p.x = number(fmt::format("x of vertex {}", number_of_vertex));
  p.y = number(fmt::format("y of vertex {}", number_of_vertex));
  p.z = number(fmt::format("z of vertex {}", number_of_vertex));
  if (!vertex_of_number_.emplace(number_of_vertex, static_cast<std::uint32_t>(model_.vertices.size())).second) {
    cursor_.fail(fmt::format("vertex {} was given before; each number may stand once", number_of_vertex));
  }
  model_.vertices.push_back(unit_ * p);
}

void Vs3Parser::read_surface(PolygonRole role) {
  if (format_ == Format::unknown) cursor_.fail("a surface needs a line 'F 3' or 'F 3a' before it");
  const std::size_t line = cursor_.line();
  const std::int64_t number_of_surface = integer("the surface number", 1);
  char shape = ' ';
  std::vector<std::uint32_t> corners;
  if (format_ == Format::planes) {
    const std::string_view word = cursor_.word_in_line();
    shape = word.size() == 1 ? static_cast<char>(std::toupper(static_cast<unsigned char>(word[0]))) : '?';
    if (shape != 'R' && shape != 'Q' && shape != 'T') {
      cursor_.fail(
          fmt::format("the shape of surface {} should be R, Q or T but is {}", number_of_surface, in_quotes(word)));
    }
  } else {
    corners = read_corner_numbers(number_of_surface);
  }
  ModelPolygon polygon;
  polygon.role = role;
  polygon.place = fmt::format("line {}", line);
  Reference reference;
  reference.line = line;
  read_surface_data(polygon, reference, number_of_surface);
  polygon.corners = format_ == Format::planes ? read_plane(shape, number_of_surface) : std::move(corners);

  if (!polygon_of_number_.emplace(number_of_surface, static_cast<std::uint32_t>(references_.size())).second) {
    fail_at(line, fmt::format("surface {} was given before; each number may stand once", number_of_surface));
  }
  references_.push_back(reference);
  model_.polygons.push_back(std::move(polygon));
}

std::vector<std::uint32_t> Vs3Parser::read_corner_numbers(std::int64_t number_of_surface) {
  std::vector<std::uint32_t> corners;
  for (int i = 1; i <= 4; ++i) {
    const std::int64_t vertex = integer(fmt::format("corner {} of surface {}", i, number_of_surface), i == 4 ? 0 : 1);
    if (vertex == 0) break;  // a triangle
    const auto found = vertex_of_number_.find(vertex);
    if (found == vertex_of_number_.end()) {
      cursor_.fail(fmt::format("surface {} names vertex {}, which is not given before it", number_of_surface, vertex));
    }
    corners.push_back(found->second);
  }
  return corners;
}

void Vs3Parser::read_surface_data(ModelPolygon& polygon, Reference& reference, std::int64_t number_of_surface) {
  polygon.name = fmt::format("surface {}", number_of_surface);
  // Obstructions need none of this; some files give it all the same.
  if (polygon.role == PolygonRole::obstructs) {
    std::string_view last;
    for (auto word = cursor_.word_in_line(); !word.empty(); word = cursor_.word_in_line()) last = word;
    if (!last.empty() && std::isalpha(static_cast<unsigned char>(last[0])) != 0) polygon.name = last;
    return;
  }
  reference.base = integer(fmt::format("the base of surface {}", number_of_surface), 0);
  reference.combined_with = integer(fmt::format("the combination of surface {}", number_of_surface), 0);
  const double emissivity = number(fmt::format("the emissivity of surface {}", number_of_surface));
  if (emissivity < 0 || emissivity > 1) {
    cursor_.fail(
        fmt::format("the emissivity of surface {} is {}, but should be from 0 to 1", number_of_surface, emissivity));
  }
  polygon.reflectance = 1 - emissivity;
  const std::string_view name = cursor_.word_in_line();
  if (!name.empty()) polygon.name = name;
}

// The plane's own axes: u to the right seen from the front, v up the slope. Azimuth clockwise from +y (north) is where
// the front looks; tilt 0 looks up, 90 is a wall, 180 looks down.
std::vector<std::uint32_t> Vs3Parser::read_plane(char shape, std::int64_t number_of_surface) {
  const auto next = [&](std::string_view what) {
    return cursor_.number(cursor_.word(), fmt::format("{} of surface {}", what, number_of_surface));
  };
  Vec3d origin;
  origin.x = next("x of the origin");
  origin.y = next("y of the origin");
  origin.z = next("z of the origin");
  const double azimuth = next("the azimuth");
  const double tilt = next("the tilt");
  std::vector<Vec2d> flat;
  if (shape == 'R') {
    const double width = next("the width");
    const double height = next("the height");
    flat = {{0, 0}, {width, 0}, {width, height}, {0, height}};
  } else {
    for (int i = 1; i <= (shape == 'T' ? 3 : 4); ++i) {
      const double x = next(fmt::format("x of corner {}", i));
      flat.emplace_back(x, next(fmt::format("y of corner {}", i)));
    }
  }
  const Vec3d u(-cos_degrees(azimuth), sin_degrees(azimuth), 0);
  const Vec3d v(-cos_degrees(tilt) * sin_degrees(azimuth), -cos_degrees(tilt) * cos_degrees(azimuth),
                sin_degrees(tilt));
  std::vector<std::uint32_t> corners;
  for (const Vec2d& p : flat) {
    corners.push_back(static_cast<std::uint32_t>(model_.vertices.size()));
    model_.vertices.push_back(unit_ * (origin + p.x * u + p.y * v));
  }
  return corners;
}

void Vs3Parser::resolve_references() {
  for (std::size_t p = 0; p < references_.size(); ++p) {
    resolve_base(p);
    resolve_combination(p);
  }
}

std::uint32_t Vs3Parser::polygon_named(std::int64_t number_of_surface, std::size_t by, std::string_view as) const {
  const auto found = polygon_of_number_.find(number_of_surface);
  if (found != polygon_of_number_.end()) return found->second;
  fail_at(references_[by].line, fmt::format("the {} of surface '{}' is surface {}, which does not exist", as,
                                            model_.polygons[by].name, number_of_surface));
}

void Vs3Parser::resolve_base(std::size_t p) {
  const Reference& from = references_[p];
  ModelPolygon& polygon = model_.polygons[p];
  if (from.base == 0) {
    if (polygon.role == PolygonRole::covers || polygon.role == PolygonRole::masks) {
      fail_at(from.line, fmt::format("surface '{}' (M or N) needs a base: the surface it lies on", polygon.name));
    }
    return;
  }
  const std::uint32_t base = polygon_named(from.base, p, "base");
  const PolygonRole role = model_.polygons[base].role;
  if (role == PolygonRole::covers || role == PolygonRole::masks) {
    fail_at(from.line, fmt::format("the base of surface '{}' should be a surface of kind S or O", polygon.name));
  }
  if (polygon.role != PolygonRole::radiates && role == PolygonRole::obstructs) {
    fail_at(from.line, fmt::format("the base of surface '{}' (M or N) should be a surface of kind S", polygon.name));
  }
  // Obstructions are numbered last, so they alone may be a base that comes later.
  if (base == p || (base > p && role != PolygonRole::obstructs)) {
    fail_at(from.line, fmt::format("the base of surface '{}' should stand before it", polygon.name));
  }
  polygon.base = base;
}

void Vs3Parser::resolve_combination(std::size_t p) {
  const Reference& from = references_[p];
  ModelPolygon& polygon = model_.polygons[p];
  if (from.combined_with == 0) return;
  const std::uint32_t with = polygon_named(from.combined_with, p, "combination");
  if (polygon.role != PolygonRole::radiates) {
    fail_at(from.line, fmt::format("surface '{}' cannot be combined; only surfaces of kind S can", polygon.name));
  }
  if (with >= p || model_.polygons[with].role != PolygonRole::radiates) {
    fail_at(from.line,
            fmt::format("surface '{}' should combine with a surface of kind S that stands before it", polygon.name));
  }
  if (model_.polygons[with].combines_with) {
    fail_at(from.line, fmt::format("surface '{}' combines with one that is itself combined; name the first of them",
                                   polygon.name));
  }
  polygon.combines_with = with;
}

}  // namespace

LoadedPolygonModel read_vs3(const std::filesystem::path& path, double unit) {
  const auto bytes = read_file(path);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return Vs3Parser(path.string(), text, unit).parse();
}

}  // namespace penumbra
