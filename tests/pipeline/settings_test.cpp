#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <variant>

#include "server/pipeline/tracker.hpp"
#include "tests/locating/plan.hpp"

// Every setting in the catalogue is heeded: a walk on which all of them matter is tracked otherwise with one value than with another.
namespace wayfuse {
namespace {

PhoneTime at(double time_s) { return PhoneTime{from_seconds(time_s)}; }

Plan hall(int floor) {
  return Plan({"A....B....C",
               "...........",
               "...........",
               "...........",
               "D....E....F"}, 4.0, floor);
}

// What is heard on `floor`, the other storey through 15 dB of ceiling.
RssScan heard_at(BuildingPoint place, int floor, double time_s) {
  RssScan scan = hall(floor).scan_at(place, at(time_s));
  for (ScanReading reading : hall(1 - floor).scan_at(place).readings) {
    reading.rss_dbm -= 15.0;
    if (reading.rss_dbm > -95.0) scan.readings.push_back(reading);
  }
  return scan;
}

// Two storeys, points and walks along two sides of each and nothing between, levels 3 dB about the law; a wall with a door.
std::shared_ptr<const Site> house() {
  auto site = std::make_shared<Site>();
  Random random(4);
  const auto survey = [&](BuildingPoint place, int floor, std::string walk, double time_s) {
    ReferencePoint point{{place, FloorOrdinal{floor}}, 0.0, "phone", std::move(walk), {}, {heard_at(place, floor, time_s)}};
    for (auto& reading : point.scans[0].readings) reading.rss_dbm += 3.0 * random.normal();
    site->survey.push_back(std::move(point));
  };
  for (int floor = 0; floor < 2; ++floor) {
    for (int i = 0; i < 22; ++i) survey({4.0 * (i % 11), 16.0 * (i / 11)}, floor, "", 0.0);
    for (int walk = 0; walk < 4; ++walk) {
      for (int i = 0; i < 20; ++i) survey({2.0 * i, walk < 2 ? 1.0 * walk : 13.0 + walk}, floor, "walk " + std::to_string(4 * floor + walk), 2.0 * i);
    }
    site->floors.push_back({FloorOrdinal{floor}, std::to_string(floor), {{{{-1, -1}, {41, -1}, {41, 17}, {-1, 17}}}}, {}, {{{20, 6}, {20, 17}}}});
  }
  site->georeference = Georeference{{48.0, 11.0}, 0.0};
  return site;
}

using Evidence = std::variant<MotionReport, RssScan, GnssFix>;

// 40 s along one floor, then 40 s of the other one from elsewhere: the phone was carried off. Readings are up to 6 s old, half of the
// last scan comes again, a few levels are far off, compass and stride err, the phone rests for a while and satellites see it all along.
std::vector<Evidence> day(const Site& site) {
  std::vector<Evidence> evidence;
  Random random(9);
  RssScan last;
  for (int i = 1; i <= 160; ++i) {
    const double time_s = 0.5 * i;
    const int floor = i <= 80 ? 0 : 1;
    const bool rest = i > 40 && i <= 56;
    const double walked_m = 0.6 * (i <= 40 ? i : i <= 56 ? 40 : i <= 80 ? i - 16 : i - 80);
    const BuildingPoint truth = floor == 0 ? BuildingPoint{1.0 + walked_m, 4.0} : BuildingPoint{38.0 - 0.75 * walked_m, 9.0};
    MotionReport motion;
    motion.time = at(time_s);
    motion.interval = from_seconds(0.5);
    motion.reference = HeadingReference::kTrue;
    motion.heading = Heading::from_radians((floor == 0 ? 0.15 : 3.1) + 0.1 * random.normal());
    motion.heading_sigma_rad = 0.1;
    motion.steps = rest ? 0 : 1;
    motion.step_length_m = 0.65;
    motion.distance_sigma_m = i % 2 ? 0.0 : 0.06;
    motion.at_rest = rest;
    evidence.push_back(motion);
    if (i % 8 == 5) evidence.push_back(GnssFix{at(time_s), site.georeference->to_geo({truth.x_m + 2.0 * random.normal(), truth.y_m}), 6.0, {}, {}});
    if (i % 4 != 0) continue;
    RssScan scan = heard_at(truth, floor, time_s);
    for (auto& reading : scan.readings) {
      reading.rss_dbm += (random.below(12) == 0 ? 15.0 : 4.0) * random.normal();
      reading.age = from_seconds(random.below(3) == 0 ? 3.0 + 3.0 * random.uniform() : random.uniform());
    }
    const RssScan fresh = scan;
    for (std::size_t k = 0; k < last.readings.size(); k += 2) {
      scan.readings.push_back(last.readings[k]);
      scan.readings.back().age += from_seconds(2.0);
    }
    last = fresh;
    evidence.push_back(scan);
  }
  return evidence;
}

using Parts = std::map<std::string, PartChoice>;

// A pipeline in which the part has a say.
Parts around(const PartDescription& part) {
  const auto with = [&](Parts parts) {
    parts[part.role] = {part.name, {}};
    return parts;
  };
  const PartChoice kalman{"kalman", {}}, particles{"particle", {{"particles", 200}}}, all_resampled{"particle", {{"particles", 200}, {"resample_below", 1}}};
  const Parts unlearnt = {{"locator", {"radio-field", {{"learn", 0}}}}};
  if (part.name == "walkers") return with(unlearnt);
  if (part.name == "radio-field") return with({{"measurement", {"field", {}}}, {"motion", {"steps", {}}}, {"filter", particles}});
  if (part.name == "field") return with({{"locator", unlearnt.at("locator")}, {"motion", {"steps", {}}}, {"filter", particles}});
  if (part.name == "ranges") return with({{"locator", {"trilateration", {}}}, {"motion", {"steps", {}}}, {"filter", particles}});
  if (part.role == "speed" || part.role == "azimuth" || part.name == "unscented-kalman") {
    Parts parts = {{"locator", {"wknn", {}}}, {"motion", {"street", {}}}, {"filter", {"extended-kalman", {}}}};
    if (part.name != "resolved") parts["speed"] = {"speed", {}}, parts["azimuth"] = {"direction", {}};
    return with(parts);
  }
  if (part.role == "motion" || part.role == "resampler") return with({{"locator", {"wknn", {}}}, {"motion", {"steps", {}}}, {"filter", all_resampled}});
  if (part.role == "corrector") return with({{"locator", {"nn", {}}}, {"motion", {"constant-velocity", {}}}, {"filter", kalman}});
  return with({{"locator", {"wknn", {}}}, {"motion", {"steps", {}}}, {"filter", kalman}});
}

// The ends of a setting's range, unless the two mean the same or cost too much.
std::pair<double, double> two_values(const PartDescription& part, const SettingDescription& setting) {
  static const std::map<std::string, std::pair<double, double>> others = {
      {"fix.gate_sigmas", {0.0, 1.0}},           // 0 and far: every fix counts
      {"street.axis_azimuth_deg", {90.0, 30.0}},  // -360 and 360: the same way
      {"particle.particles", {100, 300}},
      {"walkers.particles", {100, 300}},
      {"back-propagation.iterations", {1, 100}},
  };
  const auto other = others.find(part.name + "." + setting.name);
  return other != others.end() ? other->second : std::pair{setting.least, setting.most};
}

std::vector<std::string> parts_with_settings() {
  std::vector<std::string> names;
  for (const PartDescription& part : part_catalogue()) {
    if (!part.settings.empty()) names.push_back(part.role + " " + part.name);
  }
  return names;
}

class EverySetting : public testing::TestWithParam<std::string> {
 protected:
  static void SetUpTestSuite() {
    site_ = house();
    day_ = day(*site_);
  }
  static void TearDownTestSuite() { site_.reset(), day_.clear(); }

