#include "penumbra/io/ply_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "penumbra/file/file_error.h"
#include "penumbra/file/input_file.h"
#include "penumbra/io/cutting_work.h"
#include "penumbra/io/text_cursor.h"
#include "penumbra/math/polygon_pieces.h"

namespace penumbra {
namespace {

// Ear clipping takes the square of the corners: more than this is an attack or a mistake, not a face.
constexpr std::size_t most_corners = 10000;

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct TypeName {
  std::string_view name;
  Type type;
};
constexpr std::array<TypeName, 16> type_names{{{"char", Type::int8},
                                               {"int8", Type::int8},
                                               {"uchar", Type::uint8},
                                               {"uint8", Type::uint8},
                                               {"short", Type::int16},
                                               {"int16", Type::int16},
                                               {"ushort", Type::uint16},
                                               {"uint16", Type::uint16},
                                               {"int", Type::int32},
                                               {"int32", Type::int32},
                                               {"uint", Type::uint32},
                                               {"uint32", Type::uint32},
                                               {"float", Type::float32},
                                               {"float32", Type::float32},
                                               {"double", Type::float64},
                                               {"float64", Type::float64}}};

std::size_t size_of(Type type) {
  switch (type) {
    case Type::int8:
    case Type::uint8:
      return 1;
    case Type::int16:
    case Type::uint16:
      return 2;
    case Type::float64:
      return 8;
    default:
      return 4;
  }
}

struct Property {
  std::string name;
  Type type = Type::float32;
  std::optional<Type> count_type;  // a list when set
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;

  [[nodiscard]] int index_of(std::string_view wanted) const {
    for (std::size_t p = 0; p < properties.size(); ++p) {
      if (properties[p].name == wanted) return static_cast<int>(p);
    }
    return -1;
  }
};

enum class Encoding { ascii, little_endian, big_endian };

struct Header {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
};

class HeaderReader {
 public:
  explicit HeaderReader(TextCursor& cursor) : cursor_(cursor) {}

  Header read() {
    if (cursor_.word_in_line() != "ply") cursor_.fail("not a PLY file: the first line should be 'ply'");
    bool has_format = false;
    for (;;) {
      if (!cursor_.skip_line()) cursor_.fail("the file stops inside its header; it is cut short");
      const std::string_view key = cursor_.word_in_line();
      if (key == "end_header") break;
      if (key == "format") {
        read_format();
        has_format = true;
      } else if (key == "element") {
        read_element();
      } else if (key == "property") {
        read_property();
      } else if (!key.empty() && key != "comment" && key != "obj_info") {
        cursor_.fail(fmt::format("unknown header keyword {}", in_quotes(key)));
      }
    }
    if (!has_format) cursor_.fail("the header has no 'format' line");
    return std::move(header_);
  }

 private:
  void read_format() {
    const std::string_view word = cursor_.word_in_line();
    if (word == "ascii") {
      header_.encoding = Encoding::ascii;
    } else if (word == "binary_little_endian") {
      header_.encoding = Encoding::little_endian;
    } else if (word == "binary_big_endian") {
      header_.encoding = Encoding::big_endian;
    } else {
      cursor_.fail(fmt::format("format {} is not known", in_quotes(word)));
    }
  }

  void read_element() {
    Element element;
    element.name = cursor_.word_in_line();
    const std::int64_t most = std::int64_t{1} << 32;
    element.count = static_cast<std::uint64_t>(cursor_.integer(
        cursor_.word_in_line(), fmt::format("the count of element {}", in_quotes(element.name)), 0, most));
    header_.elements.push_back(std::move(element));
  }

  void read_property() {
    if (header_.elements.empty()) cursor_.fail("a property stands before the first element");
    Property property;
    std::string_view word = cursor_.word_in_line();
    if (word == "list") {
      property.count_type = type_of(cursor_.word_in_line());
      if (*property.count_type == Type::float32 || *property.count_type == Type::float64) {
        cursor_.fail("the count of a list should have a whole-number type");
      }
      word = cursor_.word_in_line();
    }
    property.type = type_of(word);
    property.name = cursor_.word_in_line();
    if (property.name.empty()) cursor_.fail("the property has no name");
    header_.elements.back().properties.push_back(std::move(property));
  }

  Type type_of(std::string_view word) {
    for (const TypeName& known : type_names) {
      if (known.name == word) return known.type;
    }
    cursor_.fail(fmt::format("type {} is not known", in_quotes(word)));
  }

  TextCursor& cursor_;
  Header header_;
};

// The numbers after the header, one after the other.
class Values {
 public:
  virtual ~Values() = default;
  virtual double next(Type type) = 0;
  /// The bytes left: no element can have more values than that.
  [[nodiscard]] virtual std::uint64_t bytes_left() const = 0;
  [[nodiscard]] virtual bool packed() const = 0;
  [[nodiscard]] virtual std::uint32_t line() const { return 0; }
  [[noreturn]] virtual void fail(std::string_view what, std::string_view sentence) const = 0;
};

class AsciiValues : public Values {
 public:
  AsciiValues(TextCursor& cursor, std::size_t size) : cursor_(cursor), size_(size) {}
  double next(Type) override { return cursor_.number(cursor_.word(), "a value"); }
  [[nodiscard]] std::uint64_t bytes_left() const override { return size_ - cursor_.offset(); }
  [[nodiscard]] bool packed() const override { return false; }
  [[nodiscard]] std::uint32_t line() const override { return static_cast<std::uint32_t>(cursor_.line()); }
  [[noreturn]] void fail(std::string_view what, std::string_view sentence) const override {
    cursor_.fail(fmt::format("{} {}", what, sentence));
  }

