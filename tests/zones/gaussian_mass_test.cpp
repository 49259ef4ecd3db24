#include "server/zones/gaussian_mass.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "wayfuse/proto/random.hpp"

namespace wayfuse {
namespace {

constexpr double kWidened_m2 = 0.01;  // what gaussian_mass adds to each variance

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

Ring box(double x0, double y0, double x1, double y1) { return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}; }

TEST(GaussianMass, EqualsTheProductOfTwoNormalsInABox) {
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    const BuildingPoint mean{20 * random.uniform() - 10, 20 * random.uniform() - 10};
    const Covariance covariance{0.05 + 20 * random.uniform(), 0, 0.05 + 20 * random.uniform()};
    const double sx = std::sqrt(covariance.xx_m2 + kWidened_m2);
    const double sy = std::sqrt(covariance.yy_m2 + kWidened_m2);
    const double expected = (normal_cdf((7 - mean.x_m) / sx) - normal_cdf((-5 - mean.x_m) / sx)) *
                            (normal_cdf((4 - mean.y_m) / sy) - normal_cdf((-3 - mean.y_m) / sy));
    const SignedRing ring{box(-5, -3, 7, 4)};
    EXPECT_NEAR(gaussian_mass(mean, covariance, {&ring, 1}), expected, 1e-5) << mean.x_m << ' ' << mean.y_m;
  }
}

TEST(GaussianMass, EqualsWhatSamplesCountInABentPolygonWithAHole) {
  //  ____
  // |  __|   an L of walls with a pillar in it
  // | |
  const Ring bent{{0, 0}, {4, 0}, {4, 8}, {10, 8}, {10, 12}, {0, 12}};
  const Ring pillar{{1, 5}, {3, 5}, {3, 9}, {1, 9}};
  const std::vector<SignedRing> rings = {{bent, false}, {pillar, true}};
  const Polygon polygon{{bent, pillar}};
  Random random(2);
  for (const BuildingPoint mean : {BuildingPoint{2, 2}, {5, 6}, {2, 7}, {9, 10}, {-3, 4}}) {
    const Covariance covariance{6.0, 2.5, 3.0};
    const double a = std::sqrt(covariance.xx_m2 + kWidened_m2);
    const double b = covariance.xy_m2 / a;
    const double c = std::sqrt(covariance.yy_m2 + kWidened_m2 - b * b);
    int inside = 0;
    constexpr int kSamples = 200'000;
    for (int i = 0; i < kSamples; ++i) {
      const double u = random.normal(), v = random.normal();
      inside += contains(polygon, {mean.x_m + a * u, mean.y_m + b * u + c * v});
    }
    // Standard error of a share: at most 0.5 / sqrt(200,000) = 0.0011.
    EXPECT_NEAR(gaussian_mass(mean, covariance, rings), inside / double{kSamples}, 0.005) << mean.x_m;
  }
}

TEST(GaussianMass, DoesNotCareWhichWayRoundARingIsDrawn) {
  Ring ring = box(0, 0, 5, 5);
  const SignedRing one{ring};
  std::reverse(ring.begin(), ring.end());
  const SignedRing other{ring};
  EXPECT_NEAR(gaussian_mass({1, 2}, {4, 1, 2}, {&one, 1}), gaussian_mass({1, 2}, {4, 1, 2}, {&other, 1}), 1e-8);
}

TEST(GaussianMass, IsSoundAtItsLimits) {
  const SignedRing ring{box(0, 0, 1000, 1000)};
  EXPECT_NEAR(gaussian_mass({500, 500}, {0, 0, 0}, {&ring, 1}), 1.0, 1e-6);
  EXPECT_NEAR(gaussian_mass({0, 500}, {1, 0, 1}, {&ring, 1}), 0.5, 1e-6);      // on an edge
  EXPECT_NEAR(gaussian_mass({0, 0}, {1, 0, 1}, {&ring, 1}), 0.25, 1e-6);       // on a corner
  EXPECT_NEAR(gaussian_mass({-5000, 0}, {1, 0, 1}, {&ring, 1}), 0.0, 1e-9);
  EXPECT_LE(gaussian_mass({3, 3}, {4, 4, 4}, {&ring, 1}), 1.0);                // a line, no ellipse
  EXPECT_NEAR(gaussian_mass({500, 500}, {1e9, 0, 1e9}, {&ring, 1}), 1e6 / (2 * 3.14159265 * 1e9), 1e-5);
}

}  // namespace
}  // namespace wayfuse
