#include "penumbra/io/obj_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <unordered_map>

#include "penumbra/file/file_error.h"
#include "penumbra/io/obj_statements.h"
#include "penumbra/io/text_cursor.h"

namespace penumbra {
namespace {

constexpr std::size_t most_entries = ObjCorner::none - 1;

class ObjParser {
 public:
  ObjParser(const std::string& path, std::string_view text, double unit, WarningTally& warnings)
      : statements_(path, text),
        unit_(unit),
        warnings_(warnings),
        file_stem_(std::filesystem::path(path).stem().string()) {}

  ObjModel parse() {
    while (statements_.next()) read_statement();
    if (model_.faces.empty()) {
      throw FileError(statements_.path(), "", "holds no faces; a scene needs at least one f statement");
    }
    check_indices();
    if (has_colours_) {
      model_.colours.resize(model_.positions.size(), Vec3f(1.0F));
    }
    return std::move(model_);
  }

 private:
  void read_statement();
  void read_position();
  void read_uv();
  void read_normal();
  void read_face();
  ObjCorner read_corner(std::string_view word);
  std::uint32_t read_index(const char*& at, const char* end, std::size_t count, std::string_view what,
                           std::string_view word);
  void read_material();
  void read_unknown();
  void begin_object();
  void begin_group();
  std::uint32_t current_part();
  void check_indices() const;
  void check_room(std::size_t count, std::string_view what) const {
    if (count >= most_entries) statements_.fail(fmt::format("the file holds more than {} {}", most_entries, what));
  }

  ObjStatements statements_;
  double unit_;
  WarningTally& warnings_;
  std::string file_stem_;
  ObjModel model_;
  bool has_colours_ = false;
  bool has_objects_ = false;
  std::string group_;
  std::optional<std::uint32_t> part_;  // of the faces to come, once there is one
  std::unordered_map<std::string, std::uint32_t> part_of_group_;
  std::string material_;
  std::optional<std::uint32_t> material_index_;
  std::unordered_map<std::string, std::uint32_t> index_of_material_;
};

void ObjParser::read_statement() {
  const std::string_view keyword = statements_.keyword();
  if (keyword == "v") return read_position();
  if (keyword == "f" || keyword == "fo") return read_face();
  if (keyword == "vt") return read_uv();
  if (keyword == "vn") return read_normal();
  if (keyword == "usemtl") return read_material();
  if (keyword == "o") return begin_object();
  if (keyword == "g") return begin_group();
  if (keyword == "mtllib") {
    model_.libraries.push_back({std::string(statements_.rest()), statements_.place()});
    return;
  }
  read_unknown();
}

void ObjParser::read_position() {
  check_room(model_.positions.size(), "positions");
  Vec3d p;
  p.x = statements_.number("x of the position");
  p.y = statements_.number("y of the position");
  p.z = statements_.number("z of the position");
  p *= unit_;
  if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
    statements_.fail("the position is too far away for a number to hold once it is in metres");
  }
  model_.positions.push_back(p);
  // x y z, x y z w, x y z r g b, or x y z r g b a.
  std::array<double, 4> more{};
  std::size_t count = 0;
  for (auto word = statements_.word(); !word.empty() && count < more.size(); word = statements_.word()) {
    more[count++] = statements_.number(word, "a colour of the position");
  }
  if (count < 3) return;
  has_colours_ = true;
  const Vec3d colour(more[0], more[1], more[2]);
  const Vec3d clamped = glm::min(glm::max(colour, Vec3d(0)), Vec3d(1));
  if (clamped != colour) {
    warnings_.count("colours of positions were cut to 0..1; scale them if they are meant to be 0..255",
                    statements_.place());
  }
  model_.colours.resize(model_.positions.size(), Vec3f(1.0F));
  model_.colours.back() = Vec3f(clamped);
}

void ObjParser::read_uv() {
  check_room(model_.uvs.size(), "texture coordinates");
  const double u = statements_.number("u of the texture coordinate");
  const auto word = statements_.word();
  const double v = word.empty() ? 0.0 : statements_.number(word, "v of the texture coordinate");
  const Vec2f uv(static_cast<float>(u), static_cast<float>(v));
  if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) statements_.fail("the texture coordinate is too large");
  model_.uvs.push_back(uv);
}

void ObjParser::read_normal() {
  check_room(model_.normals.size(), "normals");
  Vec3d n;
  n.x = statements_.number("x of the normal");
  n.y = statements_.number("y of the normal");
  n.z = statements_.number("z of the normal");
  // Scaled first, so that lengths stay within what a float holds.
  const double largest = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
  model_.normals.emplace_back(largest > 0 ? n / largest : n);
}

void ObjParser::read_face() {
  const std::size_t first = model_.corners.size();
  for (auto word = statements_.word(); !word.empty(); word = statements_.word()) {
    model_.corners.push_back(read_corner(word));
  }
  const std::size_t count = model_.corners.size() - first;
  if (count < 3) statements_.fail(fmt::format("the face has {} corners; it needs at least 3", count));
  check_room(model_.corners.size(), "corners of faces");
  if (!material_index_) {
    const auto [found, is_new] =
        index_of_material_.emplace(material_, static_cast<std::uint32_t>(model_.material_names.size()));
    if (is_new) model_.material_names.push_back(material_);
    material_index_ = found->second;
  }
  model_.faces.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count), current_part(),
                          *material_index_, static_cast<std::uint32_t>(statements_.line())});
}

