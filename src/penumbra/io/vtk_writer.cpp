#include "penumbra/io/vtk_writer.h"

#include <fmt/format.h>

#include <cassert>
#include <iterator>

#include "penumbra/file/output_file.h"

namespace penumbra {
namespace {

constexpr int vtk_polygon = 7;
constexpr std::size_t chunk = std::size_t{1} << 18;

// Numbers as text, handed to the file in pieces.
class XmlText {
 public:
  explicit XmlText(OutputFile& out) : out_(out) {}
  ~XmlText() = default;

  template <class... Parts>
  void add(fmt::format_string<Parts...> format, Parts&&... parts) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Parts>(parts)...);
    if (text_.size() >= chunk) flush();
  }
  void flush() {
    out_.write(text_);
    text_.clear();
  }

 private:
  OutputFile& out_;
  std::string text_;
};

std::string xml_escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
  return out;
}

}  // namespace

void write_vtu(const std::filesystem::path& path, const PolygonCells& cells) {
  OutputFile out(path);
  XmlText xml(out);
  xml.add("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\n");
  xml.add("<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", cells.points.size(),
          cells.offsets.size());
  xml.add("<Points>\n<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n");
  for (const Vec3d& p : cells.points) xml.add("{} {} {}\n", p.x, p.y, p.z);
  xml.add("</DataArray>\n</Points>\n<Cells>\n<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">\n");
  for (const std::uint32_t c : cells.corners) xml.add("{}\n", c);
  xml.add("</DataArray>\n<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">\n");
  for (const std::uint64_t o : cells.offsets) xml.add("{}\n", o);
  xml.add("</DataArray>\n<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">\n");
  for (std::size_t k = 0; k < cells.offsets.size(); ++k) xml.add("{}\n", vtk_polygon);
  xml.add("</DataArray>\n</Cells>\n<CellData>\n");
  for (const CellValues& v : cells.values) {
    assert(v.values.size() == cells.offsets.size());
    xml.add("<DataArray type=\"Float64\" Name=\"{}\" format=\"ascii\">\n", xml_escaped(v.name));
    for (const double x : v.values) xml.add("{}\n", x);
    xml.add("</DataArray>\n");
  }
  xml.add("</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
  xml.flush();
  out.commit();
}

}  // namespace penumbra
