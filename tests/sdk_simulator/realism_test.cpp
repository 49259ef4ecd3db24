#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>

#include "sdk/src/recording/import/import.hpp"
#include "sdk/src/simulator/stand_in_phone.hpp"
#include "tests/evaluation/datasets/split.hpp"
#include "tests/sdk_simulator/walk_statistics.hpp"

// Is a simulated walk like a real one? The same statistics over both, and real walks' published figures where there are none.
namespace wayfuse {
namespace {

namespace fs = std::filesystem;

std::vector<std::vector<RecordedEvent>> simulated_walks(simulator::WorldKind kind) {
  using namespace simulator;
  WorldSettings settings;
  settings.kind = kind;
  Random random(20);
  const World world = make_world(settings, random);
  const Propagation propagation(world, {});
  std::vector<std::vector<RecordedEvent>> walks;
  for (int i = 0; i < 32; ++i) {
    const Walker walker(world, {}, std::chrono::seconds(35), {}, random);
    StandInSettings phone_settings;
    phone_settings.device = draw_device(random);
    StandInPhone phone(world, propagation, walker, phone_settings, random.split());
    std::vector<RecordedEvent> events;
    PhoneTime next_mark = phone.next_time();
    while (auto event = phone.next()) {
      if (time_of(*event) >= next_mark) {
        events.push_back(TruthMark{next_mark, phone.truth(next_mark).place});
        next_mark += std::chrono::seconds(1);
      }
      events.push_back(*std::move(event));
    }
    walks.push_back(std::move(events));
  }
  return walks;
}

/// Every ninth walk that is not a test walk.
std::vector<std::vector<RecordedEvent>> real_walks() {
  const char* data = std::getenv("WAYFUSE_DATA");
  const fs::path site = fs::path(data ? data : "") / "ilc20" / "site1";
  std::vector<fs::path> files;
  if (!data || !fs::is_directory(site)) return {};
  for (const auto& entry : fs::recursive_directory_iterator(site)) {
    const bool trace = entry.path().extension() == ".txt" && entry.path().parent_path().filename() == "path_data_files";
    if (trace && split_of(entry.path().stem().string()) != Split::kTest) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<std::vector<RecordedEvent>> walks;
  for (std::size_t i = 0; i < files.size(); i += 9) {
    auto recording = import_recording("ilc20", files[i].string(), {});
    EXPECT_TRUE(recording) << to_string(recording.fault());
    if (recording) walks.push_back(std::move(recording->events));
  }
  return walks;
}

// Figures of 443 walks through a mall with one phone model, and of a second site [MEASURE: scans are caches].
TEST(Realism, ScansOfAMallAgeAndRepeatAsRealOnesDo) {
  const WalkStatistics mall = statistics_of(simulated_walks(simulator::WorldKind::kMall));
  SCOPED_TRACE(to_string(mall));
  EXPECT_GE(mall.age_median_s, 2.5);
  EXPECT_LE(mall.age_median_s, 5.0);
  EXPECT_NEAR(mall.age_p90_s, 21.0, 3.0);
  EXPECT_GE(mall.same_stamp_share, 0.28);
  EXPECT_LE(mall.same_stamp_share, 0.50);
}

TEST(Realism, SimulatedWalksLookLikeRealOnes) {
  const auto walks = real_walks();
  if (walks.empty()) GTEST_SKIP() << "NO DATA: set WAYFUSE_DATA to the folder of unpacked data sets";
  const WalkStatistics real = statistics_of(walks), mall = statistics_of(simulated_walks(simulator::WorldKind::kMall));
  const std::string both = "real:\n" + to_string(real) + "simulated mall:\n" + to_string(mall);
  SCOPED_TRACE(both);
  if (std::getenv("WAYFUSE_SHOW")) std::cout << both;
  const auto within = [](double simulated, double measured, double factor) {
    return simulated <= measured * factor && simulated >= measured / factor;
  };
  EXPECT_GE(walks.size(), 10u);
  EXPECT_TRUE(within(mall.interval_median_s, real.interval_median_s, 1.2));
  EXPECT_TRUE(within(mall.age_median_s, real.age_median_s, 1.5));
  EXPECT_TRUE(within(mall.age_p90_s, real.age_p90_s, 1.2));
  EXPECT_NEAR(mall.repeated_share, real.repeated_share, 0.08);
  EXPECT_NEAR(mall.same_stamp_share, real.same_stamp_share, 0.08);
  EXPECT_NEAR(mall.rss_p5_dbm, real.rss_p5_dbm, 4.0);
  EXPECT_NEAR(mall.rss_median_dbm, real.rss_median_dbm, 5.0);
  EXPECT_NEAR(mall.rss_p95_dbm, real.rss_p95_dbm, 8.0);
  EXPECT_NEAR(mall.jump_p90_db, real.jump_p90_db, 3.0);
  EXPECT_TRUE(within(mall.cadence_median_hz, real.cadence_median_hz, 1.15));
  EXPECT_TRUE(within(mall.direction_median_deg, real.direction_median_deg, 1.7));
}

}  // namespace
}  // namespace wayfuse
