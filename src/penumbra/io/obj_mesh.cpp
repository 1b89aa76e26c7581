#include "penumbra/io/obj_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>

#include "penumbra/file/file_error.h"
#include "penumbra/io/cutting_work.h"
#include "penumbra/math/polygon.h"
#include "penumbra/math/polygon_pieces.h"

namespace penumbra {
namespace {

using CornerTriangle = std::array<std::uint32_t, 3>;

/// How a polygon is cut into triangles of its corners, and whether it stays a face.
struct Cut {
  std::vector<CornerTriangle> triangles;
  bool stays_whole = true;
};

constexpr double planarity_tolerance = 1e-6;  // of the polygon's size
constexpr std::string_view crossing_sentence = "the outline of the face crosses itself; split it into simple polygons";
constexpr std::size_t most_concave_corners = 8192;

// A convex polygon cut in halves again and again: as many corners as one likes, and no needles from a single corner.
void cut_convex(std::uint32_t first, std::uint32_t last, std::vector<CornerTriangle>& out) {
  if (last - first < 2) return;
  const std::uint32_t middle = first + (last - first) / 2;
  cut_convex(first, middle, out);
  out.push_back({first, middle, last});
  cut_convex(middle, last, out);
}

std::string place_of(const ObjFace& face) { return fmt::format("line {}", face.line); }

// Along the diagonal whose smaller triangle is the larger: a straight angle makes no triangle without area.
std::vector<CornerTriangle> cut_quad(std::span<const Vec3d> p) {
  const auto area = [&](std::size_t a, std::size_t b, std::size_t c) {
    return length_squared(cross(p[b] - p[a], p[c] - p[a]));
  };
  const bool first_diagonal = std::min(area(0, 1, 2), area(0, 2, 3)) >= std::min(area(0, 1, 3), area(1, 2, 3));
  if (first_diagonal) return {{0, 1, 2}, {0, 2, 3}};
  return {{0, 1, 3}, {1, 2, 3}};
}

// The normal of the widest corner, for polygons whose areas cancel; zero when all corners are in one line.
Vec3d widest_normal(std::span<const Vec3d> polygon) {
  Vec3d widest(0);
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const Vec3d across = cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
    if (length_squared(across) > length_squared(widest)) widest = across;
  }
  const double size = length(widest);
  return size > 0 ? widest / size : widest;
}

/// True when two edges properly cross in the projection along `normal`: touching does not count.
bool crosses_itself(std::span<const Vec3d> polygon, const Vec3d& normal) {
  const auto side = [&](const Vec3d& a, const Vec3d& b, const Vec3d& p) { return dot(normal, cross(b - a, p - a)); };
  const double rounding = 1e-12 * polygon_size(polygon) * polygon_size(polygon);
  const auto apart = [rounding](double s, double t) {
    return (s > rounding && t < -rounding) || (s < -rounding && t > rounding);
  };
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d &a = polygon[i], &b = polygon[(i + 1) % n];
    for (std::size_t k = i + 1; k < n; ++k) {
      const Vec3d &c = polygon[k], &d = polygon[(k + 1) % n];
      if (apart(side(a, b, c), side(a, b, d)) && apart(side(c, d, a), side(c, d, b))) return true;
    }
  }
  return false;
}

/// Makes meshes from the faces of one model, part after part.
class MeshMaker {
 public:
  MeshMaker(const ObjModel& model, const std::string& path, WarningTally& warnings)
      : model_(model), path_(path), warnings_(warnings), vertex_of_position_(model.positions.size(), ObjCorner::none) {}

  Mesh make(const std::string& name, std::span<const std::uint32_t> faces) {
    begin(name, faces);
    for (const std::uint32_t f : faces) add_face(f);
    finish();
    return std::move(mesh_);
  }

 private:
  /// A vertex of the mesh by what it was made of; those of one position are chained.
  struct Vertex {
    std::uint32_t position;
    std::uint32_t uv;
    std::uint64_t normal;  ///< beyond the file's normals: 2^32 + the face whose own normal it has
    std::uint32_t next;
  };

  void begin(const std::string& name, std::span<const std::uint32_t> faces);
  void add_face(std::uint32_t f);
  Cut cut_of(const ObjFace& face);
  Cut cut_of_polygon(const ObjFace& face);
  void check_cutting(const ObjFace& face);
  void drop_repeated_corners();
  std::uint32_t vertex(const ObjCorner& corner, std::uint32_t face, const Vec3d& face_normal);
  [[nodiscard]] bool has_normal(const ObjCorner& corner) const {
    return corner.normal != ObjCorner::none && model_.normals[corner.normal] != Vec3f(0.0F);
  }
  void append_face(std::span<const std::uint32_t> vertices, std::size_t line);
  void finish();
  [[noreturn]] void fail(const ObjFace& face, std::string_view sentence) const {
    throw FileError(path_, place_of(face), sentence);
  }

