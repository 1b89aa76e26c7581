#include "penumbra/baking/atlas_light.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <numbers>

#include "penumbra/baking/atlas_space.h"
#include "penumbra/baking/seam_stitching.h"
#include "penumbra/baking/texel_map.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/scene/texture_lookup.h"
#include "penumbra/tracing/ray_tracer.h"
#include "penumbra/tracing/shading/bsdf.h"
#include "penumbra/tracing/shading/surface_material.h"

namespace penumbra {
namespace {

constexpr int samples_across = 4;  // of a texel whose material varies

/// What turns light that arrives into light that is seen.
struct Paint {
  Rgb albedo{0.0F};
  Rgb emission{0.0F};  // radiance, W/(m^2 sr)
  float alpha = 0;

  void add(const Paint& p, float weight) {
    albedo += weight * p.albedo;
    emission += weight * p.emission;
    alpha += weight * p.alpha;
  }
};

bool lets_see_through(const Scene& scene) {
  return std::ranges::any_of(scene.materials, [](const Material& m) { return m.alpha_mode != AlphaMode::opaque; });
}

/// Materials averaged over texels. Thread-safe.
class TexelPaints {
 public:
  TexelPaints(const LightmapAtlas& atlas, const Texels& texels)
      : scene_(atlas.scene), map_(atlas, texels), tracer_(atlas.scene), space_(map_, tracer_) {}

  [[nodiscard]] Paint at(std::uint32_t texel) const {
    Paint paint;
    float count = 0;
    const std::uint32_t triangle = map_.texels().triangles[texel];
    if (varies(triangle)) {
      for (int k = 0; k < samples_across * samples_across; ++k) {
        const Vec2d offset((k % samples_across + 0.5) / samples_across - 0.5,
                           (k / samples_across + 0.5) / samples_across - 0.5);
        const auto point = space_.at(space_.middle(texel) + offset, map_.chart(texel));
        if (!point) continue;
        paint.add(at_point(*point), 1);
        ++count;
      }
    }
    if (count == 0) return at_point(space_.at(texel));
    Paint mean;
    mean.add(paint, 1 / count);
    return mean;
  }

 private:
  [[nodiscard]] bool varies(std::uint32_t triangle) const {
    const Material& m = scene_.materials[map_.material(triangle)];
    return m.base_colour_texture || m.emission_texture || m.metallic_roughness_texture || m.transmission_texture ||
           m.checker_colour || !scene_.meshes[scene_.instances[map_.instance(triangle)].mesh].colours.empty();
  }

  [[nodiscard]] Paint at_point(const SurfacePoint& point) const {
    SurfaceMaterial surface = surface_material(scene_, point);
    surface.specular = 0;  // the layer over the base is left out
    return {Bsdf(surface, surface.shading, point.geometric_normal).diffuse_reflectance(), surface.emission,
            alpha_at(point)};
  }

  [[nodiscard]] float alpha_at(const SurfacePoint& point) const {
    const Material& m = scene_.materials[point.material];
    if (m.alpha_mode == AlphaMode::opaque) return 1;
    float alpha = m.alpha * point.colour.w;
    if (m.base_colour_texture) {
      alpha *= texture_value(scene_, *m.base_colour_texture, point.uv, TexelEncoding::srgb).w;
    }
    return std::clamp(alpha, 0.0F, 1.0F);
  }

  const Scene& scene_;
  TexelMap map_;
  RayTracer tracer_;
  AtlasSpace space_;
};

/// The paints of some rows of an atlas, and of one more on either side.
class PaintedRows {
 public:
  PaintedRows(const AtlasLight& light, const Texels& texels, const TexelPaints& paints, int first_row, int last_row)
      : light_(light), texels_(texels) {
    const auto width = static_cast<std::uint32_t>(light.map.width);
    const auto at_row = [&](int row) {
      const auto pixel = static_cast<std::uint32_t>(std::clamp(row, 0, light.map.height)) * width;
      return static_cast<std::size_t>(std::ranges::lower_bound(texels.pixels, pixel) - texels.pixels.begin());
    };
    first_ = at_row(first_row - 1);
    last_ = at_row(last_row + 1);
    paints_.reserve(last_ - first_);
    for (std::size_t i = first_; i < last_; ++i) paints_.push_back(paints.at(static_cast<std::uint32_t>(i)));
  }

