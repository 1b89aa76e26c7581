#include "penumbra/baking/seam_stitching.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "baking/atlas_scenes.h"
#include "penumbra/baking/chart_map.h"
#include "penumbra/baking/chart_seams.h"
#include "penumbra/scene/shape_mesh.h"

namespace penumbra {
namespace {

/// One channel over an atlas.
struct Light {
  LightmapAtlas atlas;
  Texels texels;
  ChartMap map;
  std::vector<std::uint8_t> covered;
  std::vector<float> values;

  Light(const Scene& scene, const AtlasOptions& options, const std::function<double(std::size_t texel)>& value,
        const LightmapAtlas* made = nullptr)
      : atlas(made != nullptr ? *made : make_lightmap_atlas(scene, options)),
        texels(make_texels(atlas)),
        map(make_chart_map(atlas, texels)),
        covered(map.known),
        values(map.known.size(), 0.0F) {
    for (std::size_t i = 0; i < texels.count(); ++i) values[texels.pixels[i]] = static_cast<float>(value(i));
    dilate(map, values, 1, 1);
  }
  [[nodiscard]] double at(const Vec2d& p) const {
    const double x = p.x - 0.5, y = p.y - 0.5;
    const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
    const double u = x - x0, v = y - y0;
    const auto texel = [&](int px, int py) {
      return static_cast<double>(
          values[map.index(std::clamp(px, 0, map.width - 1), std::clamp(py, 0, map.height - 1))]);
    };
    return (1 - v) * ((1 - u) * texel(x0, y0) + u * texel(x0 + 1, y0)) +
           v * ((1 - u) * texel(x0, y0 + 1) + u * texel(x0 + 1, y0 + 1));
  }
  [[nodiscard]] double largest_step(const std::vector<ChartSeam>& seams) const {
    double largest = 0;
    for (const ChartSeam& seam : seams) {
      for (int i = 0; i <= 200; ++i) {
        const double s = i / 200.0;
        largest = std::max(largest, std::abs(at(glm::mix(seam.one[0], seam.one[1], s)) -
                                             at(glm::mix(seam.other[0], seam.other[1], s))));
      }
    }
    return largest;
  }
  void stitch(const std::vector<ChartSeam>& seams) { stitch_seams(seams, map.width, map.height, covered, values, 1); }
};

/// A square of two materials, hence two charts, cut along a diagonal or down the middle.
Scene cut_square(bool diagonal) {
  Mesh mesh;
  mesh.name = "square";
  if (diagonal) {
    add_rectangle(mesh, Vec3d(0), {1, 0, 0}, {0, 1, 0});
    mesh.materials = {0, 1};
  } else {
    add_rectangle(mesh, Vec3d(0), {0.4, 0, 0}, {0, 1, 0});
    add_rectangle(mesh, {0.4, 0, 0}, {0.6, 0, 0}, {0, 1, 0});
    mesh.materials = {0, 0, 1, 1};
  }
  Scene scene = scene_of({mesh});
  scene.materials.push_back(scene.materials[0]);
  return scene;
}

double smooth_light(const Vec3d& p) { return 2 + std::sin(5 * p.x) * std::cos(4 * p.y) + p.z; }

TEST(SeamStitching, BothPartsOfACutSquareHoldTheSameAtTheCut) {
  for (const bool diagonal : {false, true}) {
    SCOPED_TRACE(diagonal);
    const Scene scene = cut_square(diagonal);
    const LightmapAtlas atlas = make_lightmap_atlas(scene, {.texels_per_metre = 40});
    const Texels texels = make_texels(atlas);
    const auto noisy = [&](std::size_t i) {
      return smooth_light(texels.positions[i]) + 0.1 * std::sin(1e4 * static_cast<double>(texels.pixels[i]));
    };
    Light light(scene, {}, noisy, &atlas);
    const std::vector<ChartSeam> seams = find_seams(light.atlas, 0.35);
    ASSERT_EQ(seams.size(), 1U);
    EXPECT_GT(light.largest_step(seams), 0.03);
    const std::vector<float> before = light.values;
    light.stitch(seams);
    EXPECT_LT(light.largest_step(seams), 1e-4);
    double moved = 0;
    for (std::size_t i = 0; i < before.size(); ++i)
      moved = std::max<double>(moved, std::abs(light.values[i] - before[i]));
    EXPECT_LT(moved, 0.5) << "no texel goes farther than the noise asks";
  }
}

TEST(SeamStitching, SmoothLightIsHardlyChanged) {
  const Scene scene = cut_square(true);
  const LightmapAtlas atlas = make_lightmap_atlas(scene, {.texels_per_metre = 40});
  const Texels texels = make_texels(atlas);
  Light light(
      scene, {}, [&](std::size_t i) { return smooth_light(texels.positions[i]); }, &atlas);
  light.stitch(find_seams(light.atlas, 0.35));
  for (std::size_t i = 0; i < texels.count(); ++i) {
    // A texel is 1/40 m, and the light changes by 5 a metre at most.
    EXPECT_NEAR(light.values[texels.pixels[i]], smooth_light(texels.positions[i]), 0.07);
  }
}

TEST(SeamStitching, ConstantLightStaysAsItIs) {
  const Scene scene = scene_of({unit_sphere_mesh()});
  Light light(scene, {.size = 512}, [](std::size_t) { return 3.25; });
  const std::vector<ChartSeam> seams = find_seams(light.atlas, 0.35);
  EXPECT_GT(seams.size(), 1000U);
  light.stitch(seams);
  for (const std::uint32_t p : light.texels.pixels) ASSERT_NEAR(light.values[p], 3.25, 1e-5);
}

TEST(SeamStitching, FacetsOfASphereMeetMoreCloselyThanBefore) {
  const Scene scene = scene_of({unit_sphere_mesh()});
  const LightmapAtlas atlas = make_lightmap_atlas(scene, {.size = 512});
  const Texels texels = make_texels(atlas);
  Light light(
      scene, {}, [&](std::size_t i) { return std::max(0.0, texels.normal(i).y); }, &atlas);
  const std::vector<ChartSeam> seams = find_seams(light.atlas, 0.35);
  const double before = light.largest_step(seams);
  light.stitch(seams);
  EXPECT_LT(light.largest_step(seams), 0.1 * before);
}

TEST(ChartSeams, CreasesAndWallsHaveNone) {
  const LightmapAtlas box = make_lightmap_atlas(scene_of({inside_of_box({1, 2, 3})}), {.size = 128});
  EXPECT_EQ(find_seams(box, 0.35).size(), 0U);
  EXPECT_EQ(find_seams(box, 1.6).size(), 12U) << "every edge of the box turns by a right angle";
  // A wall on the seam of a floor of two objects: the light of one side is not the other's.
  Mesh left, right, wall;
  add_rectangle(left, Vec3d(0), {1, 0, 0}, {0, 1, 0});
  add_rectangle(right, {1, 0, 0}, {1, 0, 0}, {0, 1, 0});
  add_rectangle(wall, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  EXPECT_EQ(find_seams(make_lightmap_atlas(scene_of({left, right}), {.size = 64}), 0.35).size(), 1U);
  EXPECT_EQ(find_seams(make_lightmap_atlas(scene_of({left, right, wall}), {.size = 64}), 0.35).size(), 0U);
}

TEST(ChartSeams, RunTheSameWayOnBothSides) {
  const LightmapAtlas atlas = make_lightmap_atlas(cut_square(true), {.texels_per_metre = 40});
  const Texels texels = make_texels(atlas);
  const std::vector<ChartSeam> seams = find_seams(atlas, 0.35);
  // The places in space of the texels nearest to the ends.
  const auto nearest = [&](const Vec2d& p) {
    std::size_t best = 0;
    double least = 1e9;
    for (std::size_t i = 0; i < texels.count(); ++i) {
      const auto w = static_cast<std::uint32_t>(atlas.width);
      const double d = glm::length(Vec2d(texels.pixels[i] % w + 0.5, texels.pixels[i] / w + 0.5) - p);
      if (d < least) least = d, best = i;
    }
    return texels.positions[best];
  };
  for (std::size_t e = 0; e < 2; ++e) {
    EXPECT_LT(length(nearest(seams[0].one[e]) - nearest(seams[0].other[e])), 0.06);
  }
  EXPECT_GT(length(nearest(seams[0].one[0]) - nearest(seams[0].one[1])), 1.3);
}

TEST(Dilation, KeepsWhatIsKnownAndTakesEachChartsOwn) {
  const Scene scene = scene_of({inside_of_box({1, 2, 3})});
  const LightmapAtlas atlas = make_lightmap_atlas(scene, {.size = 128});
  const Texels texels = make_texels(atlas);
  ChartMap map = make_chart_map(atlas, texels);
  std::vector<float> values(map.known.size(), -1.0F);
  for (const std::uint32_t p : texels.pixels) values[p] = static_cast<float>(map.charts[p] + 1);
  const ChartMap before = map;
  const std::vector<float> bare = values;
  dilate(map, values, 1);
  for (std::size_t p = 0; p < values.size(); ++p) {
    if (before.known[p] != 0) {
      ASSERT_EQ(values[p], bare[p]);
    }
    ASSERT_EQ(map.known[p], 1) << "all is filled";
    ASSERT_EQ(values[p], static_cast<float>(map.charts[p] + 1)) << "from one chart";
  }
  // Within the padding it is the chart's own.
  for (std::uint32_t c = 0; c < atlas.charts.size(); ++c) {
    const Chart& box = atlas.charts[c];
    for (int y = box.y - 1; y <= box.y + box.height; ++y) {
      for (int x = box.x - 1; x <= box.x + box.width; ++x) ASSERT_EQ(map.charts[map.index(x, y)], c);
    }
  }
}

TEST(Dilation, BuriedTexelsTakeTheLightOfTheirOwnChart) {
  const Scene scene = scene_of({inside_of_box({1, 2, 3})});
  const LightmapAtlas atlas = make_lightmap_atlas(scene, {.size = 128});
  const Texels texels = make_texels(atlas);
  std::vector<std::uint8_t> buried(texels.count());
  for (std::size_t i = 0; i < buried.size(); ++i) {
    buried[i] = texels.positions[i].x > 0.5 ? 1 : 0;  // one wall wholly
  }
  ChartMap map = make_chart_map(atlas, texels, buried);
  std::vector<float> values(map.known.size(), 0.0F);
  for (std::size_t i = 0; i < texels.count(); ++i) {
    values[texels.pixels[i]] = buried[i] != 0 ? 99.0F : static_cast<float>(map.charts[texels.pixels[i]] + 1);
  }
  dilate(map, values, 1, 0);
  std::size_t lost = 0;
  for (const std::uint32_t p : texels.pixels) {
    if (map.known[p] == 0) {
      ++lost;
    } else {
      ASSERT_EQ(values[p], static_cast<float>(map.charts[p] + 1));
    }
  }
  std::size_t of_that_wall = 0;
  for (std::size_t i = 0; i < texels.count(); ++i) {
    of_that_wall += buried[i] != 0 && std::abs(texels.normal(i).x) > 0.5 ? 1U : 0U;
  }
  EXPECT_EQ(lost, of_that_wall) << "the wall that is buried wholly has none to take";
}

}  // namespace
}  // namespace penumbra
