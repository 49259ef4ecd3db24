#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <new>

#include "server/pipeline/tracker.hpp"

// Counts what the program allocates while `counting` is set.
namespace {
bool counting = false;
std::size_t allocations = 0;
}  // namespace

#pragma GCC diagnostic ignored "-Wmismatched-new-delete"  // the two below do match
void* operator new(std::size_t size) {
  if (counting) ++allocations;
  if (void* memory = std::malloc(size ? size : 1)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace wayfuse {
namespace {

RssScan scan_at(BuildingPoint point) {
  RssScan scan;
  for (std::uint64_t i = 0; i < 25; ++i) {
    const double away_m = distance_m(point, {8.0 * static_cast<double>(i % 5), 8.0 * static_cast<double>(i / 5)});
    scan.readings.push_back({Bssid{i + 1}, -40.0 - 1.5 * away_m, {}, 2412, {}, {}});
  }
  return scan;
}

const Georeference kHere{{48.0, 11.0}, 0.0};

std::shared_ptr<const TrackerFactory> pipeline(const std::string& name) {
  auto site = std::make_shared<Site>();
  for (int i = 0; i < 400; ++i) {
    ReferencePoint point;
    point.place.point = {2.0 * (i % 20), 2.0 * (i / 20)};
    point.walk = "walk " + std::to_string(i / 20);
    point.scans = {scan_at(point.place.point)};
    point.scans[0].time = PhoneTime{std::chrono::seconds(i)};
    site->survey.push_back(std::move(point));
  }
  site->georeference = kHere;
  return *assemble(*preset(name), site);
}

// 200 s of steps and scans around one place, satellite fixes until `fixes_until_s`; counted is the second half.
std::size_t allocations_of(Tracker& tracker, double fixes_until_s) {
  MotionReport step;
  step.reference = HeadingReference::kTrue;
  step.interval = std::chrono::milliseconds(500);
  step.heading_sigma_rad = 0.1;
  step.steps = 1;
  step.step_length_m = 0.7;
  RssScan scan = scan_at({20.0, 20.0});
  for (int k = 0; k < 400; ++k) {
    if (k == 200) counting = true;  // by then every buffer has grown to what it needs
    step.time = PhoneTime{std::chrono::milliseconds(500 * k)};
    step.heading = Heading::from_radians(0.3 * k);
    tracker.feed(step);
    if (k % 6 == 3 && 0.5 * k < fixes_until_s) tracker.feed(GnssFix{step.time, kHere.to_geo({20.0, 20.0}), 5.0, {}, {}});
    if (k % 6 != 0) continue;
    scan.time = step.time;
    tracker.feed(scan);
  }
  counting = false;
  EXPECT_TRUE(tracker.position(step.time)) << "nothing was ever begun";
  return std::exchange(allocations, 0);
}

class SteadyState : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<Tracker> tracker_ = pipeline(GetParam())->make_tracker(Random(1), KnownStart{{{20.0, 20.0}, FloorOrdinal{0}}, 0.5, {}});
};

TEST_P(SteadyState, StepsAndScansAllocateNothing) { EXPECT_EQ(allocations_of(*tracker_, 20.0), 0u); }
TEST_P(SteadyState, NorDoSatelliteFixes) { EXPECT_EQ(allocations_of(*tracker_, INFINITY), 0u); }

INSTANTIATE_TEST_SUITE_P(Presets, SteadyState, testing::ValuesIn(preset_names()), [](const auto& preset) {
  std::string name = preset.param;
  std::ranges::replace(name, '-', '_');
  return name;
});

}  // namespace
}  // namespace wayfuse
