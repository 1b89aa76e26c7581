#include "penumbra/baking/texel_light.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "baking/quad_atlas.h"
#include "penumbra/math/spectrum.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/tracing/shading/fresnel.h"
#include "radiosity/enclosure_table.h"
#include "radiosity/scene_makers.h"
#include "radiosity/shadow_floor.h"

namespace penumbra {
namespace {

using std::numbers::pi;
using test::Quad;

/// The six faces of a box from `lower` to `upper`, seen from inside (or from outside): floor (y low), ceiling, then x
/// low, x high, z low, z high. The first edge of walls runs along the floor, except that it starts at any corner.
std::vector<Quad> box(const Vec3d& l, const Vec3d& u, int texels, bool inwards, std::uint32_t material = 0) {
  const auto p = [&](int x, int y, int z) { return Vec3d(x ? u.x : l.x, y ? u.y : l.y, z ? u.z : l.z); };
  std::vector<Quad> quads = {
      {{p(0, 0, 0), p(0, 0, 1), p(1, 0, 1), p(1, 0, 0)}, material, texels, texels, "floor"},
      {{p(0, 1, 0), p(1, 1, 0), p(1, 1, 1), p(0, 1, 1)}, material, texels, texels, "ceiling"},
      {{p(0, 0, 1), p(0, 0, 0), p(0, 1, 0), p(0, 1, 1)}, material, texels, texels, "x0"},
      {{p(1, 0, 0), p(1, 0, 1), p(1, 1, 1), p(1, 1, 0)}, material, texels, texels, "x1"},
      {{p(0, 0, 0), p(1, 0, 0), p(1, 1, 0), p(0, 1, 0)}, material, texels, texels, "z0"},
      {{p(1, 0, 1), p(0, 0, 1), p(0, 1, 1), p(1, 1, 1)}, material, texels, texels, "z1"},
  };
  if (!inwards) {
    for (Quad& q : quads) std::swap(q.corners[1], q.corners[3]);
  }
  return quads;
}

Scene lit_by(std::vector<Material> materials) {
  Scene scene;
  scene.materials = std::move(materials);
  return scene;
}

void add_point(Scene& scene, const Vec3d& position, float intensity) {
  scene.lights.push_back({.name = "point", .kind = PointLight{.position = position, .intensity = Rgb(intensity)}});
}

struct Baked {
  LightmapAtlas atlas;
  Texels texels;
  TexelLight light;