  std::vector<std::optional<FusedPosition>> tracked(const SettingDescription& setting, double value) const {
    Parts parts = around(part_);
    parts[part_.role].settings[setting.name] = value;
    const auto factory = assemble({"test", parts}, site_);
    EXPECT_TRUE(factory) << to_string(factory.fault());
    std::vector<std::optional<FusedPosition>> positions;
    const auto tracker = (*factory)->make_tracker(Random(1));
    for (const Evidence& each : day_) {
      std::visit([&](const auto& evidence) { tracker->feed(evidence), positions.push_back(tracker->position(evidence.time)); }, each);
    }
    return positions;
  }

  static std::shared_ptr<const Site> site_;
  static std::vector<Evidence> day_;
  const std::vector<PartDescription> catalogue_ = part_catalogue();
  const PartDescription& part_ = *std::ranges::find_if(catalogue_, [](const auto& each) { return each.role + " " + each.name == GetParam(); });
};
std::shared_ptr<const Site> EverySetting::site_;
std::vector<Evidence> EverySetting::day_;

TEST_P(EverySetting, ChangesSomething) {
  for (const SettingDescription& setting : part_.settings) {
    const auto [one, other] = two_values(part_, setting);
    const auto a = tracked(setting, one), b = tracked(setting, other);
    EXPECT_TRUE(a != b) << setting.name << " is ignored: " << one << " does what " << other << " does";
    EXPECT_TRUE(std::ranges::any_of(a, [](const auto& position) { return position.has_value(); })) << setting.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EverySetting, testing::ValuesIn(parts_with_settings()), [](const auto& part) {
  std::string name = part.param;
  std::ranges::replace_if(name, [](char c) { return c == '-' || c == ' '; }, '_');
  return name;
});

}  // namespace
}  // namespace wayfuse
