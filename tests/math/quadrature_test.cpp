#include "penumbra/math/quadrature.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "penumbra/math/polygon.h"

namespace penumbra {
namespace {

TEST(Quadrature, GaussIsExactForItsDegreeAndNotBeyond) {
  for (int n = 1; n <= 20; ++n) {
    for (int degree = 0; degree <= 2 * n; ++degree) {
      double sum = 0;
      for (const GaussNode& node : gauss_legendre(n)) sum += node.weight * std::pow(node.x, degree);
      const double want = 1.0 / (degree + 1);
      if (degree < 2 * n) {
        EXPECT_NEAR(sum, want, 1e-15) << n << ' ' << degree;
      } else if (n < 10) {  // beyond, the error sinks below rounding
        EXPECT_GT(std::abs(sum - want), 1e-13) << n;
      }
    }
  }
}

TEST(Quadrature, NodesAreSymmetricAscendingAndInside) {
  for (const int n : {1, 2, 3, 16, 63, 64, 200}) {
    const auto rule = make_gauss_legendre(n);
    ASSERT_EQ(rule.size(), static_cast<std::size_t>(n));
    double sum = 0;
    for (std::size_t k = 0; k < rule.size(); ++k) {
      EXPECT_GT(rule[k].x, k == 0 ? 0 : rule[k - 1].x);
      EXPECT_LT(rule[k].x, 1);
      EXPECT_GT(rule[k].weight, 0);
      EXPECT_NEAR(rule[k].x + rule[rule.size() - 1 - k].x, 1, 1e-15);
      sum += rule[k].weight;
    }
    EXPECT_NEAR(sum, 1, 1e-13);
  }
  EXPECT_THROW((void)make_gauss_legendre(0), std::invalid_argument);
}

TEST(Quadrature, TwoNodesStandWhereTheTextbookPutsThem) {
  EXPECT_NEAR(gauss_legendre(2)[0].x, 0.5 - 0.5 / std::sqrt(3.0), 1e-16);
  EXPECT_NEAR(gauss_legendre(3)[1].weight, 4.0 / 9, 1e-16);
}

/// Integral of x^a y^b over the triangle (0,0), (1,0), (0,1): a! b! / (a + b + 2)!.
double triangle_moment(int a, int b) { return std::tgamma(a + 1) * std::tgamma(b + 1) / std::tgamma(a + b + 3); }

TEST(Quadrature, TriangleRuleIsExactForPolynomials) {
  std::vector<WeightedPoint> rule;
  for (int n = 1; n <= 6; ++n) {
    rule.clear();
    append_triangle_rule({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, n, rule);
    for (int a = 0; a <= 2 * n - 2; ++a) {
      for (int b = 0; a + b <= 2 * n - 2; ++b) {
        double sum = 0;
        for (const WeightedPoint& p : rule) sum += p.weight * std::pow(p.point.x, a) * std::pow(p.point.y, b);
        EXPECT_NEAR(sum, triangle_moment(a, b), 1e-15) << n << ' ' << a << ' ' << b;
      }
    }
  }
}

TEST(Quadrature, PolygonRulesSumToAreaAndCentroid) {
  // Convex, concave (signed weights), tilted.
  const std::vector<Vec3d> shapes[] = {
      {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}},
      {{0, 0, 1}, {3, 0, 2}, {2, 1, 5.0 / 3}, {0, 2, 1}},
      {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 3, 0}, {0, 2, 0}},
      {{0, 0, 0}, {2, 0, 0}, {0.5, 0.5, 0}, {0, 2, 0}},
      {{2, 0, 0}, {0.5, 0.5, 0}, {0, 2, 0}, {0, 0, 0}},
  };
  for (const auto& shape : shapes) {
    std::vector<WeightedPoint> rule;
    polygon_rule(shape, 3, rule);
    double area = 0;
    Vec3d moment(0);
    for (const WeightedPoint& p : rule) {
      area += p.weight;
      moment += p.weight * p.point;
    }
    EXPECT_NEAR(area, polygon_area(shape), 1e-14);
    EXPECT_NEAR(length(moment / area - polygon_centroid(shape)), 0, 1e-14);
  }
}

}  // namespace
}  // namespace penumbra
