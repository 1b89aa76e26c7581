#include "penumbra/tracing/shading/fresnel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "penumbra/math/rng.h"
#include "test_paths.h"

namespace penumbra {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double infinity = std::numeric_limits<double>::infinity();

nlohmann::json optics() { return nlohmann::json::parse(std::ifstream(PENUMBRA_TEST_DATA "/optics.json")); }

/// One table of it, by value: a range-for must own what it runs over.
nlohmann::json rows(const char* section, const char* table) {
  nlohmann::json found = optics().at(section).at(table);
  EXPECT_FALSE(found.empty());
  return found;
}

/// Independent tables, to this relative error.
void expect_close(double value, double reference) { EXPECT_NEAR(value, reference, 1e-12 * std::abs(reference)); }

TEST(Fresnel, DielectricMeetsTheTable) {
  for (const auto& row : rows("fresnel_dielectric", "table")) {
    SCOPED_TRACE(row.dump());
    const double cos_theta = std::cos(row["theta_deg"].get<double>() * degree);
    const Polarised r = fresnel_dielectric(cos_theta, row["n1"], row["n2"]);
    expect_close(r.s, row["Rs"]);
    expect_close(r.p, row["Rp"]);
    expect_close(r.mean(), row["R_unpolarised"]);
  }
}

TEST(Fresnel, DielectricHasItsBrewsterAndCriticalAngles) {
  const auto table = optics()["fresnel_dielectric"];
  EXPECT_LT(fresnel_dielectric(std::cos(table["brewster_deg_n1_5"].get<double>() * degree), 1, 1.5).p, 1e-28);
  for (const auto& [key, n] : {std::pair{"critical_deg_n1_5", 1.5}, std::pair{"critical_deg_n1_33", 1.33}}) {
    const double critical = table[key].get<double>() * degree;
    EXPECT_EQ(fresnel_dielectric(std::cos(critical + 1e-9), n, 1).mean(), 1);
    EXPECT_LT(fresnel_dielectric(std::cos(critical - 1e-9), n, 1).mean(), 1);
  }
}

TEST(Fresnel, DielectricIsTheSameFromBothSides) {
  CounterRng rng(1);
  for (int i = 0; i < 1000; ++i) {
    const double n = 1 + 2 * rng.next();
    const double cos_from = rng.next();
    const double cos_to = std::sqrt(1 - (1 - cos_from * cos_from) / (n * n));
    const Polarised entering = fresnel_dielectric(cos_from, 1, n);
    const Polarised leaving = fresnel_dielectric(cos_to, n, 1);
    EXPECT_NEAR(entering.s, leaving.s, 1e-9);
    EXPECT_NEAR(entering.p, leaving.p, 1e-9);
  }
}

/// Reflected and transmitted field amplitudes squared, each by its own formula: the powers sum to 1.
TEST(Fresnel, DielectricReflectionAndTransmissionSumToOne) {
  CounterRng rng(2);
  for (int i = 0; i < 1000; ++i) {
    const double from = 1 + rng.next();
    const double to = 1 + rng.next();
    const double c = rng.next();
    const double sine = std::sqrt(1 - c * c) * from / to;
    if (sine >= 1) continue;
    const double c_to = std::sqrt(1 - sine * sine);
    const double beam = to * c_to / (from * c);  // wider or narrower beyond the interface
    const double ts = 2 * from * c / (from * c + to * c_to);
    const double tp = 2 * from * c / (to * c + from * c_to);
    const Polarised r = fresnel_dielectric(c, from, to);
    EXPECT_NEAR(r.s + beam * ts * ts, 1, 1e-12);
    EXPECT_NEAR(r.p + beam * tp * tp, 1, 1e-12);
  }
}

TEST(Fresnel, ConductorMeetsTheTable) {
  for (const auto& row : rows("fresnel_conductor", "table")) {
    SCOPED_TRACE(row.dump());
    const double cos_theta = std::cos(row["theta_deg"].get<double>() * degree);
    const Polarised r = fresnel_conductor(cos_theta, row["n"], row["k"]);
    expect_close(r.s, row["Rs"]);
    expect_close(r.p, row["Rp"]);
    expect_close(r.mean(), row["R"]);
  }
}

TEST(Fresnel, ConductorWithoutAbsorptionIsADielectric) {
  for (int i = 0; i <= 100; ++i) {
    const double c = i / 100.0;
    for (const double n : {0.7, 1.2, 1.5, 2.4}) {
      const Polarised metal = fresnel_conductor(c, n, 0);
      const Polarised glass = fresnel_dielectric(c, 1, n);
      EXPECT_NEAR(metal.s, glass.s, 1e-12) << c << ' ' << n;
      EXPECT_NEAR(metal.p, glass.p, 1e-12) << c << ' ' << n;
    }
  }
}

TEST(Fresnel, SchlickMeetsItsEndsAndTheExactLawNearby) {
  const double f0 = normal_reflectance(1, 1.5);
  EXPECT_NEAR(f0, 0.04, 1e-15);
  EXPECT_EQ(fresnel_schlick(1, f0), f0);
  EXPECT_EQ(fresnel_schlick(0, f0), 1);
  EXPECT_NEAR(fresnel_schlick(0, f0, 0.3), 0.3, 1e-15);
  for (int i = 0; i <= 100; ++i) {
    const double c = i / 100.0;
    EXPECT_NEAR(fresnel_schlick(c, f0), fresnel_dielectric(c, 1, 1.5).mean(), 0.04) << c;
  }
}

TEST(Fresnel, DiffuseReflectanceMeetsTheTable) {
  for (const auto& row : rows("fresnel_diffuse", "table")) {
    const double n = row["n"];
    EXPECT_NEAR(fresnel_diffuse_external(n), row["R_external_diffuse"], 1e-12) << n;
    EXPECT_NEAR(fresnel_diffuse_internal(n), row["R_internal_diffuse"], 1e-12) << n;
  }
}

TEST(Fresnel, DiffuseReflectanceOfNoContrastIsNothing) {
  EXPECT_EQ(fresnel_diffuse_external(1), 0);
  EXPECT_EQ(fresnel_diffuse_internal(1), 0);
  EXPECT_GE(fresnel_diffuse_external(1.001), 0);
  EXPECT_LT(fresnel_diffuse_external(1.001), 0.001);
}

TEST(Snell, MeetsTheTable) {
  const auto snell = optics()["snell"];
  for (const auto& row : snell["cases"]) {
    const double from = row["theta_i"].get<double>() * degree;
    const auto beyond = refract({std::sin(from), 0, std::cos(from)}, {0, 0, 1}, row["n1"], row["n2"]);
    ASSERT_TRUE(beyond);
    expect_close(std::atan2(-beyond->x, -beyond->z) / degree, row["theta_t"]);
  }
  const auto shift = snell["slab_lateral_shift"];
  const double from = shift["theta_i"].get<double>() * degree;
  const Vec3d inside = refract({std::sin(from), 0, std::cos(from)}, {0, 0, 1}, 1, shift["n"]).value();
  // Where the ray leaves the plate, off the line it came along.
  const Vec3d exit = inside * (shift["d"].get<double>() / -inside.z);
  expect_close(std::abs(exit.x * std::cos(from) - exit.z * std::sin(from)), shift["shift"]);
}

TEST(Snell, KeepsThePlaneTheLengthAndTheWayBack) {
  CounterRng rng(3);
  for (int i = 0; i < 1000; ++i) {
    const Vec3d n = glm::normalize(Vec3d(rng.next(), rng.next(), rng.next()) - Vec3d(0.5));
    Vec3d w = glm::normalize(Vec3d(rng.next(), rng.next(), rng.next()) - Vec3d(0.5));
    if (glm::dot(w, n) < 0) w = -w;
    const double from = 1 + rng.next();
    const double to = 1 + rng.next();
    const auto beyond = refract(w, n, from, to);
    ASSERT_EQ(!beyond, fresnel_dielectric(glm::dot(w, n), from, to).mean() == 1);
    if (!beyond) continue;
    EXPECT_NEAR(glm::length(*beyond), 1, 1e-14);
    EXPECT_NEAR(glm::dot(glm::cross(w, n), *beyond), 0, 1e-14);
    EXPECT_NEAR(from * glm::length(glm::cross(w, n)), to * glm::length(glm::cross(*beyond, n)), 1e-14);
    const auto back = refract(*beyond, -n, to, from);
    if (back) {
      EXPECT_LT(glm::distance(*back, w), 1e-7);
    }
  }
}

TEST(Plate, MeetsTheTable) {
  for (const auto& row : rows("glass_slab", "table")) {
    const double c = std::cos(row["theta_deg"].get<double>() * degree);
    const PlateShares plate = fresnel_plate(c, row["n"]);
    expect_close(plate.transmittance, row["T_lossless_incoherent_slab"]);
    EXPECT_NEAR(plate.reflectance + plate.transmittance, 1, 1e-14);
    const Polarised r = fresnel_dielectric(c, 1, row["n"]);
    const double first = 0.5 * ((1 - r.s) * (1 - r.s) + (1 - r.p) * (1 - r.p));
    expect_close(first, row["T_first_pass_only"]);
  }
}

/// The series of reflections added bounce by bounce.
TEST(Plate, IsTheSumOfItsBounces) {
  for (const double c : {0.05, 0.3, 0.8, 1.0}) {
    for (const double depth : {0.0, 0.2, 3.0}) {
      const double n = 1.6;
      const Polarised r = fresnel_dielectric(c, 1, n);
      const double t = std::exp(-depth / std::sqrt(1 - (1 - c * c) / (n * n)));
      double reflected = r.mean();
      double transmitted = 0;
      for (const double face : {r.s, r.p}) {
        double inside = 0.5 * (1 - face);
        for (int bounce = 0; bounce < 4000; ++bounce) {
          inside *= t;
          (bounce % 2 == 0 ? transmitted : reflected) += inside * (1 - face);
          inside *= face;
        }
      }
      const PlateShares plate = fresnel_plate(c, n, depth);
      EXPECT_NEAR(plate.reflectance, reflected, 1e-12);
      EXPECT_NEAR(plate.transmittance, transmitted, 1e-12);
    }
  }
}

TEST(Plate, EndsAreRight) {
  EXPECT_EQ(fresnel_plate(0, 1.5).reflectance, 1);
  EXPECT_EQ(fresnel_plate(0, 1.5).transmittance, 0);
  EXPECT_EQ(fresnel_plate(0.7, 1.5, infinity).transmittance, 0);
  EXPECT_NEAR(fresnel_plate(0.7, 1.5, infinity).reflectance, fresnel_dielectric(0.7, 1, 1.5).mean(), 1e-15);
  EXPECT_NEAR(fresnel_plate(0.5, 1, 0.4).transmittance, std::exp(-0.8), 1e-15);
}

TEST(BeerLambert, MeetsTheTable) {
  for (const auto& row : rows("beer_lambert", "cases")) expect_close(beer_lambert(row["sigma"], row["d"]), row["T"]);
}

TEST(BeerLambert, OfAVolumeColourIsThatColourAfterTheDistance) {
  const Rgb colour(0.9F, 0.5F, 0.25F);
  const Rgb once = volume_transmittance(colour, 0.3, 0.3);
  const Rgb twice = volume_transmittance(colour, 0.3, 0.6);
  for (int band = 0; band < 3; ++band) {
    EXPECT_NEAR(once[band], colour[band], 1e-6);
    EXPECT_NEAR(twice[band], colour[band] * colour[band], 1e-6);
  }
}

TEST(BeerLambert, EndsAreRight) {
  EXPECT_EQ(volume_transmittance(Rgb(0.2F), infinity, 1e9), Rgb(1));
  EXPECT_EQ(volume_transmittance(Rgb(0), infinity, 1e9), Rgb(1));
  EXPECT_EQ(volume_transmittance(Rgb(0), 1, 1e-3), Rgb(0));
  EXPECT_EQ(volume_transmittance(Rgb(0), 1, 0), Rgb(1));
  EXPECT_EQ(volume_transmittance(Rgb(1), 1, infinity), Rgb(1));
  EXPECT_EQ(volume_transmittance(Rgb(0.5F), 1, infinity), Rgb(0));
}

}  // namespace
}  // namespace penumbra