 private:
  TextCursor& cursor_;
  std::size_t size_;
};

class BinaryValues : public Values {
 public:
  BinaryValues(std::string path, std::span<const std::byte> bytes, std::size_t at, bool big_endian)
      : path_(std::move(path)), bytes_(bytes), at_(at), big_endian_(big_endian) {}

  double next(Type type) override {
    const std::size_t size = size_of(type);
    if (bytes_.size() - at_ < size) {
      throw FileError(path_, fmt::format("byte {}", at_), "the file stops before its last value; it is cut short");
    }
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t place = big_endian_ ? size - 1 - i : i;
      bits |= std::to_integer<std::uint64_t>(bytes_[at_ + place]) << (8 * i);
    }
    at_ += size;
    return value_of(bits, type);
  }
  [[nodiscard]] std::uint64_t bytes_left() const override { return bytes_.size() - at_; }
  [[nodiscard]] bool packed() const override { return true; }
  [[noreturn]] void fail(std::string_view what, std::string_view sentence) const override {
    throw FileError(path_, what, sentence);
  }

 private:
  static double value_of(std::uint64_t bits, Type type) {
    switch (type) {
      case Type::int8:
        return static_cast<std::int8_t>(bits);
      case Type::uint8:
        return static_cast<std::uint8_t>(bits);
      case Type::int16:
        return static_cast<std::int16_t>(bits);
      case Type::uint16:
        return static_cast<std::uint16_t>(bits);
      case Type::int32:
        return static_cast<std::int32_t>(bits);
      case Type::uint32:
        return static_cast<std::uint32_t>(bits);
      case Type::float32:
        return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
      case Type::float64:
        return std::bit_cast<double>(bits);
    }
    return 0;
  }

  std::string path_;
  std::span<const std::byte> bytes_;
  std::size_t at_;
  bool big_endian_;
};

float linear_from_srgb(double s) {
  return static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
}

class BodyReader {
 public:
  BodyReader(Values& values, double unit) : values_(values), unit_(unit) { mesh_.face_offsets.push_back(0); }

  Mesh read(const Header& header) {
    for (const Element& element : header.elements) {
      check_count(element);
      if (element.name == "vertex") {
        read_vertices(element);
      } else if (element.name == "face") {
        read_faces(element);
      } else {
        for (std::uint64_t i = 0; i < element.count; ++i) read_row(element);
      }
    }
    if (mesh_.face_offsets.size() == 1) {
      values_.fail("the header", "gives no faces; point clouds and triangle strips make no mesh");
    }
    cut_into_triangles();
    return std::move(mesh_);
  }

 private:
  // A count that the bytes cannot hold is refused before anything of its size is allocated.
  void check_count(const Element& element) {
    std::uint64_t least = 0;
    for (const Property& property : element.properties) {
      least += values_.packed() ? size_of(property.count_type.value_or(property.type)) : 1;
    }
    if (element.count > 0 && least == 0) values_.fail("element '" + element.name + "'", "has no properties");
    if (least > 0 && element.count > values_.bytes_left() / least) {
      values_.fail("element '" + element.name + "'",
                   fmt::format("has {} entries by the header, more than the file has bytes for; it is cut short",
                               element.count));
    }
  }

  // One element's values: scalars in row_, the list called for in list_.
  void read_row(const Element& element, int wanted_list = -1) {
    row_.resize(element.properties.size());
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const Property& property = element.properties[p];
      if (!property.count_type) {
        row_[p] = values_.next(property.type);
        continue;
      }
      const double count = values_.next(*property.count_type);
      if (!(count >= 0) || count != std::floor(count) || count > static_cast<double>(values_.bytes_left())) {
        values_.fail("property '" + property.name + "'", fmt::format("has a list of {} entries", count));
      }
      const bool wanted = static_cast<int>(p) == wanted_list;
      for (double i = 0; i < count; ++i) {
        const double value = values_.next(property.type);
        if (wanted) list_.push_back(value);
      }
    }
  }

