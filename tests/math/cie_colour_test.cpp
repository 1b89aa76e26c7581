#include "penumbra/math/cie_colour.h"

#include <gtest/gtest.h>

namespace penumbra {
namespace {

// CIE 15:2004: the white point of D65 for the 2-degree observer. The fit of the matching functions is good to 1 %.
TEST(CieColour, D65HasItsChromaticity) {
  Vec3d sum(0);
  for (double nm = 380.5; nm < 780; nm += 1) sum += illuminant_d65(nm) * cie_matching(nm);
  EXPECT_NEAR(sum.x / (sum.x + sum.y + sum.z), 0.31271, 5e-4);
  EXPECT_NEAR(sum.y / (sum.x + sum.y + sum.z), 0.32902, 5e-4);
}

// Published values of the tables (CIE 1931): the peaks, and the equal-energy integrals, which are alike.
TEST(CieColour, MatchingFunctionsAreThoseOfTheTables) {
  EXPECT_NEAR(cie_matching(555).y, 1.0, 0.01);
  EXPECT_NEAR(cie_matching(600).x, 1.0622, 0.01);
  EXPECT_NEAR(cie_matching(445).z, 1.7826, 0.03);
  EXPECT_NEAR(cie_matching(650).y, 0.107, 0.01);
  Vec3d sum(0);
  for (double nm = 380.5; nm < 780; nm += 1) sum += cie_matching(nm);
  EXPECT_NEAR(sum.y, 106.857, 0.01 * 106.857);
  EXPECT_NEAR(sum.x / sum.y, 1, 0.005);
  EXPECT_NEAR(sum.z / sum.y, 1, 0.005);
}

TEST(CieColour, WhiteIsWhiteAndHoldsThreeWatts) {
  Vec3d seen(0);
  double power = 0;
  for (double nm = 380.25; nm < 780; nm += 0.5) {
    seen += 0.5 * white_radiance(nm) * rec709_matching(nm);
    power += 0.5 * white_radiance(nm);
  }
  for (int band = 0; band < 3; ++band) EXPECT_NEAR(seen[band], 1, 1e-5);
  EXPECT_NEAR(power, 3, 1e-5);
}

TEST(CieColour, NothingIsSeenOutsideTheVisibleRange) {
  for (const double nm : {0.0, 300.0, 379.9, 780.1, 2000.0}) {
    EXPECT_EQ(rec709_matching(nm), Vec3d(0));
    EXPECT_EQ(white_radiance(nm), 0);
  }
}

// The purest red, green and blue lie outside what a screen mixes.
TEST(CieColour, SingleWavelengthsLieOutsideTheGamut) {
  EXPECT_LT(rec709_matching(500).x, 0);
  EXPECT_LT(rec709_matching(620).y, 0);
  EXPECT_GT(rec709_matching(620).x, 0);
  EXPECT_GT(rec709_matching(540).y, 0);
  EXPECT_GT(rec709_matching(450).z, 0);
}

}  // namespace
}  // namespace penumbra