  const ObjModel& model_;
  const std::string& path_;
  WarningTally& warnings_;
  std::vector<std::uint32_t> vertex_of_position_;  // the first of its chain
  Mesh mesh_;
  std::vector<Vertex> vertices_;
  bool wants_normals_ = false;
  bool wants_uvs_ = false;
  bool all_triangles_ = true;
  CuttingWork cutting_work_;
  // The face in hand.
  std::vector<ObjCorner> corners_;
  std::vector<Vec3d> polygon_;
  std::vector<std::uint32_t> face_vertices_;
};

void MeshMaker::begin(const std::string& name, std::span<const std::uint32_t> faces) {
  mesh_ = Mesh{};
  mesh_.name = name;
  mesh_.materials.clear();
  mesh_.face_offsets = {0};
  all_triangles_ = true;
  for (const Vertex& v : vertices_) vertex_of_position_[v.position] = ObjCorner::none;
  vertices_.clear();
  wants_normals_ = wants_uvs_ = false;
  for (const std::uint32_t f : faces) {
    const ObjFace& face = model_.faces[f];
    for (std::uint32_t c = 0; c < face.corner_count; ++c) {
      const ObjCorner& corner = model_.corners[face.first_corner + c];
      wants_normals_ = wants_normals_ || has_normal(corner);
      wants_uvs_ = wants_uvs_ || corner.uv != ObjCorner::none;
    }
  }
}

void MeshMaker::add_face(std::uint32_t f) {
  const ObjFace& face = model_.faces[f];
  corners_.clear();
  polygon_.clear();
  for (std::uint32_t c = 0; c < face.corner_count; ++c) {
    corners_.push_back(model_.corners[face.first_corner + c]);
    polygon_.push_back(model_.positions[corners_.back().position]);
  }
  const Cut cut = cut_of(face);
  const Vec3d normal = polygon_normal(polygon_);
  face_vertices_.clear();
  for (const ObjCorner& corner : corners_) face_vertices_.push_back(vertex(corner, f, normal));
  if (cut.stays_whole) append_face(face_vertices_, face.line);
  for (const CornerTriangle& t : cut.triangles) {
    const Mesh::Triangle triangle{face_vertices_[t[0]], face_vertices_[t[1]], face_vertices_[t[2]]};
    if (!cut.stays_whole) append_face(triangle, face.line);
    mesh_.triangles.push_back(triangle);
    mesh_.materials.push_back(face.material);
    mesh_.face_of_triangle.push_back(static_cast<std::uint32_t>(mesh_.face_offsets.size() - 2));
  }
}

Cut MeshMaker::cut_of(const ObjFace& face) {
  if (polygon_.size() > 3) drop_repeated_corners();
  const double size = polygon_size(polygon_);
  if (length(newell_vector(polygon_)) <= 1e-14 * size * size) {
    check_cutting(face);
    // Loops of a figure of eight may cancel.
    if (crosses_itself(polygon_, widest_normal(polygon_))) fail(face, crossing_sentence);
    warnings_.count("faces without area were kept but receive no light", place_of(face));
    Cut fan;
    for (std::uint32_t c = 2; c < polygon_.size(); ++c) fan.triangles.push_back({0, c - 1, c});
    fan.stays_whole = polygon_.size() == 3;  // nothing plane can be said of it
    return fan;
  }
  if (polygon_.size() == 3) return {{{0, 1, 2}}, true};
  return cut_of_polygon(face);
}

Cut MeshMaker::cut_of_polygon(const ObjFace& face) {
  const double size = polygon_size(polygon_);
  const double bend = planarity_error(polygon_);
  Cut cut;
  if (bend > planarity_tolerance * size) {
    cut.stays_whole = false;
    warnings_.count("polygons that are not flat were cut into triangles", place_of(face));
  }
  const bool convex = is_convex(polygon_);
  if (convex && polygon_.size() == 4) {
    cut.triangles = cut_quad(polygon_);
    return cut;
  }
  if (convex && polygon_.size() > 32) {
    cut.triangles.reserve(polygon_.size() - 2);
    cut_convex(0, static_cast<std::uint32_t>(polygon_.size() - 1), cut.triangles);
    return cut;
  }
  check_cutting(face);
  cut.triangles = triangulate_polygon(polygon_);
  // A strongly bent outline may cross itself in one view and not in another: it is not judged.
  if (convex || bend > 1e-2 * size || !is_self_intersecting(polygon_)) return cut;
  const Vec3d normal = polygon_normal(polygon_);
  const bool turns_back = std::ranges::any_of(cut.triangles, [&](const CornerTriangle& t) {
    const Vec3d across = cross(polygon_[t[1]] - polygon_[t[0]], polygon_[t[2]] - polygon_[t[0]]);
    return dot(normal, across) < -1e-12 * size * size;
  });
  if (turns_back || crosses_itself(polygon_, normal)) {
    fail(face, crossing_sentence);
  }
  cut.stays_whole = false;
  warnings_.count("polygons whose outline touches itself were cut into triangles", place_of(face));
  return cut;
}