// "7", "7/2", "7//3" or "7/2/3", negative ones counted back from the latest.
ObjCorner ObjParser::read_corner(std::string_view word) {
  const char* at = word.data();
  const char* const end = at + word.size();
  ObjCorner corner;
  corner.position = read_index(at, end, model_.positions.size(), "position", word);
  if (at < end && *at == '/') {
    ++at;
    if (at < end && *at != '/') corner.uv = read_index(at, end, model_.uvs.size(), "texture coordinate", word);
    if (at < end && *at == '/') {
      ++at;
      if (at < end) corner.normal = read_index(at, end, model_.normals.size(), "normal", word);
    }
  }
  if (at != end)
    statements_.fail(fmt::format("{} is no corner of a face; write v, v/vt, v//vn or v/vt/vn", in_quotes(word)));
  return corner;
}

std::uint32_t ObjParser::read_index(const char*& at, const char* end, std::size_t count, std::string_view what,
                                    std::string_view word) {
  std::int64_t index = 0;
  const auto [stop, error] = std::from_chars(at, end, index);
  if (error != std::errc{}) {
    statements_.fail(fmt::format("{} is no corner of a face; write v, v/vt, v//vn or v/vt/vn", in_quotes(word)));
  }
  at = stop;
  const auto known = static_cast<std::int64_t>(count);
  if (index == 0)
    statements_.fail(fmt::format("corner {} names {} 0, but they are counted from 1", in_quotes(word), what));
  if (index < -known) {
    statements_.fail(
        fmt::format("corner {} goes back {} {}s, but only {} stand before it", in_quotes(word), -index, what, known));
  }
  // Those that come later in the file are allowed; check_indices() sees whether they came.
  const std::int64_t from_zero = index < 0 ? known + index : index - 1;
  if (from_zero >= static_cast<std::int64_t>(most_entries)) {
    statements_.fail(
        fmt::format("corner {} names a {} beyond the {} that are read", in_quotes(word), what, most_entries));
  }
  return static_cast<std::uint32_t>(from_zero);
}

void ObjParser::read_material() {
  material_ = statements_.rest();
  material_index_.reset();
}

void ObjParser::begin_object() {
  const std::string_view name = statements_.rest();
  // Groups that came before the first object were no objects of their own.
  if (!has_objects_ && !model_.parts.empty()) {
    model_.parts = {file_stem_};
    for (ObjFace& face : model_.faces) face.part = 0;
  }
  has_objects_ = true;
  part_ = static_cast<std::uint32_t>(model_.parts.size());
  model_.parts.emplace_back(name.empty() ? fmt::format("object {}", model_.parts.size() + 1) : std::string(name));
}

void ObjParser::begin_group() {
  group_ = statements_.rest();
  if (!has_objects_) part_.reset();
}

std::uint32_t ObjParser::current_part() {
  if (!part_) {
    const std::string& name = group_.empty() ? file_stem_ : group_;
    const auto [found, is_new] = part_of_group_.emplace(name, static_cast<std::uint32_t>(model_.parts.size()));
    if (is_new) model_.parts.push_back(name);
    part_ = found->second;
  }
  return *part_;
}

void ObjParser::read_unknown() {
  const std::string_view keyword = statements_.keyword();
  if (keyword == "s") return;  // smoothing groups: normals say it better
  if (keyword == "l" || keyword == "p") {
    warnings_.count("lines and points have no surface and were left out", statements_.place());
    return;
  }
  // Specification "Object files (.obj)", free-form geometry and superseded statements for it.
  constexpr std::array free_form{"vp",    "cstype", "deg",  "bmat", "step", "curv", "curv2", "surf",
                                 "parm",  "trim",   "hole", "scrv", "sp",   "end",  "con",   "mg",
                                 "ctech", "stech",  "bsp",  "bzp",  "cdc",  "cdp",  "res"};
  if (std::find(free_form.begin(), free_form.end(), keyword) != free_form.end()) {
    if (keyword != "curv" && keyword != "curv2" && keyword != "surf" && keyword != "bsp" && keyword != "bzp" &&
        keyword != "cdc" && keyword != "cdp") {
      return;  // a part of those
    }
    warnings_.count("free-form curves and surfaces are not drawn; convert them to polygons", statements_.place());
    return;
  }
  warnings_.count("statements that are not known were left out",
                  fmt::format("{} ({})", statements_.place(), in_quotes(keyword)));
}

void ObjParser::check_indices() const {
  const auto check = [this](const ObjFace& face, std::uint32_t index, std::size_t count, std::string_view what) {
    if (index == ObjCorner::none || index < count) return;
    throw FileError(statements_.path(), fmt::format("line {}", face.line),
                    fmt::format("the face names {} {}, but the file has {}; it may be cut short", what,
                                std::size_t{index} + 1, count));
  };
  for (const ObjFace& face : model_.faces) {
    for (std::uint32_t c = 0; c < face.corner_count; ++c) {
      const ObjCorner& corner = model_.corners[face.first_corner + c];
      check(face, corner.position, model_.positions.size(), "position");
      check(face, corner.uv, model_.uvs.size(), "texture coordinate");
      check(face, corner.normal, model_.normals.size(), "normal");
    }
  }
}

}  // namespace

ObjModel parse_obj(const std::string& path, std::string_view text, double unit, WarningTally& warnings) {
  return ObjParser(path, text, unit, warnings).parse();
}

}  // namespace penumbra
