#include "penumbra/baking/texel_map.h"

#include <algorithm>

#include "penumbra/math/transform.h"
#include "penumbra/parallel/parallel_for.h"

namespace penumbra {
namespace {

/// Every second bit, from the lowest.
std::uint64_t spread_bits(std::uint32_t v) {
  std::uint64_t x = v & 0xffffU;
  x = (x | (x << 8)) & 0x00ff00ffU;
  x = (x | (x << 4)) & 0x0f0f0f0fU;
  x = (x | (x << 2)) & 0x33333333U;
  return (x | (x << 1)) & 0x55555555U;
}

}  // namespace

TexelMap::TexelMap(const LightmapAtlas& atlas, const Texels& texels)
    : atlas_(atlas), texels_(texels), width_(texels.width), height_(texels.height) {
  unfoldings_.resize(atlas.first_triangle.empty() ? 0 : atlas.first_triangle.back());
  for (std::uint32_t i = 0; i + 1 < atlas.first_triangle.size(); ++i) {
    for (std::uint32_t t = atlas.first_triangle[i]; t < atlas.first_triangle[i + 1]; ++t) {
      const Vec2d a = corner(t, 0), b = corner(t, 1) - a, c = corner(t, 2) - a;
      const Vec2f a1(a), b1(b), c1(c);
      unfoldings_[t] = {a1.x, a1.y, b1.x, b1.y, c1.x, c1.y};
    }
  }
  texel_at_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), none);
  for (std::uint32_t t = 0; t < texels.count(); ++t) texel_at_[texels.pixels[t]] = t;
  // One texel beyond, for points that rounding carries over the edge.
  for (std::uint32_t t = 0; t < texels.count(); ++t) {
    const auto w = static_cast<std::uint32_t>(width_);
    const int x = static_cast<int>(texels.pixels[t] % w), y = static_cast<int>(texels.pixels[t] / w);
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (x + dx < 0 || y + dy < 0 || x + dx >= width_ || y + dy >= height_) continue;
        std::uint32_t& other = texel_at_[static_cast<std::size_t>(y + dy) * w + static_cast<std::size_t>(x + dx)];
        if (other == none) other = t;
      }
    }
  }
}

std::uint32_t TexelMap::beside(std::uint32_t texel, int right, int down) const {
  const auto w = static_cast<std::uint32_t>(width_);
  const int x = static_cast<int>(texels_.pixels[texel] % w) + right;
  const int y = static_cast<int>(texels_.pixels[texel] / w) + down;
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return none;
  const std::size_t pixel = static_cast<std::size_t>(y) * w + static_cast<std::size_t>(x);
  const std::uint32_t other = texel_at_[pixel];
  if (other == none || texels_.pixels[other] != pixel || chart(other) != chart(texel)) return none;
  return other;
}

std::uint32_t TexelMap::instance(std::uint32_t triangle) const {
  const auto& first = atlas_.first_triangle;
  return static_cast<std::uint32_t>(std::upper_bound(first.begin(), first.end(), triangle) - first.begin() - 1);
}

std::uint32_t TexelMap::material(std::uint32_t triangle) const {
  const std::uint32_t i = instance(triangle);
  return atlas_.scene.meshes[atlas_.scene.instances[i].mesh].material_of(triangle - atlas_.first_triangle[i]);
}

Vec2d TexelMap::corner(std::uint32_t triangle, int corner) const {
  const std::uint32_t i = instance(triangle);
  const Mesh& mesh = atlas_.scene.meshes[atlas_.scene.instances[i].mesh];
  const auto& vertices = mesh.triangles[triangle - atlas_.first_triangle[i]];
  return Vec2d(mesh.uv[1][vertices[static_cast<std::size_t>(corner)]]) * Vec2d(width_, height_);
}

TexelMap::Steps TexelMap::steps(std::uint32_t triangle) const {
  const std::uint32_t i = instance(triangle);
  const Instance& placed = atlas_.scene.instances[i];
  const Mesh& mesh = atlas_.scene.meshes[placed.mesh];
  const auto& v = mesh.triangles[triangle - atlas_.first_triangle[i]];
  const Vec3d a = transform_point(placed.to_world, mesh.positions[v[0]]);
  const Vec3d e1 = transform_point(placed.to_world, mesh.positions[v[1]]) - a;
  const Vec3d e2 = transform_point(placed.to_world, mesh.positions[v[2]]) - a;
  const Vec2d o = corner(triangle, 0), f1 = corner(triangle, 1) - o, f2 = corner(triangle, 2) - o;
  const double area = f1.x * f2.y - f1.y * f2.x;
  if (!(std::abs(area) > 1e-12)) return {};
  return {(f2.y * e1 - f1.y * e2) / area, (f1.x * e2 - f2.x * e1) / area};
}

std::vector<std::uint32_t> texels_in_blocks(const TexelMap& map) {
  const Texels& texels = map.texels();
  const auto w = static_cast<std::uint32_t>(texels.width);
  std::vector<std::uint64_t> keys(texels.count());
  parallel_for(keys.size(), 4096, [&](std::size_t first, std::size_t last) {
    for (std::size_t t = first; t < last; ++t) {
      const std::uint32_t chart = map.chart(static_cast<std::uint32_t>(t));
      const Chart& c = map.atlas().charts[chart];
      const auto x = static_cast<int>(texels.pixels[t] % w) - c.x, y = static_cast<int>(texels.pixels[t] / w) - c.y;
      keys[t] = (static_cast<std::uint64_t>(chart) << 32) | spread_bits(static_cast<std::uint32_t>(std::max(0, x))) |
                (spread_bits(static_cast<std::uint32_t>(std::max(0, y))) << 1);
    }
  });
  std::vector<std::uint32_t> order(texels.count());
  for (std::uint32_t t = 0; t < order.size(); ++t) order[t] = t;
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return keys[a] != keys[b] ? keys[a] < keys[b] : a < b; });
  return order;
}

}  // namespace penumbra