  void read_vertices(const Element& element) {
    const std::array<int, 3> place{element.index_of("x"), element.index_of("y"), element.index_of("z")};
    const std::array<int, 3> normal{element.index_of("nx"), element.index_of("ny"), element.index_of("nz")};
    const std::array<int, 3> colour{element.index_of("red"), element.index_of("green"), element.index_of("blue")};
    const auto whole = [](const std::array<int, 3>& a) { return std::min({a[0], a[1], a[2]}) >= 0; };
    if (!whole(place)) values_.fail("element 'vertex'", "lacks x, y or z");
    const auto at = [&](const std::array<int, 3>& a) {
      return Vec3d(row_[static_cast<std::size_t>(a[0])], row_[static_cast<std::size_t>(a[1])],
                   row_[static_cast<std::size_t>(a[2])]);
    };
    for (std::uint64_t v = 0; v < element.count; ++v) {
      read_row(element);
      const Vec3d p = unit_ * at(place);
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
        values_.fail(fmt::format("vertex {}", v), "is not finite; repair the mesh");
      }
      mesh_.positions.push_back(p);
      if (whole(normal)) mesh_.normals.emplace_back(unit_normal(at(normal)));
      if (whole(colour)) mesh_.colours.push_back(colour_of(at(colour), element, colour[0]));
    }
  }

  static Vec3f unit_normal(const Vec3d& n) {
    const double size = length(n);
    return std::isfinite(size) && size > 0 ? Vec3f(n / size) : Vec3f(0, 0, 1);
  }

  // Bytes are sRGB, as scanners and viewers have it; floats are linear.
  static Vec4f colour_of(const Vec3d& c, const Element& element, int property) {
    const Type type = element.properties[static_cast<std::size_t>(property)].type;
    if (type == Type::float32 || type == Type::float64) {
      const Vec3d finite(std::isfinite(c.x) ? c.x : 0, std::isfinite(c.y) ? c.y : 0, std::isfinite(c.z) ? c.z : 0);
      return {Vec3f(glm::clamp(finite, 0.0, 1.0)), 1};
    }
    const double most = type == Type::uint16 ? 65535 : 255;
    const Vec3d s = glm::clamp(c / most, 0.0, 1.0);
    return {linear_from_srgb(s.x), linear_from_srgb(s.y), linear_from_srgb(s.z), 1};
  }

  void read_faces(const Element& element) {
    int list = element.index_of("vertex_indices");
    if (list < 0) list = element.index_of("vertex_index");
    if (list < 0 || !element.properties[static_cast<std::size_t>(list)].count_type) {
      values_.fail("element 'face'", "lacks the list vertex_indices");
    }
    for (std::uint64_t f = 0; f < element.count; ++f) {
      list_.clear();
      read_row(element, list);
      if (list_.size() < 3 || list_.size() > most_corners) {
        values_.fail(fmt::format("face {}", f),
                     fmt::format("has {} corners; a face has 3 to {}", list_.size(), most_corners));
      }
      for (const double v : list_) {
        if (!(v >= 0 && v < 4294967295.0 && v == std::floor(v))) {
          values_.fail(fmt::format("face {}", f), fmt::format("names vertex {}, which does not exist", v));
        }
        mesh_.face_vertices.push_back(static_cast<std::uint32_t>(v));
      }
      mesh_.face_offsets.push_back(static_cast<std::uint32_t>(mesh_.face_vertices.size()));
      if (!values_.packed()) mesh_.face_lines.push_back(values_.line());
    }
  }

  void cut_into_triangles() {
    std::vector<Vec3d> corners;
    for (std::size_t f = 0; f < mesh_.face_count(); ++f) {
      const auto face = mesh_.face(f);
      corners.clear();
      for (const std::uint32_t v : face) {
        if (v >= mesh_.positions.size()) {
          values_.fail(fmt::format("face {}", f), fmt::format("names vertex {}, which does not exist", v));
        }
        corners.push_back(mesh_.positions[v]);
      }
      if (!cutting_work_.allows(corners.size())) {
        values_.fail(fmt::format("face {}", f), "and the large ones before it take too long to cut; split them");
      }
      for (const auto& t : triangulate_polygon(corners)) {
        mesh_.triangles.push_back({face[t[0]], face[t[1]], face[t[2]]});
        mesh_.face_of_triangle.push_back(static_cast<std::uint32_t>(f));
      }
    }
  }

  Values& values_;
  double unit_;
  Mesh mesh_;
  CuttingWork cutting_work_;
  std::vector<double> row_;
  std::vector<double> list_;
};

}  // namespace

LoadedScene read_ply(const std::filesystem::path& path, double unit) {
  const auto bytes = read_file(path);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  TextCursor cursor(path.string(), text);
  const Header header = HeaderReader(cursor).read();
  cursor.skip_line();
  std::unique_ptr<Values> values;
  if (header.encoding == Encoding::ascii) {
    values = std::make_unique<AsciiValues>(cursor, text.size());
  } else {
    values =
        std::make_unique<BinaryValues>(path.string(), bytes, cursor.offset(), header.encoding == Encoding::big_endian);
  }
  LoadedScene loaded;
  Mesh mesh = BodyReader(*values, unit).read(header);
  mesh.name = path.stem().string();
  Material grey;
  grey.name = "default";
  grey.specular = 0;
  loaded.scene.materials.push_back(grey);
  loaded.scene.instances.push_back({mesh.name, 0, Mat4d(1.0)});
  loaded.scene.meshes.push_back(std::move(mesh));
  validate(loaded.scene);
  return loaded;
}

}  // namespace penumbra