void MeshMaker::check_cutting(const ObjFace& face) {
  if (polygon_.size() > most_concave_corners) {
    fail(face, fmt::format("the concave polygon has {} corners, more than the {} that are cut into triangles; split it",
                           polygon_.size(), most_concave_corners));
  }
  if (!cutting_work_.allows(polygon_.size())) fail(face, "the large concave polygons take too long to cut; split them");
}

// A corner at the place of the one before it adds nothing, as long as a triangle remains.
void MeshMaker::drop_repeated_corners() {
  const std::size_t count = polygon_.size();
  std::size_t kept = 0, left = count;
  for (std::size_t i = 0; i < count; ++i) {
    if (left > 3 && polygon_[i] == polygon_[(i + 1) % count]) {
      --left;
      continue;
    }
    polygon_[kept] = polygon_[i];
    corners_[kept++] = corners_[i];
  }
  polygon_.resize(kept);
  corners_.resize(kept);
}

std::uint32_t MeshMaker::vertex(const ObjCorner& corner, std::uint32_t face, const Vec3d& face_normal) {
  const bool own_normal = has_normal(corner);
  std::uint64_t normal = own_normal ? corner.normal : ObjCorner::none;
  if (wants_normals_ && !own_normal) normal = (std::uint64_t{1} << 32) + face;
  std::uint32_t& first = vertex_of_position_[corner.position];
  for (std::uint32_t v = first; v != ObjCorner::none; v = vertices_[v].next) {
    if (vertices_[v].uv == corner.uv && vertices_[v].normal == normal) return v;
  }
  const auto made = static_cast<std::uint32_t>(vertices_.size());
  vertices_.push_back({corner.position, corner.uv, normal, first});
  first = made;
  mesh_.positions.push_back(model_.positions[corner.position]);
  if (!model_.colours.empty()) mesh_.colours.emplace_back(model_.colours[corner.position], 1.0F);
  if (wants_uvs_) {
    const bool has_uv = corner.uv != ObjCorner::none;
    mesh_.uv[0].push_back(has_uv ? Vec2f(model_.uvs[corner.uv].x, 1.0F - model_.uvs[corner.uv].y) : Vec2f(0.0F));
  }
  if (wants_normals_) {
    const bool has_area = face_normal != Vec3d(0);
    mesh_.normals.push_back(own_normal ? glm::normalize(model_.normals[corner.normal])
                                       : (has_area ? Vec3f(face_normal) : Vec3f(0, 1, 0)));
  }
  return made;
}

void MeshMaker::append_face(std::span<const std::uint32_t> vertices, std::size_t line) {
  mesh_.face_lines.push_back(static_cast<std::uint32_t>(line));
  all_triangles_ = all_triangles_ && vertices.size() == 3;
  mesh_.face_vertices.insert(mesh_.face_vertices.end(), vertices.begin(), vertices.end());
  mesh_.face_offsets.push_back(static_cast<std::uint32_t>(mesh_.face_vertices.size()));
}

void MeshMaker::finish() {
  if (all_triangles_) {
    mesh_.face_offsets.clear();
    mesh_.face_vertices.clear();
    mesh_.face_of_triangle.clear();
  }
  const std::uint32_t first = mesh_.materials.front();
  if (std::ranges::all_of(mesh_.materials, [first](std::uint32_t m) { return m == first; })) mesh_.materials = {first};
}

}  // namespace

std::vector<Mesh> make_obj_meshes(const ObjModel& model, const std::string& path, WarningTally& warnings) {
  std::vector<std::vector<std::uint32_t>> faces_of_part(model.parts.size());
  for (std::uint32_t f = 0; f < model.faces.size(); ++f) faces_of_part[model.faces[f].part].push_back(f);
  MeshMaker maker(model, path, warnings);
  std::vector<Mesh> meshes;
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    if (!faces_of_part[p].empty()) meshes.push_back(maker.make(model.parts[p], faces_of_part[p]));
  }
  return meshes;
}

}  // namespace penumbra
