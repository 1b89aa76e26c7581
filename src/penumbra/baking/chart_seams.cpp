#include "penumbra/baking/chart_seams.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <tuple>

#include "penumbra/math/transform.h"
#include "penumbra/math/vertex_welder.h"

namespace penumbra {
namespace {

/// One side of an edge: from its lower numbered end to the higher.
struct Side {
  std::uint32_t low = 0, high = 0;  // welded ends
  std::uint32_t triangle = 0;       // of all
  std::uint32_t chart = 0;
  bool upwards = false;           // the triangle's outline runs from low to high
  std::array<Vec2d, 2> texels{};  // of the ends
  std::array<Vec3f, 2> smooth{};  // the mesh's normals there, world; zero when it has none
  Vec3f front{0};                 // unit; zero without an area

  [[nodiscard]] bool same_edge(const Side& s) const { return low == s.low && high == s.high; }
};

/// Edges of all charts, each with its ends welded.
class EdgeSides {
 public:
  explicit EdgeSides(const LightmapAtlas& atlas) : atlas_(atlas), welder_(welded_) {
    const double size = atlas.scene.bounds().diagonal();
    grain_ = size > 0 ? 1e-6 * size : 1;
    for (std::size_t i = 0; i < atlas.scene.instances.size(); ++i) add(i);
    std::ranges::sort(sides_, [](const Side& a, const Side& b) {
      return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
    });
  }
  [[nodiscard]] std::span<const Side> all() const { return sides_; }

 private:
  std::uint32_t number(const Vec3d& p) { return welder_.number(glm::floor(p / grain_ + 0.37)); }

  void add(std::size_t instance) {
    const Instance& placed = atlas_.scene.instances[instance];
    const Mesh& mesh = atlas_.scene.meshes[placed.mesh];
    const Mat3d turn = normal_matrix(placed.to_world);
    const double side = is_mirroring(placed.to_world) ? -1 : 1;
    std::vector<Vec3d> positions;
    std::vector<std::uint32_t> numbers;
    for (const Vec3d& p : mesh.positions) {
      positions.push_back(transform_point(placed.to_world, p));
      numbers.push_back(number(positions.back()));
    }
    const auto unit = [](const Vec3d& v) { return Vec3f(length(v) > 0 ? normalize(v) : Vec3d(0)); };
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const Mesh::Triangle& v = mesh.triangles[t];
      const Vec3d &a = positions[v[0]], &b = positions[v[1]], &c = positions[v[2]];
      Side s;
      s.front = unit(side * cross(b - a, c - a));
      s.triangle = atlas_.first_triangle[instance] + static_cast<std::uint32_t>(t);
      s.chart = atlas_.chart_of_triangle[s.triangle];
      for (std::size_t k = 0; k < 3; ++k) {
        std::array<std::uint32_t, 2> ends{v[k], v[(k + 1) % 3]};
        if (numbers[ends[0]] == numbers[ends[1]]) continue;
        s.upwards = numbers[ends[0]] < numbers[ends[1]];
        if (!s.upwards) std::swap(ends[0], ends[1]);
        s.low = numbers[ends[0]];
        s.high = numbers[ends[1]];
        for (std::size_t e = 0; e < 2; ++e) {
          s.texels[e] = Vec2d(mesh.uv[1][ends[e]]) * Vec2d(atlas_.width, atlas_.height);
          if (!mesh.normals.empty()) s.smooth[e] = unit(turn * Vec3d(mesh.normals[ends[e]]));
        }
        sides_.push_back(s);
      }
    }
  }

  const LightmapAtlas& atlas_;
  double grain_ = 1;
  std::vector<Vec3d> welded_;
  VertexWelder welder_;
  std::vector<Side> sides_;
};

bool is_smooth(const Side& a, const Side& b) {
  constexpr float alike = 0.999F;  // 2.5 degrees
  return glm::dot(a.smooth[0], b.smooth[0]) > alike && glm::dot(a.smooth[1], b.smooth[1]) > alike;
}

/// Whether a face stands on the edge across `front`, as a wall does on a floor.
bool wall_between(std::span<const Side> edge, const Vec3f& front) {
  constexpr float parallel = 0.94F;  // the cosine of 20 degrees
  return std::ranges::any_of(
      edge, [&](const Side& s) { return s.front != Vec3f(0) && std::abs(glm::dot(s.front, front)) < parallel; });
}

}  // namespace

std::vector<ChartSeam> find_seams(const LightmapAtlas& atlas, double crease_angle) {
  constexpr std::size_t crowd = 64;  // faces at one edge; more of them are some accident
  const float least = static_cast<float>(std::cos(crease_angle)) - 1e-6F;
  const EdgeSides edges(atlas);
  const std::span<const Side> sides = edges.all();
  std::vector<ChartSeam> seams;
  for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
    while (last < sides.size() && sides[last].same_edge(sides[first])) ++last;
    const std::span<const Side> edge = sides.subspan(first, std::min(last - first, crowd));
    for (std::size_t i = 0; i < edge.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        const Side &a = edge[k], &b = edge[i];
        if (a.chart == b.chart || a.upwards == b.upwards) continue;
        if (glm::dot(a.front, b.front) < least && !is_smooth(a, b)) continue;
        if (edge.size() > 2 && wall_between(edge, a.front)) continue;
        seams.push_back({a.texels, b.texels});
      }
    }
  }
  return seams;
}

}  // namespace penumbra
