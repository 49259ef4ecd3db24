#include "tests/evaluation/walks/agreement.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "wayfuse/proto/random.hpp"

namespace wayfuse {
namespace {

// Half of the variance of each half's errors belongs to the walk, a tenth to the scan, the rest to the half.
TEST(Agreement, IsWhatBothHalvesAreOffByTogether) {
  Random random(11);
  const auto draw = [&](double variance_m2) { return BuildingPoint{std::sqrt(variance_m2) * random.normal(), std::sqrt(variance_m2) * random.normal()}; };
  const auto plus = [](BuildingPoint a, BuildingPoint b) { return BuildingPoint{a.x_m + b.x_m, a.y_m + b.y_m}; };
  Agreement agreement;
  for (int walk = 0; walk < 3000; ++walk) {
    const BuildingPoint of_walk = draw(5.0);
    std::vector<HalvesOfScan> scans;
    for (int i = 0; i < 10; ++i) {
      const BuildingPoint common = plus(of_walk, draw(1.0));
      scans.push_back({PhoneTime(std::chrono::seconds(4 * i)), plus(common, draw(4.0)), plus(common, draw(4.0))});
    }
    agreement.add(scans);
  }
  EXPECT_EQ(agreement.walks, 3000u);
  EXPECT_NEAR(agreement.scan.m2(), 20.0, 0.6);
  EXPECT_NEAR(agreement.scan_shared.m2(), 12.0, 0.6);
  EXPECT_NEAR(agreement.walk.m2(), 11.0, 0.6);
  EXPECT_NEAR(agreement.walk_shared.m2(), 10.2, 0.6);
  EXPECT_NEAR(agreement.lagged[0].m2(), 12.0, 0.6);
  EXPECT_NEAR(agreement.lagged[5].m2(), 10.0, 0.6);
  EXPECT_EQ(agreement.lagged[10].count, 0u) << "40 s: longer than any walk here";
}

TEST(Agreement, FewScansSayNothingOfAWalksMean) {
  Agreement agreement;
  agreement.add({});
  agreement.add(std::vector<HalvesOfScan>(Agreement::kFewestScans - 1, {PhoneTime{}, {1.0, 0.0}, {1.0, 0.0}}));
  EXPECT_EQ(agreement.walks, 1u);
  EXPECT_EQ(agreement.walk.count, 0u);
  EXPECT_EQ(agreement.walk.m2(), 0.0);
  EXPECT_DOUBLE_EQ(agreement.scan_shared.m2(), 1.0);
}

}  // namespace
}  // namespace wayfuse
