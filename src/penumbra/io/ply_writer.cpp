#include "penumbra/io/ply_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <string_view>

#include "penumbra/file/output_file.h"

namespace penumbra {
namespace {

constexpr std::size_t chunk = std::size_t{1} << 18;

// A name as a property's: no blanks.
std::string property_name(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }, '_');
  return name;
}

template <class T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

std::string head_of(const PolygonCells& cells, bool coloured, const std::string& comment) {
  std::string head = "ply\nformat binary_little_endian 1.0\n";
  if (!comment.empty()) head += "comment " + comment + "\n";
  head +=
      fmt::format("element vertex {}\nproperty double x\nproperty double y\nproperty double z\n", cells.points.size());
  head += fmt::format("element face {}\nproperty list uint int vertex_indices\n", cells.offsets.size());
  if (coloured) head += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  for (const CellValues& v : cells.values) head += fmt::format("property double {}\n", property_name(v.name));
  return head + "end_header\n";
}

}  // namespace

void write_ply(const std::filesystem::path& path, const PolygonCells& cells, const std::vector<std::uint8_t>& colours,
               const std::string& comment) {
  assert(colours.empty() || colours.size() == 3 * cells.offsets.size());
  OutputFile out(path);
  std::string bytes = head_of(cells, !colours.empty(), comment);
  for (const Vec3d& p : cells.points) {
    for (int k = 0; k < 3; ++k) append(bytes, p[k]);
  }
  std::uint64_t first = 0;
  for (std::size_t f = 0; f < cells.offsets.size(); ++f) {
    append(bytes, static_cast<std::uint32_t>(cells.offsets[f] - first));
    for (; first < cells.offsets[f]; ++first) append(bytes, static_cast<std::int32_t>(cells.corners[first]));
    if (!colours.empty()) bytes.append(reinterpret_cast<const char*>(colours.data() + 3 * f), 3);
    for (const CellValues& v : cells.values) append(bytes, v.values[f]);
    if (bytes.size() < chunk) continue;
    out.write(bytes);
    bytes.clear();
  }
  out.write(bytes);
  out.commit();
}

}  // namespace penumbra
