#include "penumbra/tracing/shading/phase_function.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "test_paths.h"
#include "tracing/soup.h"

namespace penumbra {
namespace {

using std::numbers::pi;

nlohmann::json henyey_greenstein(const char* table) {
  nlohmann::json found = nlohmann::json::parse(std::ifstream(PENUMBRA_TEST_DATA "/participating_media.json"))
                             .at("henyey_greenstein")
                             .at(table);
  EXPECT_FALSE(found.empty());
  return found;
}

TEST(PhaseFunction, ValuesOfTheTable) {
  for (const auto& c : henyey_greenstein("table")) {
    const double p = c["p"];
    EXPECT_NEAR(HenyeyGreenstein(c["g"]).value(c["mu"]), p, 1e-12 * p) << c;
  }
}

TEST(PhaseFunction, InverseOfTheCumulativeDistribution) {
  for (const auto& c : henyey_greenstein("inverse_cdf")) {
    EXPECT_NEAR(HenyeyGreenstein(c["g"]).cosine(c["xi"]), c["mu"].get<double>(), 1e-12) << c;
  }
  for (const double g : {-0.9, -1e-6, 0.0, 1e-7, 1e-4, 0.5}) {
    EXPECT_NEAR(HenyeyGreenstein(g).cosine(0), -1, 1e-9) << g;
    EXPECT_NEAR(HenyeyGreenstein(g).cosine(1), 1, 1e-9) << g;
  }
}

// The moments of the Legendre polynomials are powers of g: 1, g, g^2; by quadrature over the inverse distribution, so
// that value and sampling are held against each other.
TEST(PhaseFunction, MomentsArePowersOfG) {
  for (const double g : {-0.7, -0.3, 0.0, 2e-6, 0.3, 0.76}) {
    const HenyeyGreenstein phase(g);
    double mean = 0, second = 0, whole = 0;
    constexpr int steps = 20000;
    for (int i = 0; i < steps; ++i) {
      const double mu = phase.cosine((i + 0.5) / steps);
      mean += mu / steps;
      second += (1.5 * mu * mu - 0.5) / steps;
      const double x = -1 + 2 * (i + 0.5) / steps;
      whole += 2 * pi * phase.value(x) * 2 / steps;
    }
    EXPECT_NEAR(mean, g, 1e-6) << g;
    EXPECT_NEAR(second, g * g, 1e-6) << g;
    EXPECT_NEAR(whole, 1, 1e-5) << g;
  }
}

TEST(PhaseFunction, DirectionsHaveTheirCosineAndLeanNoOtherWay) {
  testing::Dice dice(3);
  const Vec3d forward = normalize(Vec3d(0.3, -0.5, 0.8));
  Vec3d mean(0);
  constexpr int draws = 40000;
  for (int i = 0; i < draws; ++i) {
    const Vec3d w = HenyeyGreenstein(0.6).sample(forward, dice.square());
    ASSERT_NEAR(length(w), 1, 1e-12);
    mean += w / static_cast<double>(draws);
  }
  EXPECT_NEAR(length(mean - 0.6 * forward), 0, 4 / std::sqrt(double(draws)));
}

}  // namespace
}  // namespace penumbra
