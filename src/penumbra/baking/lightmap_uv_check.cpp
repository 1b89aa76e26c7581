#include "penumbra/baking/lightmap_uv_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "penumbra/math/transform.h"

namespace penumbra {
namespace {

double twice_area(const UvTriangle& t) {
  return (t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[1].y - t[0].y) * (t[2].x - t[0].x);
}

struct Interval {
  double lower = std::numeric_limits<double>::infinity();
  double upper = -std::numeric_limits<double>::infinity();
};

Interval along(const UvTriangle& t, const Vec2d& axis) {
  Interval range;
  for (const Vec2d& p : t) {
    range.lower = std::min(range.lower, glm::dot(p, axis));
    range.upper = std::max(range.upper, glm::dot(p, axis));
  }
  return range;
}

/// Separating axes: convex shapes overlap as deep as along the normal of the edge where they do least.
bool overlap(const UvTriangle& a, const UvTriangle& b, double tolerance) {
  for (const UvTriangle* t : {&a, &b}) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2d edge = (*t)[(k + 1) % 3] - (*t)[k];
      const Vec2d axis = Vec2d(-edge.y, edge.x) / glm::length(edge);
      const Interval x = along(a, axis), y = along(b, axis);
      if (!(std::min(x.upper, y.upper) - std::max(x.lower, y.lower) > tolerance)) return false;
    }
  }
  return true;
}

/// Squares that list the triangles whose boxes touch them.
class TriangleGrid {
 public:
  TriangleGrid(std::span<const UvTriangle> triangles, std::vector<std::uint32_t> used)
      : triangles_(triangles), used_(std::move(used)) {
    for (const std::uint32_t t : used_) {
      for (const Vec2d& p : triangles_[t]) lower_ = glm::min(lower_, p), upper_ = glm::max(upper_, p);
    }
    cells_ = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(used_.size()))), 1, 4096);
    while (cells_ > 1 && entries() > 8 * used_.size() + 4096) cells_ /= 2;
    fill();
  }

  [[nodiscard]] std::optional<std::array<std::uint32_t, 2>> overlapping_pair(double tolerance) const {
    for (std::size_t c = 0; c + 1 < first_.size(); ++c) {
      for (std::uint32_t i = first_[c]; i < first_[c + 1]; ++i) {
        for (std::uint32_t k = first_[c]; k < i; ++k) {
          const std::uint32_t a = listed_[k], b = listed_[i];
          if (overlap(triangles_[a], triangles_[b], tolerance)) return {{a, b}};
        }
      }
    }
    return std::nullopt;
  }

 private:
  struct Box {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  };
  [[nodiscard]] Box box(std::uint32_t t) const {
    const Vec2d size = glm::max(upper_ - lower_, Vec2d(std::numeric_limits<double>::min()));
    const auto cell = [&](const Vec2d& p) {
      const Vec2d q = (p - lower_) / size * static_cast<double>(cells_);
      return std::array{std::clamp(static_cast<int>(q.x), 0, cells_ - 1),
                        std::clamp(static_cast<int>(q.y), 0, cells_ - 1)};
    };
    const UvTriangle& corners = triangles_[t];
    const auto low = cell(glm::min(corners[0], glm::min(corners[1], corners[2])));
    const auto high = cell(glm::max(corners[0], glm::max(corners[1], corners[2])));
    return {low[0], low[1], high[0], high[1]};
  }
  [[nodiscard]] std::size_t entries() const {
    std::size_t sum = 0;
    for (const std::uint32_t t : used_) {
      const Box b = box(t);
      sum += static_cast<std::size_t>(b.x1 - b.x0 + 1) * static_cast<std::size_t>(b.y1 - b.y0 + 1);
    }
    return sum;
  }
  template <class Visit>
  void for_cells(std::uint32_t t, const Visit& visit) const {
    const Box b = box(t);
    for (int y = b.y0; y <= b.y1; ++y) {
      for (int x = b.x0; x <= b.x1; ++x)
        visit(static_cast<std::size_t>(y) * static_cast<std::size_t>(cells_) + static_cast<std::size_t>(x));
    }
  }
  void fill() {
    const auto count = static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_);
    first_.assign(count + 1, 0);
    for (const std::uint32_t t : used_) for_cells(t, [&](std::size_t c) { ++first_[c + 1]; });
    for (std::size_t c = 0; c < count; ++c) first_[c + 1] += first_[c];
    listed_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (const std::uint32_t t : used_) for_cells(t, [&](std::size_t c) { listed_[next[c]++] = t; });
  }

  std::span<const UvTriangle> triangles_;
  std::vector<std::uint32_t> used_;
  Vec2d lower_{std::numeric_limits<double>::infinity()}, upper_{-std::numeric_limits<double>::infinity()};
  int cells_ = 1;
  std::vector<std::uint32_t> first_, listed_;
};

}  // namespace

std::optional<std::array<std::uint32_t, 2>> find_overlap(std::span<const UvTriangle> triangles, double tolerance) {
  std::vector<std::uint32_t> used;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (twice_area(triangles[t]) != 0) used.push_back(static_cast<std::uint32_t>(t));
  }
  if (used.size() < 2) return std::nullopt;
  return TriangleGrid(triangles, std::move(used)).overlapping_pair(tolerance);
}

std::optional<std::string> lightmap_uv_fault(const Scene& scene) {
  constexpr double rounding = 1e-5;   // beyond 0..1
  constexpr double tolerance = 1e-4;  // of overlaps: a tenth of a texel at 1024
  std::vector<UvTriangle> triangles;
  std::vector<std::uint32_t> instance_of;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const Mesh& mesh = scene.meshes[instance.mesh];
    if (mesh.triangles.empty()) continue;
    if (mesh.uv[1].empty()) return fmt::format("object '{}' has no TEXCOORD_1", instance.name);
    for (const Mesh::Triangle& t : mesh.triangles) {
      UvTriangle uv;
      for (std::size_t k = 0; k < 3; ++k) {
        uv[k] = Vec2d(mesh.uv[1][t[k]]);
        for (const double x : {uv[k].x, uv[k].y}) {
          if (!(x >= -rounding && x <= 1 + rounding)) {
            return fmt::format("TEXCOORD_1 of object '{}' reaches beyond 0..1", instance.name);
          }
        }
      }
      const auto corner = [&](std::size_t k) { return transform_point(instance.to_world, mesh.positions[t[k]]); };
      const Vec3d a = corner(0), b = corner(1), c = corner(2);
      const double longest = std::max({length_squared(b - a), length_squared(c - b), length_squared(a - c)});
      const bool is_flat = !(length(cross(b - a, c - a)) > 1e-12 * longest);
      if (!is_flat && !(std::abs(twice_area(uv)) > 1e-14)) {
        return fmt::format("a triangle of object '{}' has no area in TEXCOORD_1", instance.name);
      }
      triangles.push_back(uv);
      instance_of.push_back(static_cast<std::uint32_t>(i));
    }
  }
  if (triangles.empty()) return "the scene has no triangles";
  if (const auto pair = find_overlap(triangles, tolerance)) {
    return fmt::format("triangles of '{}' and '{}' overlap in TEXCOORD_1",
                       scene.instances[instance_of[(*pair)[0]]].name, scene.instances[instance_of[(*pair)[1]]].name);
  }
  return std::nullopt;
}

}  // namespace penumbra
