#include "penumbra/baking/texels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/tracing/placed_mesh.h"

namespace penumbra {
namespace {

constexpr double touch = 1e-3;  // texels; coordinates in single precision are off by a tenth of that

using Corners = std::array<Vec2d, 3>;  // in texels

double twice_area(const Corners& t) {
  return (t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[1].y - t[0].y) * (t[2].x - t[0].x);
}

/// Whether the square of the texel, less a thin rim, meets the triangle, by separating axes; lines and points meet it
/// too.
bool meets_texel(const Corners& t, const Vec2d& centre) {
  const double half = 0.5 - touch;
  for (int k = 0; k < 2; ++k) {
    const double lower = std::min({t[0][k], t[1][k], t[2][k]}), upper = std::max({t[0][k], t[1][k], t[2][k]});
    if (lower > centre[k] + half || upper < centre[k] - half) return false;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2d edge = t[(k + 1) % 3] - t[k];
    const Vec2d axis(-edge.y, edge.x);
    const double reach = half * (std::abs(axis.x) + std::abs(axis.y)), middle = glm::dot(centre, axis);
    const double a = glm::dot(t[k], axis), b = glm::dot(t[(k + 2) % 3], axis);
    if (std::min(a, b) > middle + reach || std::max(a, b) < middle - reach) return false;
  }
  return true;
}

/// Weights of corners 1 and 2 at the point of the triangle that is nearest to p.
Vec2d nearest_weights(const Corners& t, const Vec2d& p) {
  const double area = twice_area(t);
  if (area != 0) {
    const Vec2d a = t[1] - t[0], b = t[2] - t[0], q = p - t[0];
    const Vec2d weights((q.x * b.y - q.y * b.x) / area, (a.x * q.y - a.y * q.x) / area);
    if (weights.x >= 0 && weights.y >= 0 && weights.x + weights.y <= 1) return weights;
  }
  double best = std::numeric_limits<double>::infinity();
  Vec2d weights(0);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const Vec2d edge = t[next] - t[k];
    const double size = glm::dot(edge, edge);
    const double s = size > 0 ? std::clamp(glm::dot(p - t[k], edge) / size, 0.0, 1.0) : 0.0;
    const Vec2d away = t[k] + s * edge - p;
    if (glm::dot(away, away) >= best) continue;
    best = glm::dot(away, away);
    std::array<double, 3> w{};
    w[k] = 1 - s;
    w[next] = s;
    weights = {w[1], w[2]};
  }
  return weights;
}

Vec2d at_weights(const Corners& t, const Vec2d& w) { return (1 - w.x - w.y) * t[0] + w.x * t[1] + w.y * t[2]; }

/// Some rows of the atlas, rasterised by themselves.
class Band {
 public:
  Band(const LightmapAtlas& atlas, int first_row, int last_row)
      : atlas_(atlas),
        first_row_(first_row),
        last_row_(last_row),
        owners_(static_cast<std::size_t>(last_row - first_row) * static_cast<std::size_t>(atlas.width)) {}

  /// To be called in order of the triangles' numbers.
  void draw(std::uint32_t triangle, const Corners& t) {
    const auto range = [&](int k, int lower, int upper) {
      const double low = std::min({t[0][k], t[1][k], t[2][k]}), high = std::max({t[0][k], t[1][k], t[2][k]});
      return std::pair(std::clamp(static_cast<int>(std::floor(low)), lower, upper),
                       std::clamp(static_cast<int>(std::floor(high)) + 1, lower, upper));
    };
    const auto [x0, x1] = range(0, 0, atlas_.width);
    const auto [y0, y1] = range(1, first_row_, last_row_);
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) {
        const Vec2d centre(x + 0.5, y + 0.5);
        Owner& owner = owners_[index(x, y)];
        if (owner.distance <= 0 || !meets_texel(t, centre)) continue;
        const auto distance = static_cast<float>(glm::length(at_weights(t, nearest_weights(t, centre)) - centre));
        // A centre on a border is in both, but for rounding.
        const float rounded = distance < touch ? 0 : distance;
        if (rounded < owner.distance) owner = {triangle, rounded};
      }
    }
  }

  /// Those covered, row by row.
  template <class Visit>
  void visit(const Visit& covered) const {
    for (int y = first_row_; y < last_row_; ++y) {
      for (int x = 0; x < atlas_.width; ++x) {
        const Owner& owner = owners_[index(x, y)];
        if (owner.distance < unowned) covered(x, y, owner.triangle);
      }
    }
  }

 private:
  static constexpr float unowned = std::numeric_limits<float>::infinity();
  struct Owner {
    std::uint32_t triangle = 0;
    float distance = unowned;  // texels, from the centre to the triangle
  };
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - first_row_) * static_cast<std::size_t>(atlas_.width) +
           static_cast<std::size_t>(x);
  }

  const LightmapAtlas& atlas_;
  int first_row_, last_row_;
  std::vector<Owner> owners_;
};

/// Turns texels and triangles into points of the scene.
class SurfacePoints {
 public:
  explicit SurfacePoints(const LightmapAtlas& atlas) : atlas_(atlas) {
    for (const Instance& instance : atlas.scene.instances) {
      placed_.emplace_back(atlas.scene.meshes[instance.mesh], instance.to_world, false);
    }
  }

