#include <gtest/gtest.h>

#include <algorithm>

#include "server/pipeline/tracker.hpp"
#include "tests/locating/plan.hpp"
#include "tests/pipeline/odd_evidence.hpp"

// Whatever is fed, nothing that is not a number is published. The long form: `./run campaign evidence`.
namespace wayfuse {
namespace {

using testing::odd_site;
using testing::run_odd_evidence;
using testing::unsound;

Plan hall() {
  return Plan({"A....B....C",
               "...........",
               "D....E....F"}, 4.0);
}

bool hears_scans(const std::string& name) {
  const auto locator = preset(name)->parts.find("locator");
  return locator->second.name != "none";
}

TEST(HostileEvidence, PublishesNothingUnsound) {
  const auto figures = run_odd_evidence(24000, 20261123);
  EXPECT_EQ(figures.fault, "");
  EXPECT_EQ(figures.inputs, 24000u);
  for (const auto& name : preset_names()) {
    EXPECT_GT(figures.of_preset.contains(name) ? figures.of_preset.at(name) : 0u, 1000u) << name << ": a campaign without positions says nothing";
  }
}

// A speed nobody walks at, for an hour and without another fix: 500 km.
TEST(HostileEvidence, NoTrackLeavesTheWorldThatAMessageCanTell) {
  const auto site = odd_site();
  for (const auto& name : preset_names()) {
    const auto tracker = (*assemble(*preset(name), site))->make_tracker(Random(1), KnownStart{{{5.0, 5.0}, FloorOrdinal{0}}, 1.0, std::nullopt});
    int positions = 0;
    for (int i = 1; i <= 7200; ++i) {
      MotionReport motion;
      motion.time = PhoneTime{from_seconds(0.5 * i)};
      motion.interval = from_seconds(0.5);
      motion.heading_sigma_rad = 0.1;
      motion.steps = 1;
      motion.step_length_m = 70.0;
      tracker->feed(motion);
      const auto position = tracker->position(motion.time);
      if (!position) continue;
      ASSERT_EQ(unsound(*position), "") << name << ", report " << i;
      ++positions;
    }
    EXPECT_GT(positions, 0) << name;
  }
}

TEST(HostileEvidence, OneAccessPointAndThousands) {
  for (const int transmitters : {1, 3000}) {
    auto made = std::make_shared<Site>();
    Random random(3);
    for (int i = 0; i < 30; ++i) {
      ReferencePoint point;
      point.place = {{2.0 * (i % 6), 2.0 * (i / 6)}, FloorOrdinal{0}};
      RssScan scan;
      for (int t = 0; t < transmitters; ++t) {
        scan.readings.push_back({Bssid{static_cast<std::uint64_t>(t) + 1}, -50.0 - 3.0 * (i % 7) - 5.0 * random.uniform(), {}, 0, {}, {}});
      }
      point.scans = {scan};
      made->survey.push_back(point);
    }
    for (const auto& name : preset_names()) {
      const auto factory = assemble(*preset(name), made);
      ASSERT_TRUE(factory) << name;
      const auto tracker = (*factory)->make_tracker(Random(1));
      for (int i = 0; i < 3; ++i) {
        RssScan scan = made->survey[static_cast<std::size_t>(7 * i)].scans[0];
        scan.time = PhoneTime{from_seconds(1.0 + i)};
        tracker->feed(scan);
        const auto position = tracker->position(scan.time);
        // Three distances make a place: of one access point p3 has none.
        ASSERT_EQ(position.has_value(), hears_scans(name) && !(name == "p3" && transmitters == 1)) << name << ", " << transmitters;
        EXPECT_EQ(position ? unsound(*position) : "", "") << name;
      }
    }
  }
}

TEST(HostileEvidence, TheOrderOfReadingsDoesNotMatter) {
  for (const auto& name : preset_names()) {
    const auto factory = *assemble(*preset(name), odd_site());
    const auto one = factory->make_tracker(Random(1)), two = factory->make_tracker(Random(1));
    for (int i = 0; i < 10; ++i) {
      RssScan scan = hall().scan_at({3.0 * i, 4.0}, PhoneTime{from_seconds(1.0 + i)});
      one->feed(scan);
      std::reverse(scan.readings.begin(), scan.readings.end());
      two->feed(scan);
    }
    ASSERT_EQ(one->position(PhoneTime{from_seconds(11)}).has_value(), hears_scans(name)) << name;
    EXPECT_EQ(one->position(PhoneTime{from_seconds(11)}), two->position(PhoneTime{from_seconds(11)})) << name;
  }
}

}  // namespace
}  // namespace wayfuse
