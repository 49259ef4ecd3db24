#include <gtest/gtest.h>

#include <cmath>

#include "tests/papers/experiment.hpp"
#include "tests/papers/radio_world.hpp"

// The orders of the papers' tables that ours keeps, over fewer seeds than `wayfuse-eval papers` runs: they must not turn round.
namespace wayfuse::papers {
namespace {

constexpr int kSeeds = 8;

double figure(const std::vector<Row>& rows, const std::string& situation, const std::string& system, const std::string& figure) {
  for (const Row& row : rows) {
    if (row.claim.situation == situation && row.claim.system == system && row.claim.figure == figure) return row.mean;
  }
  ADD_FAILURE() << "no row " << situation << ", " << system << ", " << figure;
  return NAN;
}

// Judged, with every number its findings speak of among the rows.
std::vector<Row> rows_of(const Experiment& experiment, int seeds, unsigned threads = 1) {
  auto rows = judge(experiment, {.seeds = seeds, .threads = threads});
  EXPECT_EQ(findings(experiment, rows).find('{'), std::string::npos) << findings(experiment, rows);
  return rows;
}

TEST(Papers, P1FusionBeatsBothItsSubsystemsAndTheOthers) {
  const auto rows = rows_of(p1_experiment(), kSeeds);
  const auto rmse = [&](const char* system) { return figure(rows, "office floor", system, "rmse"); };
  EXPECT_LT(rmse("fused"), 0.6 * rmse("WLAN"));
  EXPECT_LT(rmse("fused"), rmse("RADAR"));
  EXPECT_LT(rmse("WLAN"), rmse("propagation model"));
  EXPECT_LT(rmse("propagation model"), rmse("trilateration"));
  EXPECT_LT(rmse("trilateration"), rmse("MARG"));
  EXPECT_EQ(figure(rows, "office floor", "truth", "walls crossed"), 0.0);
}

TEST(Papers, P2CombinationBeatsTheFingerprintAndFromTheSeventhPointOnDeadReckoning) {
  const auto rows = rows_of(p2_experiment(), 40);
  EXPECT_LT(figure(rows, "12 check points", "combined", "mean error"), figure(rows, "12 check points", "fingerprint", "mean error"));
  for (int point = 7; point <= 12; ++point) {
    const std::string at = "check point " + std::to_string(point);
    EXPECT_LT(figure(rows, at, "combined", "error"), figure(rows, at, "PDR", "error")) << at;
  }
}

TEST(Papers, P3LearningTheExponentSavesTheFilter) {
  const auto rows = rows_of(p3_experiment(), 5);
  for (const char* air : {"exponent drifts to 2.34", "exponent jumps to 2.4"}) {
    EXPECT_LT(figure(rows, air, "algorithm 2", "max error"), 0.5 * figure(rows, air, "PF", "max error")) << air;
    EXPECT_LT(figure(rows, air, "PF", "max error"), figure(rows, air, "RSSI alone", "max error")) << air;
    EXPECT_LT(figure(rows, air, "algorithm 2", "max exponent error"), 0.08) << air;  // learnt, not only outlived
  }
  // A blocked node throws the plain filter out of the room.
  EXPECT_LT(figure(rows, "room, one node blocked", "algorithm 2", "max error"), 2.2);
  EXPECT_GT(figure(rows, "room, one node blocked", "PF", "max error"), 5.0);
  for (const char* other : {"0 % perturbed", "80 % perturbed"}) {
    EXPECT_LT(figure(rows, "perturbation sweep", "30 % perturbed", "rmse"), figure(rows, "perturbation sweep", other, "rmse")) << other;
  }
}

TEST(Papers, P4NetworksBeatTheFilterAndTheFilterTheNearestNeighbour) {
  const auto rows = rows_of(p4_experiment(), 4);
  const auto error = [&](const char* system) { return figure(rows, "80 measurements", system, "mean error"); };
  EXPECT_LT(error("Kalman filter and networks"), error("Kalman filter"));
  EXPECT_LT(error("Kalman filter"), error("nearest neighbour"));
}

TEST(Papers, P5FusionBeatsSatellitesByEveryFilter) {
  const auto rows = rows_of(p5_experiment(), kSeeds);
  const auto error = [&](const char* system) { return figure(rows, "canyon", system, "mean error"); };
  for (const char* filter : {"PF, eq. 2", "EKF, eq. 4", "UKF, eq. 4"}) EXPECT_LT(error(filter), 0.5 * error("GNSS")) << filter;
  EXPECT_LT(error("PF, eq. 2"), error("EKF, eq. 4"));
}

TEST(Papers, ARunRepeatsItself) {
  const auto one = rows_of(p2_experiment(), 4), two = rows_of(p2_experiment(), 4, 2);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].mean, two[i].mean);
}

// One claim about what `value` says of each seed.
Row judged(const Claim& claim, double (*value)(std::uint64_t seed)) {
  static double (*drawn)(std::uint64_t);
  drawn = value;
  const auto run = [](const Presets&, std::uint64_t seed) -> std::vector<Outcome> { return {{"case", "system", "figure", drawn(seed)}}; };
  return judge({"P0", "", "", "", {claim}, run, nullptr}, {.seeds = 20}).front();
}
double about_ten(std::uint64_t seed) { return seed % 2 ? 9.0 : 11.0; }
double one(std::uint64_t) { return 1.0; }

TEST(Verdict, IsOpenWhereTheBoundLiesInTheInterval) {
  const auto against = [](double paper) { return judged(reaches("case", "system", "figure", "m", paper), about_ten); };
  EXPECT_EQ(against(10.9).holds, true);
  EXPECT_EQ(against(10.9).verdict(), "holds");
  EXPECT_EQ(against(9.1).holds, false);
  EXPECT_EQ(against(9.1).verdict(), "does not hold");
  for (const double inside : {9.8, 10.2}) {
    EXPECT_EQ(against(inside).holds, std::nullopt) << inside;
    EXPECT_EQ(against(inside).verdict(), "undecided") << inside;
  }
}

TEST(Verdict, OfABaselineSaysWhetherItIsAsGoodAsThePapers) {
  EXPECT_EQ(judged(baseline("case", "system", "figure", "m", 12.0), about_ten).verdict(), "baseline as good");
  EXPECT_EQ(judged(baseline("case", "system", "figure", "m", 8.0), about_ten).verdict(), "baseline worse");
  const Row row = judged(shown("case", "system", "figure", "m"), about_ten);
  EXPECT_EQ(row.verdict(), "");
  EXPECT_EQ(row.holds, std::nullopt);
}

TEST(Verdict, OfAnOrderIsNotWonByATie) {
  EXPECT_EQ(judged(beats("case", "system", "figure", 0.5), one).holds, std::nullopt);
  EXPECT_EQ(judged(beats("case", "system", "figure", 0.5), about_ten).holds, false);
  EXPECT_EQ(judged(reaches("case", "system", "figure", "m", 1.0), one).holds, true);
}

TEST(RadioWorld, FadesAsItsSettingsSay) {
  Random random(1);
  RadioWorld world({.level_at_1m_dbm = -40, .exponent = 3.0, .wall_db = 5.0}, {{0, 0}}, {{{5, -1}, {5, 1}}}, random);
  EXPECT_NEAR(world.mean_dbm(0, {-10, 0}), -70.0, 1e-9);
  EXPECT_NEAR(world.mean_dbm(0, {10, 0}), -75.0, 1e-9);
  world.block(0, 8.0);
  EXPECT_NEAR(world.mean_dbm(0, {-10, 0}), -78.0, 1e-9);
}

}  // namespace
}  // namespace wayfuse::papers