  [[nodiscard]] std::size_t instance_of(std::uint32_t triangle) const {
    const auto& first = atlas_.first_triangle;
    return static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), triangle) - first.begin()) - 1;
  }
  [[nodiscard]] const Mesh& mesh(std::size_t instance) const {
    return atlas_.scene.meshes[atlas_.scene.instances[instance].mesh];
  }
  [[nodiscard]] Corners corners(std::uint32_t triangle) const {
    const std::size_t i = instance_of(triangle);
    const Mesh::Triangle& t = mesh(i).triangles[triangle - atlas_.first_triangle[i]];
    Corners texels;
    for (std::size_t k = 0; k < 3; ++k) {
      texels[k] = Vec2d(mesh(i).uv[1][t[k]]) * Vec2d(atlas_.width, atlas_.height);
    }
    return texels;
  }
  /// Sets what all texels of a triangle share.
  void fill_triangle(Texels& texels, std::uint32_t triangle) const {
    const std::size_t object = instance_of(triangle);
    const std::uint32_t local = triangle - atlas_.first_triangle[object];
    texels.normals_of[triangle] = placed_[object].point(local, Vec2d(1.0 / 3)).geometric_normal;
    texels.footprints_of[triangle] = footprint(object, local, corners(triangle));
  }
  /// Sets the values of texel `i`, whose pixel and triangle are known.
  void fill(Texels& texels, std::size_t i) const {
    const std::uint32_t triangle = texels.triangles[i];
    const std::size_t object = instance_of(triangle);
    const auto width = static_cast<std::uint32_t>(atlas_.width);
    const Vec2d centre(texels.pixels[i] % width + 0.5, texels.pixels[i] / width + 0.5);
    const SurfacePoint point =
        placed_[object].point(triangle - atlas_.first_triangle[object], nearest_weights(corners(triangle), centre));
    texels.positions[i] = point.position;
    if (!texels.interpolated.empty()) texels.interpolated[i] = Vec3f(point.shading_normal);
  }
  [[nodiscard]] bool has_normals() const {
    return std::ranges::any_of(atlas_.scene.instances,
                               [&](const Instance& i) { return !atlas_.scene.meshes[i.mesh].normals.empty(); });
  }

 private:
  [[nodiscard]] double footprint(std::size_t object, std::uint32_t local, const Corners& t) const {
    const Mesh::Triangle& v = mesh(object).triangles[local];
    const Mat4d& to_world = atlas_.scene.instances[object].to_world;
    const auto corner = [&](std::size_t k) { return Vec3d(to_world * Vec4d(mesh(object).positions[v[k]], 1)); };
    const double world = length(cross(corner(1) - corner(0), corner(2) - corner(0))), flat = std::abs(twice_area(t));
    const double usual = atlas_.texels_per_metre > 0 ? 1 / atlas_.texels_per_metre : 0;
    // Slivers have lost theirs to rounding.
    return world > 0 && flat > 1e-3 ? std::sqrt(world / flat) : usual;
  }

  const LightmapAtlas& atlas_;
  std::vector<PlacedMesh> placed_;
};

/// The triangles of each band of rows, in order.
std::vector<std::vector<std::uint32_t>> by_band(const LightmapAtlas& atlas, const SurfacePoints& surface, int rows,
                                                std::size_t bands) {
  std::vector<std::vector<std::uint32_t>> lists(bands);
  for (std::uint32_t t = 0; t < atlas.first_triangle.back(); ++t) {
    const Corners corners = surface.corners(t);
    const auto band = [&](double y) {
      return static_cast<std::size_t>(std::clamp(static_cast<int>(std::floor(y)), 0, atlas.height - 1) / rows);
    };
    const std::size_t last = band(std::max({corners[0].y, corners[1].y, corners[2].y}));
    for (std::size_t b = band(std::min({corners[0].y, corners[1].y, corners[2].y})); b <= last; ++b) {
      lists[b].push_back(t);
    }
  }
  return lists;
}

}  // namespace

Texels make_texels(const LightmapAtlas& atlas) {
  constexpr int rows = 32;
  const SurfacePoints surface(atlas);
  const auto bands = static_cast<std::size_t>((atlas.height + rows - 1) / rows);
  const std::vector<std::vector<std::uint32_t>> lists = by_band(atlas, surface, rows, bands);
  std::vector<std::vector<std::array<std::uint32_t, 2>>> covered(bands);  // pixel and triangle
  parallel_for(bands, 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t b = first; b < last; ++b) {
      const int row = static_cast<int>(b) * rows;
      Band band(atlas, row, std::min(row + rows, atlas.height));
      for (const std::uint32_t t : lists[b]) band.draw(t, surface.corners(t));
      band.visit([&](int x, int y, std::uint32_t triangle) {
        covered[b].push_back(
            {static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(atlas.width) + static_cast<std::uint32_t>(x),
             triangle});
      });
    }
  });

  Texels texels;
  texels.width = atlas.width;
  texels.height = atlas.height;
  std::size_t count = 0;
  for (const auto& band : covered) count += band.size();
  texels.pixels.reserve(count);
  texels.triangles.reserve(count);
  for (auto& band : covered) {
    for (const auto& [pixel, triangle] : band) {
      texels.pixels.push_back(pixel);
      texels.triangles.push_back(triangle);
    }
    band = {};
  }
  texels.positions.resize(count);
  if (surface.has_normals()) texels.interpolated.resize(count);
  texels.normals_of.resize(atlas.first_triangle.back());
  texels.footprints_of.resize(atlas.first_triangle.back());
  parallel_for(texels.normals_of.size(), 1024, [&](std::size_t first, std::size_t last) {
    for (std::size_t t = first; t < last; ++t) surface.fill_triangle(texels, static_cast<std::uint32_t>(t));
  });
  parallel_for(count, 1024, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) surface.fill(texels, i);
  });
  return texels;
}

}  // namespace penumbra
