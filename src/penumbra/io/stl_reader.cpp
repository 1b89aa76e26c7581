#include "penumbra/io/stl_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "penumbra/file/file_error.h"
#include "penumbra/file/input_file.h"
#include "penumbra/io/text_cursor.h"
#include "penumbra/math/vertex_welder.h"

namespace penumbra {
namespace {

constexpr std::size_t header_size = 84;
constexpr std::size_t facet_size = 50;

std::uint32_t little_endian_word(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i) word |= std::to_integer<std::uint32_t>(bytes[at + i]) << (8 * i);
  return word;
}

bool is_word(std::string_view word, std::string_view expected) {
  return std::equal(word.begin(), word.end(), expected.begin(), expected.end(),
                    [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); });
}

// Many binary files begin with "solid" too: what decides is the size that the count of facets implies, then zero bytes.
bool is_ascii(std::span<const std::byte> bytes) {
  if (bytes.size() >= header_size &&
      header_size + facet_size * std::uint64_t{little_endian_word(bytes, 80)} == bytes.size()) {
    return false;
  }
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  text = text.substr(0, 1024);
  if (text.find('\0') != std::string_view::npos) return false;
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && is_word(text.substr(first, 5), "solid");
}

LoadedScene scene_of(std::vector<Mesh> meshes, std::vector<std::string> warnings) {
  LoadedScene loaded;
  Material grey;
  grey.name = "default";
  grey.specular = 0;
  loaded.scene.materials.push_back(grey);
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    loaded.scene.instances.push_back({meshes[m].name, static_cast<std::uint32_t>(m), Mat4d(1.0)});
  }
  loaded.scene.meshes = std::move(meshes);
  loaded.warnings = std::move(warnings);
  validate(loaded.scene);
  return loaded;
}

class AsciiStl {
 public:
  AsciiStl(const std::string& path, std::string_view text, std::string_view default_name, double unit)
      : cursor_(path, text), default_name_(default_name), unit_(unit) {}

  std::vector<Mesh> read() {
    std::vector<Mesh> meshes;
    while (cursor_.seek_word()) {
      Mesh mesh = read_solid();
      if (!mesh.triangles.empty()) meshes.push_back(std::move(mesh));
    }
    if (meshes.empty()) cursor_.fail("there is no facet in the file");
    return meshes;
  }

 private:
  Mesh read_solid() {
    expect("solid");
    Mesh mesh;
    mesh.name = cursor_.rest_of_line();
    if (mesh.name.empty()) mesh.name = default_name_;
    VertexWelder welder(mesh.positions);
    for (;;) {
      const std::string_view word = cursor_.word();
      if (is_word(word, "facet")) {
        read_facet(mesh, welder);
      } else if (is_word(word, "endsolid")) {
        cursor_.rest_of_line();
        return mesh;
      } else if (word.empty()) {
        cursor_.fail("the file stops inside a solid; it may be cut short (add 'endsolid' if it is whole)");
      } else {
        cursor_.fail(fmt::format("expected 'facet' or 'endsolid' but found {}", in_quotes(word)));
      }
    }
  }

  void read_facet(Mesh& mesh, VertexWelder& welder) {
    mesh.face_lines.push_back(static_cast<std::uint32_t>(cursor_.line()));
    expect("normal");
    // The order of corners decides; stored normals are wrong as often as not, and some are nan.
    for (int i = 0; i < 3; ++i) cursor_.word();
    expect("outer");
    expect("loop");
    Mesh::Triangle triangle{};
    for (std::uint32_t& corner : triangle) {
      expect("vertex");
      Vec3d p;
      for (int axis = 0; axis < 3; ++axis) p[axis] = cursor_.number(cursor_.word(), "a coordinate");
      corner = welder.number(unit_ * p);
    }
    expect("endloop");
    expect("endfacet");
    mesh.triangles.push_back(triangle);
  }

  void expect(std::string_view expected) {
    const std::string_view word = cursor_.word();
    if (is_word(word, expected)) return;
    if (word.empty()) cursor_.fail(fmt::format("the file stops where '{}' should come; it is cut short", expected));
    cursor_.fail(fmt::format("expected '{}' but found {}", expected, in_quotes(word)));
  }

  TextCursor cursor_;
  std::string default_name_;
  double unit_;
};

Mesh read_binary(const std::string& path, std::span<const std::byte> bytes, std::string_view name, double unit,
                 std::vector<std::string>& warnings) {
  if (bytes.size() < header_size) {
    throw FileError(path, fmt::format("byte {}", bytes.size()),
                    "neither ASCII STL (which begins with 'solid') nor binary STL (which has 84 bytes at least)");
  }
  const std::uint64_t count = little_endian_word(bytes, 80);
  const std::uint64_t needed = header_size + facet_size * count;
  if (needed > bytes.size()) {
    throw FileError(path, "byte 80",
                    fmt::format("the header promises {} facets, which take {} bytes, but the file has {}; it is cut "
                                "short or no STL file",
                                count, needed, bytes.size()));
  }
  if (count == 0) throw FileError(path, "byte 80", "there is no facet in the file");
  if (needed < bytes.size()) {
    warnings.push_back(
        fmt::format("{}: byte {}: {} bytes after the last facet were ignored", path, needed, bytes.size() - needed));
  }
  Mesh mesh;
  mesh.name = name;
  mesh.triangles.reserve(count);
  VertexWelder welder(mesh.positions);
  for (std::uint64_t facet = 0; facet < count; ++facet) {
    std::size_t at = header_size + facet_size * facet + 12;  // after the normal
    Mesh::Triangle triangle{};
    for (std::uint32_t& corner : triangle) {
      Vec3d p;
      for (int axis = 0; axis < 3; ++axis, at += 4) p[axis] = std::bit_cast<float>(little_endian_word(bytes, at));
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
        throw FileError(path, fmt::format("facet {}", facet + 1), "a corner is not a finite number; repair the mesh");
      }
      corner = welder.number(unit * p);
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

}  // namespace

LoadedScene read_stl(const std::filesystem::path& path, double unit) {
  const auto bytes = read_file(path);
  const std::string name = path.stem().string();
  std::vector<std::string> warnings;
  if (is_ascii(bytes)) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return scene_of(AsciiStl(path.string(), text, name, unit).read(), std::move(warnings));
  }
  std::vector<Mesh> meshes;
  meshes.push_back(read_binary(path.string(), bytes, name, unit, warnings));
  return scene_of(std::move(meshes), std::move(warnings));
}

}  // namespace penumbra