  /// Beside a chart: the mean of its texels next to the pixel.
  [[nodiscard]] Paint at(int x, int y) const {
    const ChartMap& map = light_.map;
    if (light_.covered[map.index(x, y)] != 0) return of(x, y);
    Paint sum;
    float total = 0;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const int nx = x + dx, ny = y + dy;
        if (nx < 0 || ny < 0 || nx >= map.width || ny >= map.height) continue;
        const std::size_t q = map.index(nx, ny);
        if (light_.covered[q] == 0 || map.charts[q] != map.charts[map.index(x, y)]) continue;
        const float weight = dx == 0 || dy == 0 ? 1.0F : 0.5F;
        sum.add(of(nx, ny), weight);
        total += weight;
      }
    }
    Paint mean;
    if (total > 0) mean.add(sum, 1 / total);
    return mean;
  }

 private:
  [[nodiscard]] const Paint& of(int x, int y) const {
    const auto pixel = static_cast<std::uint32_t>(light_.map.index(x, y));
    const auto begin = texels_.pixels.begin();
    const auto found = std::lower_bound(begin + static_cast<std::ptrdiff_t>(first_),
                                        begin + static_cast<std::ptrdiff_t>(last_), pixel);
    return paints_[static_cast<std::size_t>(found - begin) - first_];
  }

  const AtlasLight& light_;
  const Texels& texels_;
  std::size_t first_ = 0, last_ = 0;
  std::vector<Paint> paints_;
};

}  // namespace

AtlasLight make_atlas_light(const LightmapAtlas& atlas, const Texels& texels, std::span<const float> values,
                            const AtlasLightOptions& options) {
  const std::size_t channels = options.channels.size();
  assert(values.size() == channels * texels.count());
  AtlasLight light{.image = Image(atlas.width, atlas.height, options.channels),
                   .map = make_chart_map(atlas, texels, options.buried),
                   .covered = {}};
  light.covered = light.map.known;
  for (std::size_t i = 0; i < texels.count(); ++i) {
    for (std::size_t c = 0; c < channels; ++c) {
      light.image.data[channels * texels.pixels[i] + c] = values[channels * i + c];
    }
  }
  dilate(light.map, light.image.data, channels, 1);
  if (options.stitch) {
    stitch_seams(find_seams(atlas, options.crease_angle), atlas.width, atlas.height, light.covered, light.image.data,
                 channels, options.lowest);
  }
  return light;
}

void turn_into_radiance(AtlasLight& light, const LightmapAtlas& atlas, const Texels& texels) {
  constexpr std::size_t rows = 16;
  const TexelPaints paints(atlas, texels);
  const bool with_alpha = lets_see_through(atlas.scene);
  Image alpha;
  if (with_alpha) alpha = Image(atlas.width, atlas.height, {"A"});
  parallel_for(static_cast<std::size_t>(atlas.height), rows, [&](std::size_t first, std::size_t last) {
    const PaintedRows painted(light, texels, paints, static_cast<int>(first), static_cast<int>(last));
    for (int y = static_cast<int>(first); y < static_cast<int>(last); ++y) {
      for (int x = 0; x < atlas.width; ++x) {
        if (light.map.known[light.map.index(x, y)] == 0) continue;
        const Paint paint = painted.at(x, y);
        light.image.set_rgb(x, y,
                            paint.emission + paint.albedo * light.image.rgb(x, y) * std::numbers::inv_pi_v<float>);
        if (with_alpha) *alpha.pixel(x, y) = paint.alpha;
      }
    }
  });
  if (!with_alpha) return;
  Image both(atlas.width, atlas.height, {"R", "G", "B", "A"});
  for (std::size_t p = 0; p < alpha.data.size(); ++p) {
    std::copy_n(light.image.data.begin() + static_cast<std::ptrdiff_t>(3 * p), 3,
                both.data.begin() + static_cast<std::ptrdiff_t>(4 * p));
    both.data[4 * p + 3] = alpha.data[p];
  }
  light.image = std::move(both);
}

void fill_gaps(AtlasLight& light) { dilate(light.map, light.image.data, light.image.channels.size()); }

}  // namespace penumbra