  /// Green, so that every band is as good as another.
  [[nodiscard]] double at(std::size_t texel) const { return light.irradiance[3 * texel + 1]; }
  [[nodiscard]] double direct(std::size_t texel) const { return light.direct[3 * texel + 1]; }
  [[nodiscard]] std::uint32_t chart(std::size_t texel) const {
    return atlas.chart_of_triangle[texels.triangles[texel]];
  }
  [[nodiscard]] double mean(std::uint32_t of_chart) const {
    double sum = 0, count = 0;
    for (std::size_t t = 0; t < texels.count(); ++t) {
      if (chart(t) == of_chart) sum += at(t), count += 1;
    }
    return sum / count;
  }
  /// At a point of a chart, 0..1 along the first and second edge of its quad, bilinear between texels.
  [[nodiscard]] double lookup(std::uint32_t of_chart, double u, double v) const {
    const Chart& c = atlas.charts[of_chart];
    const double x = std::clamp(u * c.width - 0.5, 0.0, c.width - 1.0);
    const double y = std::clamp((1 - v) * c.height - 0.5, 0.0, c.height - 1.0);
    double sum = 0, weights = 0;
    for (std::size_t t = 0; t < texels.count(); ++t) {
      const auto w = static_cast<std::uint32_t>(texels.width);
      const double dx = std::abs(texels.pixels[t] % w - (c.x + x)), dy = std::abs(texels.pixels[t] / w - (c.y + y));
      if (chart(t) != of_chart || dx >= 1 || dy >= 1) continue;
      sum += (1 - dx) * (1 - dy) * at(t), weights += (1 - dx) * (1 - dy);
    }
    return sum / weights;
  }
};

Baked bake(Scene scene, const std::vector<Quad>& quads, TexelLightOptions options = {}) {
  Baked b;
  b.atlas = test::quad_atlas(std::move(scene), quads);
  b.texels = make_texels(b.atlas);
  b.light = bake_texel_light(b.atlas, b.texels, options);
  return b;
}

/// A cube of 4 m with 10000 lm at its middle, in lux; enclosures.json.
void expect_point_source_room(int texels, double noise, double tolerance) {
  for (const auto& row : test::enclosure_table()["cube_point_source"]["table"]) {
    const double rho = row["rho"];
    if (rho != 0.5 && rho != 0.05 && rho < 0.85) continue;
    Scene scene = lit_by({matt(rho)});
    add_point(scene, Vec3d(2), static_cast<float>(10000 / (4 * pi)));
    const Baked b = bake(std::move(scene), box(Vec3d(0), Vec3d(4), texels, true), {.noise = noise});
    const double mean = row["E_total_mean_lux"];
    double squares = 0, count = 0;
    for (const auto& [place, indirect] : row["E_indirect_point_lux"].items()) {
      const double u = std::stod(place), v = std::stod(place.substr(place.find(',') + 1));
      const double x = 4 * u - 2, y = 4 * v - 2, r2 = 4 + x * x + y * y;
      const double truth = indirect.get<double>() + 10000 / (4 * pi) * 2 / (r2 * std::sqrt(r2));
      // The eight places of the face that are alike, on every face.
      for (std::uint32_t face = 0; face < 6; ++face) {
        for (int k = 0; k < 8; ++k) {
          const double a = k & 1 ? 1 - u : u, c = k & 2 ? 1 - v : v;
          const double error = b.lookup(face, k & 4 ? c : a, k & 4 ? a : c) / truth - 1;
          squares += error * error, count += 1;
        }
      }
    }
    EXPECT_LT(std::sqrt(squares / count), tolerance) << "rho " << rho;
    double all = 0;
    for (std::uint32_t face = 0; face < 6; ++face) all += b.mean(face) / 6;
    EXPECT_NEAR(all / mean, 1, tolerance) << "rho " << rho;
  }
}

TEST(TexelLight, RoomWithAPointSource) { expect_point_source_room(32, 0.01, 0.006); }
TEST(TexelLight, SlowRoomWithAPointSourceAt128Texels) { expect_point_source_room(128, 0.005, 0.005); }

void expect_room_with_a_bright_ceiling(int texels, double noise, double tolerance) {
  for (const auto& row : test::enclosure_table()["unit_cube_room_ceiling_emitter"]["cases"]) {
    const double floor = row["rho_floor"], ceiling = row["rho_ceiling"], walls = row["rho_walls"];
    std::vector<Quad> quads = box(Vec3d(0), Vec3d(1), texels, true, 2);
    quads[0].material = 0, quads[1].material = 1;
    const Baked b = bake(lit_by({matt(floor), matt(ceiling, 1 / pi), matt(walls)}), quads, {.noise = noise});
    const auto& means = row["mean_irradiance"];
    EXPECT_NEAR(b.mean(0) / means["floor"].get<double>(), 1, tolerance);
    EXPECT_NEAR(b.mean(1) / means["ceiling"].get<double>(), 1, tolerance);
    for (std::uint32_t wall = 2; wall < 6; ++wall)
      EXPECT_NEAR(b.mean(wall) / means["wall"].get<double>(), 1, tolerance);
    double squares = 0, count = 0;
    for (const auto& point : row["points"]) {
      const std::string face = point["face"];
      const double u = point["u"], v = point["v"], radiosity = point["B"];
      const double rho = face == "f" ? floor : face == "c" ? ceiling : walls;
      const double truth = (radiosity - (face == "c" ? 1 : 0)) / rho;
      if (face == "w") {
        for (std::uint32_t wall = 2; wall < 6; ++wall) {
          const double error = b.lookup(wall, u, v) / truth - 1;
          squares += error * error, count += 1;
        }
      } else {
        const double error = b.lookup(face == "f" ? 0 : 1, u, v) / truth - 1;
        squares += error * error, count += 1;
      }
    }
    EXPECT_LT(std::sqrt(squares / count), tolerance);
  }
}

TEST(TexelLight, RoomWithABrightCeiling) { expect_room_with_a_bright_ceiling(32, 0.01, 0.007); }
TEST(TexelLight, SlowRoomWithABrightCeilingAt128Texels) { expect_room_with_a_bright_ceiling(128, 0.004, 0.005); }

TEST(TexelLight, FurnaceIsEven) {
  // All faces emit E and reflect rho: the irradiance is E / (1 - rho) everywhere, whatever the shape.
  for (const double rho : {0.3, 0.9}) {
    std::vector<Quad> quads = box(Vec3d(0), {1, 2, 3}, 12, true);
    const std::vector<Quad> block = box({0.3, 0.4, 0.5}, {0.6, 1.4, 1}, 8, false);
    quads.insert(quads.end(), block.begin(), block.end());
    const Baked b = bake(lit_by({matt(rho, 1 / pi)}), quads);
    for (std::size_t t = 0; t < b.texels.count(); ++t) {
      EXPECT_NEAR(b.at(t) * (1 - rho), 1, 0.045) << t;
    }
    for (std::uint32_t c = 0; c < quads.size(); ++c) EXPECT_NEAR(b.mean(c) * (1 - rho), 1, 0.004);
  }
}

TEST(TexelLight, OpenSkyIsExact) {
  Scene scene = lit_by({matt(0.5)});
  scene.environment.emplace().radiance = Rgb(0.25F, 1.0F, 2.0F);
  const Baked b = bake(std::move(scene), {Quad{{Vec3d(0), {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}});
  const std::array<double, 3> radiance{0.25, 1.0, 2.0};
  for (std::size_t t = 0; t < b.texels.count(); ++t) {
    for (std::size_t band = 0; band < 3; ++band) {
      EXPECT_NEAR(b.light.irradiance[3 * t + band], pi * radiance[band], 1e-5);
    }
    EXPECT_EQ(b.at(t), b.at(0));
  }
}

TEST(TexelLight, PenumbraIsExact) {
  // The floor is black, so that nothing comes back to it by way of the blocker.
  constexpr int texels = 64;
  Scene scene = lit_by({matt(0), matt(0, 1 / pi)});
  const auto square = [](double half, double z, bool down) {
    Quad q{{Vec3d(-half, -half, z), {half, -half, z}, {half, half, z}, {-half, half, z}}};
    if (down) std::swap(q.corners[1], q.corners[3]);
    return q;
  };
  std::vector<Quad> quads{square(1, 0, false), square(0.25, 2, true), square(0.2, 0.5, false)};
  quads[0].width = quads[0].height = texels;
  quads[1].material = 1;
  quads[1].width = quads[1].height = quads[2].width = quads[2].height = 4;
  const Baked b = bake(std::move(scene), quads);
  double squares = 0, count = 0, truth_sum = 0;
  for (std::size_t t = 0; t < b.texels.count(); ++t) {
    if (b.chart(t) != 0) continue;
    double truth = 0;
    constexpr int across = 8;
    for (int k = 0; k < across * across; ++k) {
      const Vec3d offset((k % across + 0.5) / across - 0.5, (k / across + 0.5) / across - 0.5, 0);
      truth += shadow_floor::irradiance(b.texels.positions[t] + (2.0 / texels) * offset) / (across * across);
    }
    squares += (b.direct(t) - truth) * (b.direct(t) - truth), count += 1, truth_sum += truth;
    EXPECT_NEAR(b.at(t), b.direct(t), 1e-6);
  }
  EXPECT_LT(std::sqrt(squares / count), 0.002 * truth_sum / count);
}

TEST(TexelLight, NothingLeaksUnderAWall) {
  // Two rooms share a floor and a ceiling of one piece; the wall between is a box 0.1 m thick that stands on it, or a
  // sheet. One room is lit.
  for (const bool thick : {true, false}) {
    for (const int texels : {12, 13, 19}) {  // a wall on texel borders, in their middles, anywhere
      std::vector<Quad> quads = box(Vec3d(0), {4, 2, 2}, texels, true);
      for (const std::uint32_t k : {0U, 1U, 4U, 5U}) quads[k].width = 2 * texels - 1;
      if (thick) {
        for (const Quad& q : box({1.95, 0, 0}, {2.05, 2, 2}, 8, false)) quads.push_back(q);
      } else {
        quads.push_back({{Vec3d(2, 0, 0), {2, 0, 2}, {2, 2, 2}, {2, 2, 0}}});
      }
      Scene scene = lit_by({matt(0.8)});
      add_point(scene, {1, 1, 1}, 10);
      const Baked b = bake(std::move(scene), quads, {.noise = 0.1, .fewest_rays = 16, .most_rays = 64});
      const double texel = 4.0 / (2 * texels - 1);
      for (std::size_t t = 0; t < b.texels.count(); ++t) {
        const double x = b.texels.positions[t].x;
        // A texel that is cut by the wall may be lit.
        if (x > (thick ? 2.05 : 2.0) + texel * 0.75) {
          EXPECT_EQ(b.at(t), 0) << x << ", " << b.texels.positions[t].y << ", chart " << b.chart(t)
                                << (thick ? " box " : " sheet ") << texels << " direct " << b.direct(t);
        } else if (x < (thick ? 1.95 : 2.0) - texel * 0.75) {
          EXPECT_GT(b.at(t), 0.2) << x << " chart " << b.chart(t);
        }
      }
    }
  }
}

TEST(TexelLight, TexelsUnderABlockAreBuried) {
  // A block with a bottom, one without: under both the floor is inside solid matter. Its edges run through texels.
  for (const bool has_bottom : {true, false}) {
    std::vector<Quad> quads = box(Vec3d(0), {2, 2, 2}, 40, true);
    for (const Quad& q : box({0.61, 0, 0.57}, {1.31, 0.5, 1.43}, 12, false)) {
      if (has_bottom || q.name != "floor") quads.push_back(q);
    }
    Scene scene = lit_by({matt(0.5)});
    scene.environment.reset();
    add_point(scene, {0.3, 1.7, 0.4}, 5);
    const Baked b = bake(std::move(scene), quads, {.noise = 0.02});
    double beside = 0;
    for (std::size_t t = 0; t < b.texels.count(); ++t) {
      if (b.chart(t) != 0) continue;
      const Vec3d& p = b.texels.positions[t];
      const double inside = std::min({p.x - 0.61, 1.31 - p.x, p.z - 0.57, 1.43 - p.z});
      // A texel is 0.05 m: one with a point that is free is free.
      if (std::abs(inside - 0.02) > 0.006) {
        EXPECT_EQ(b.light.buried[t] != 0, inside > 0.02) << p.x << ' ' << p.z;
      }
      if (inside < 0 && inside > -0.05) beside = std::max(beside, b.at(t));
    }
    // No dark rim: buried texels next to free ones carry their light.
    for (std::size_t t = 0; t < b.texels.count(); ++t) {
      if (b.chart(t) == 0 && b.light.buried[t] != 0) {
        EXPECT_GT(b.at(t), 0);
        EXPECT_LE(b.at(t), 1.2 * beside);
      }
    }
  }
}

TEST(TexelLight, FlippedFacesHaveTheSameLight) {
  const auto room_with = [](bool flipped) {
    std::vector<Quad> quads = box(Vec3d(0), {2, 2, 2}, 24, true);
    for (const Quad& q : box({0.6, 0.3, 0.6}, {1.2, 0.9, 1.2}, 12, false)) quads.push_back(q);
    if (flipped) {
      for (std::size_t k = 1; k < 6; ++k) std::swap(quads[k].corners[1], quads[k].corners[3]);
    }
    Scene scene = lit_by({matt(0.6)});
    add_point(scene, {1.0, 1.6, 0.4}, 5);
    return bake(std::move(scene), quads, {.noise = 0.005});
  };
  const Baked plain = room_with(false), flipped = room_with(true);
  // The floor and the block face as they did.
  for (const std::uint32_t c : {0U, 6U, 7U, 8U, 9U, 10U, 11U}) {
    EXPECT_NEAR(flipped.mean(c) / plain.mean(c), 1, 0.008) << c;
    double squares = 0, count = 0;
    for (std::size_t t = 0; t < plain.texels.count(); ++t) {
      if (plain.chart(t) != c) continue;
      EXPECT_EQ(flipped.light.buried[t], 0);
      squares += std::pow(flipped.at(t) - plain.at(t), 2), count += 1;
    }
    EXPECT_LT(std::sqrt(squares / count), 0.02 * plain.mean(c)) << c;
  }
}

TEST(TexelLight, BlackBacksBringNothing) {
  // A lit floor under a sheet whose back looks at it: with black backs no light returns.
  std::vector<Quad> quads{{{Vec3d(0), {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}},
                          {{Vec3d(0, 0.5, 0), {0, 0.5, 1}, {1, 0.5, 1}, {1, 0.5, 0}}}};
  Scene scene = lit_by({matt(0.9)});
  add_point(scene, {0.5, 0.25, 0.5}, 1);
  const Baked both = bake(scene, quads), front = bake(scene, quads, {.front_sides_only = true});
  double both_mean = both.mean(0), front_mean = front.mean(0), direct = 0, count = 0;
  for (std::size_t t = 0; t < front.texels.count(); ++t) {
    if (front.chart(t) == 0) direct += front.direct(t), count += 1;
  }
  EXPECT_NEAR(front_mean, direct / count, 1e-6 * front_mean);
  EXPECT_GT(both_mean, 1.1 * front_mean);
}

TEST(TexelLight, EnergyIsKept) {
  // A closed room: what the lamp sends out is what the faces absorb.
  std::vector<Quad> quads = box(Vec3d(0), {3, 2, 4}, 24, true);
  quads[2].material = 1;
  const std::vector<Quad> block = box({0.5, 0, 0.5}, {1.3, 1.2, 1.4}, 12, false);
  quads.insert(quads.end(), block.begin() + 1, block.end());
  quads.push_back({{Vec3d(1, 1.99, 1), {2, 1.99, 1}, {2, 1.99, 2.5}, {1, 1.99, 2.5}}, 2, 16, 16, "lamp"});
  const std::array<double, 3> reflectance{0.7, 0.2, 0.4};
  const Baked b =
      bake(lit_by({matt(reflectance[0]), matt(reflectance[1]), matt(reflectance[2], 5)}), quads, {.noise = 0.005});
  double absorbed = 0;
  for (std::size_t t = 0; t < b.texels.count(); ++t) {
    if (b.light.buried[t] != 0) continue;
    const double share = 1 - reflectance[quads[b.chart(t)].material];
    absorbed += share * b.at(t) * b.texels.footprint(t) * b.texels.footprint(t);
  }
  // The lamp's back absorbs what comes between it and the ceiling: a little, bounded by what the ceiling has there.
  const double emitted = 1.5 * 5 * pi;
  EXPECT_NEAR(absorbed / emitted, 1, 0.006);
}

TEST(TexelLight, WhatMirrorsPassOnIsNotAbsorbed) {
  // A closed room with a perfect mirror and a rough metal that absorbs nothing: matt walls absorb what is sent out.
  std::vector<Quad> quads = box(Vec3d(0), {3, 2, 4}, 20, true);
  quads[3].material = 1, quads[4].material = 2;
  quads.push_back({{Vec3d(1, 1.99, 1), {2, 1.99, 1}, {2, 1.99, 2.5}, {1, 1.99, 2.5}}, 3, 8, 8, "lamp"});
  Material mirror = matt(0), metal;
  mirror.mirror = Rgb(1.0F);
  metal.base_colour = Rgb(1.0F);
  metal.metallic = 1;
  metal.roughness = 0.4F;
  const Baked b = bake(lit_by({matt(0.6), mirror, metal, matt(0, 5)}), quads, {.noise = 0.02});
  EXPECT_NEAR(b.light.energy.absorbed / b.light.energy.emitted, 1, 0.015);
}

TEST(TexelLight, MirrorsBringLight) {
  // A floor beside a perfect mirror is lit as by the lamp and its image.
  Material mirror = matt(0);
  mirror.mirror = Rgb(1.0F);
  const auto lamp_at = [](double x0, double x1) {
    return Quad{{Vec3d(x0, 1, -0.4), {x1, 1, -0.4}, {x1, 1, 0.4}, {x0, 1, 0.4}}, 1, 4, 4, "lamp"};
  };
  const Quad floor{{Vec3d(0.01, 0, -0.5), {0.01, 0, 0.5}, {1.01, 0, 0.5}, {1.01, 0, -0.5}}, 0, 16, 16, "floor"};
  const Quad wall{{Vec3d(0, -5, 5), {0, -5, -5}, {0, 5, -5}, {0, 5, 5}}, 2, 4, 4, "mirror"};
  const Baked mirrored = bake(lit_by({matt(0), matt(0, 1), mirror}), {floor, lamp_at(0.3, 0.8), wall},
                              {.noise = 0.002, .most_rays = 8192});
  const Baked doubled = bake(lit_by({matt(0), matt(0, 1), mirror}), {floor, lamp_at(0.3, 0.8), lamp_at(-0.8, -0.3)});
  double squares = 0, count = 0;
  for (std::size_t t = 0; t < doubled.texels.count(); ++t) {
    if (doubled.chart(t) != 0) continue;
    squares += std::pow(mirrored.at(t) - doubled.at(t), 2), count += 1;
  }
  EXPECT_NEAR(mirrored.mean(0) / doubled.mean(0), 1, 0.002);
  EXPECT_LT(std::sqrt(squares / count), 0.006 * doubled.mean(0));
}

TEST(TexelLight, GlassOfIndexOneChangesNothing) {
  Material glass;
  glass.base_colour = Rgb(1);
  glass.transmission = 1;
  glass.ior = 1;
  glass.roughness = 0;
  glass.specular = 0;
  std::vector<Quad> quads = box(Vec3d(0), Vec3d(1), 16, true);
  quads[1].material = 1;
  const std::vector<Material> materials{matt(0.5), matt(0.5, 1), glass};
  const Baked without = bake(lit_by(materials), quads, {.noise = 0.004});
  quads.push_back({{Vec3d(0, 0.5, 0), {0, 0.5, 1}, {1, 0.5, 1}, {1, 0.5, 0}}, 2, 4, 4, "pane"});
  const Baked with = bake(lit_by(materials), quads, {.noise = 0.004});
  for (std::uint32_t c = 0; c < 6; ++c) EXPECT_NEAR(with.mean(c) / without.mean(c), 1, 0.004) << c;
}

TEST(TexelLight, LampsWithoutABodyShineThroughGlassAsInARender) {
  // A point above a thin pane: at each texel the pane passes (1 - R) / (1 + R) of its colour, R at the angle there.
  Material glass;
  glass.base_colour = Rgb(0.9F);
  glass.transmission = 1;
  glass.thin_walled = true;
  glass.roughness = 0;
  Scene scene = lit_by({matt(0), glass});
  add_point(scene, {0.5, 2, 0.5}, 10);
  const Quad floor{{Vec3d(0), {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}};
  const Quad pane{{Vec3d(-1, 0.5, -1), {-1, 0.5, 2}, {2, 0.5, 2}, {2, 0.5, -1}}, 1, 4, 4, "pane"};
  const Baked open = bake(scene, {floor}), through = bake(scene, {floor, pane});
  const Baked stopped = bake(scene, {floor, pane}, {.opaque_shadows = true});
  for (std::size_t t = 0; t < open.texels.count(); ++t) {
    const Vec3d way = Vec3d(0.5, 2, 0.5) - open.texels.positions[t];
    const double reflected = fresnel_dielectric(way.y / length(way), 1, 1.5).mean();
    const double passed = 0.9 * (1 - reflected) / (1 + reflected);
    std::size_t same = 0;  // the texel of the floor at the same place
    while (length(through.texels.positions[same] - open.texels.positions[t]) > 1e-6) ++same;
    EXPECT_NEAR(through.direct(same) / open.direct(t), passed, 1e-3);
    EXPECT_EQ(stopped.direct(same), 0);
  }
}

TEST(TexelLight, LampsShineThroughHoles) {
  Material hole = matt(0.5);
  hole.alpha_mode = AlphaMode::mask;
  hole.alpha = 0;
  const Quad floor{{Vec3d(0), {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}};
  const Quad lamp{{Vec3d(0.2, 1, 0.2), {0.8, 1, 0.2}, {0.8, 1, 0.8}, {0.2, 1, 0.8}}, 1, 4, 4, "lamp"};
  const Quad sheet{{Vec3d(-1, 0.5, -1), {-1, 0.5, 2}, {2, 0.5, 2}, {2, 0.5, -1}}, 2, 4, 4, "sheet"};
  const std::vector<Material> materials{matt(0), matt(0, 1), hole};
  const Baked open = bake(lit_by({matt(0), matt(0, 1), matt(0.5)}), {floor, lamp});
  const Baked through = bake(lit_by(materials), {floor, lamp, sheet});
  for (std::size_t t = 0; t < open.texels.count(); ++t) {
    if (open.chart(t) == 0) {
      EXPECT_NEAR(through.light.direct[3 * t], open.light.direct[3 * t], 0.01 * open.mean(0));
    }
  }
  EXPECT_NEAR(through.mean(0) / open.mean(0), 1, 0.002);
}

TEST(TexelLight, ErrorIsToldAndAimedAt) {
  std::vector<Quad> quads = box(Vec3d(0), Vec3d(1), 16, true);
  quads[1].material = 1;
  const auto render = [&](TexelLightOptions options) {
    return bake(lit_by({matt(0.7), matt(0.2, 1)}), quads, options);
  };
  const Baked truth = render({.noise = 1e-9, .fewest_rays = 8192, .most_rays = 8192, .seed = 9});
  for (const double noise : {0.03, 0.01}) {
    const Baked b = render({.noise = noise, .fewest_rays = 16});
    double squares = 0, told = 0, count = 0;
    for (std::uint32_t c = 0; c < 6; ++c) {
      double own = 0, of_chart = 0;
      for (std::size_t t = 0; t < b.texels.count(); ++t) {
        if (b.chart(t) != c) continue;
        own += std::pow(b.at(t) / truth.mean(c) - truth.at(t) / truth.mean(c), 2), of_chart += 1;
      }
      EXPECT_LT(std::sqrt(own / of_chart), 1.5 * noise) << c;
      squares += own, count += of_chart;
    }
    told = b.light.noise;
    EXPECT_LT(std::sqrt(squares / count), 1.3 * noise);
    EXPECT_NEAR(std::sqrt(squares / count) / told, 1, 0.5);
  }
}

TEST(TexelLight, ThreadedBitsAreTheSame) {
  std::vector<Quad> quads = box(Vec3d(0), {2, 2, 2}, 20, true);
  for (const Quad& q : box({0.6, 0, 0.6}, {1.2, 0.9, 1.2}, 10, false)) quads.push_back(q);
  quads.push_back({{Vec3d(1, 1.9, 1), {1.4, 1.9, 1}, {1.4, 1.9, 1.4}, {1, 1.9, 1.4}}, 1, 4, 4, "lamp"});
  std::vector<float> first;
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    const Baked b = bake(lit_by({matt(0.5), matt(0.5, 3)}), quads, {.noise = 0.03});
    if (first.empty()) first = b.light.irradiance;
    EXPECT_EQ(b.light.irradiance, first) << threads;
  }
}

TEST(TexelLight, StopsEarly) {
  std::stop_source source;
  source.request_stop();
  TexelLightOptions options;
  options.progress.stop = source.get_token();
  const Baked b = bake(lit_by({matt(0.5, 1)}), box(Vec3d(0), Vec3d(1), 16, true), options);
  EXPECT_TRUE(b.light.partial);
  EXPECT_EQ(b.light.irradiance.size(), 3 * b.texels.count());
}

TEST(TexelLight, RefusesOptionsOutOfRange) {
  const std::vector<Quad> quads = box(Vec3d(0), Vec3d(1), 4, true);
  EXPECT_THROW(bake(lit_by({matt(0.5)}), quads, {.noise = 0}), std::invalid_argument);
  EXPECT_THROW(bake(lit_by({matt(0.5)}), quads, {.fewest_rays = 100}), std::invalid_argument);
  EXPECT_THROW(bake(lit_by({matt(0.5)}), quads, {.fewest_rays = 512, .most_rays = 256}), std::invalid_argument);
}

}  // namespace
}  // namespace penumbra
