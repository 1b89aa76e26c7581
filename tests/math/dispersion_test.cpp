#include "penumbra/math/dispersion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "test_paths.h"

namespace penumbra {
namespace {

nlohmann::json optics() { return nlohmann::json::parse(std::ifstream(PENUMBRA_TEST_DATA "/optics_spectrum.json")); }

Sellmeier glass_of(const nlohmann::json& glass) {
  return {glass["B"].get<std::array<double, 3>>(), glass["C_um2"].get<std::array<double, 3>>()};
}

TEST(Dispersion, SellmeierIndicesAndAbbeNumbersAreThoseOfTheCatalogue) {
  const auto table = optics()["sellmeier"];
  for (const auto& [name, glass] : table["glasses"].items()) {
    SCOPED_TRACE(name);
    const Dispersion dispersion = glass_of(glass);
    for (const auto& [line, n] : glass["n"].items()) {
      const double nm = 1000 * table["lines_um"][line].get<double>();
      EXPECT_NEAR(refractive_index(dispersion, nm), n.get<double>(), 1e-12) << line;
    }
    EXPECT_NEAR(abbe_number(dispersion), glass["abbe_Vd"].get<double>(), 1e-8);
  }
}

// Fraunhofer: n = sin((deviation + apex) / 2) / sin(apex / 2), so the deviation follows from the index.
TEST(Dispersion, LeastDeviationOfAPrismOf60Degrees) {
  const auto table = optics()["sellmeier"];
  constexpr double degree = std::numbers::pi / 180;
  for (const auto& [name, glass] : table["glasses"].items()) {
    for (const auto& [line, angle] : glass["prism60_min_deviation_deg"].items()) {
      const double n = refractive_index(glass_of(glass), 1000 * table["lines_um"][line].get<double>());
      const double deviation = 2 * std::asin(n * std::sin(30 * degree)) / degree - 60;
      EXPECT_NEAR(deviation, angle.get<double>(), 1e-9) << name << " " << line;
    }
  }
}

TEST(Dispersion, CauchyOfAnAbbeNumberHasIt) {
  for (const double abbe : {20.0, 36.4, 64.17, 90.0}) {
    for (const double n : {1.33, 1.5168, 1.9}) {
      const Dispersion made = cauchy_of_abbe(n, abbe);
      EXPECT_NEAR(refractive_index(made, line_d), n, 1e-12);
      EXPECT_NEAR(abbe_number(made), abbe, 1e-9 * abbe);
    }
  }
}

TEST(Dispersion, WithoutASpreadTheAbbeNumberIsInfinite) { EXPECT_TRUE(std::isinf(abbe_number(Cauchy{1.5, 0, 0}))); }

TEST(Dispersion, AnIndexIsAtLeastOne) { EXPECT_EQ(refractive_index(Cauchy{0.5, 0, 0}, 500), 1); }

}  // namespace
}  // namespace penumbra
