#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/locating/catalogue.hpp"
#include "server/pipeline/corrector.hpp"
#include "server/pipeline/fusion_tracker.hpp"
#include "server/pipeline/tracker.hpp"
#include "server/tracking/catalogue.hpp"
#include "tests/locating/plan.hpp"

namespace wayfuse {
namespace {

using testing::HasSubstr;

Plan hall() {
  return Plan({"A....B....C",
               "...........",
               "...........",
               "D....E....F"}, 4.0);
}

PhoneTime at(double time_s) { return PhoneTime{from_seconds(time_s)}; }

std::shared_ptr<Site> hall_site() {
  auto site = std::make_shared<Site>();
  site->survey = hall().survey();
  site->georeference = Georeference{{48.0, 11.0}, 0.0};
  return site;
}

PipelineSpec with(std::map<std::string, PartChoice> parts) { return {"test", std::move(parts)}; }

// A walk east with steps, scans and satellite fixes; the mean error of its second half.
double walk_error_m(Tracker& tracker, const Site& site) {
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < 48; ++i) {
    const double time_s = 0.5 * (i + 1);
    const BuildingPoint truth{2.0 + 0.7 * (i + 1), 6.0};
    MotionReport motion;
    motion.time = at(time_s);
    motion.interval = from_seconds(0.5);
    motion.reference = HeadingReference::kTrue;
    motion.heading_sigma_rad = 0.05;
    motion.steps = 1;
    motion.step_length_m = 0.7;
    motion.distance_sigma_m = 0.05;
    tracker.feed(motion);
    if (i % 4 == 1) tracker.feed(GnssFix{at(time_s), site.georeference->to_geo(truth), 3.0, {}, {}});
    if (i % 4 == 3) tracker.feed(hall().scan_at(truth, at(time_s)));
    const auto position = tracker.position(at(time_s));
    if (i < 24 || !position) continue;
    sum += distance_m(position->place.point, truth);
    ++count;
  }
  return count ? sum / count : INFINITY;
}

TEST(Parts, EveryPresetFollowsAWalk) {
  const auto site = hall_site();
  for (const auto& name : preset_names()) {
    const auto factory = assemble(*preset(name), site);
    ASSERT_TRUE(factory) << name;
    const std::optional<KnownStart> start =
        name == "dead-reckoning" ? std::optional(KnownStart{{{2.0, 6.0}, FloorOrdinal{0}}, 0.5, {}}) : std::nullopt;
    const auto tracker = (*factory)->make_tracker(Random(1), start);
    EXPECT_LT(walk_error_m(*tracker, *site), 3.5) << name;
  }
}

TEST(Parts, EveryLocatorServesEveryMeasurementItPromises) {
  const auto site = hall_site();
  for (const LocatorRow& row : locator_catalogue()) {
    if (!row.prepare) continue;
    for (const char* measurement : {"fix", "ranges", "field"}) {
      const std::string kind = measurement;
      const bool promised = kind == "fix" ? row.gives_fix : kind == "ranges" ? row.gives_ranges : row.gives_likelihood;
      const auto factory = assemble(with({{"locator", {row.description.name, {}}}, {"measurement", {kind, {}}}, {"motion", {"steps", {}}}}), site);
      EXPECT_EQ(factory.has_value(), promised) << row.description.name << " " << kind;
      if (!factory) continue;
      const auto tracker = (*factory)->make_tracker(Random(1));
      EXPECT_LT(walk_error_m(*tracker, *site), 3.5) << row.description.name << " " << kind;
    }
  }
}

// What a locator says of one scan is what its row says it says, and about where the phone is; where nobody surveyed it says nothing.
TEST(Parts, EveryLocatorAnswersAsItsRowSays) {
  const auto site = hall_site();
  const std::vector<ReferencePoint> nowhere;
  const BuildingPoint truth{18.0, 6.0};
  for (const LocatorRow& row : locator_catalogue()) {
    if (!row.prepare) continue;
    const std::string& name = row.description.name;
    const PartSettings settings = *check_settings(row.description, {name, {}}, "");
    const auto model = row.prepare({RadioMap::build(site->survey), site->survey, site->floors}, settings);
    const auto locator = model->make();
    const RssScan scan = hall().scan_at(truth, at(1.0));
    const auto fix = locator->locate(scan);
    EXPECT_EQ(fix.has_value(), row.gives_fix) << name;
    if (fix) {
      EXPECT_LT(distance_m(fix->place.point, truth), 8.0) << name;  // transmitters stand 20 m apart
      EXPECT_GT(fix->sigma_m, 0.0) << name;
    }
    EXPECT_EQ(!locator->ranges().empty(), row.gives_ranges) << name;
    EXPECT_EQ(locator->has_likelihood(), row.gives_likelihood) << name;
    EXPECT_EQ(locator->transmitters_known(), static_cast<int>(scan.readings.size())) << name;
    EXPECT_EQ(locator->transmitters_unknown(), 0) << name;
    EXPECT_FALSE(row.prepare({RadioMap::build(nowhere), nowhere, {}}, settings)->make()->locate(scan)) << name;
  }
}

// A part that falls back to another in silence answers as that one does. (Kalman filters may: on linear models they are one.)
TEST(Parts, NoneIsAnotherUnderItsOwnName) {
  auto site = std::make_shared<Site>(*hall_site());
  Random random(4);
  for (ReferencePoint& point : site->survey) {
    for (RssScan& scan : point.scans) {
      for (ScanReading& reading : scan.readings) reading.rss_dbm += 3.0 * random.normal();
    }
  }
  std::map<std::string, std::map<double, std::string>> by_error;
  for (const PartDescription& part : part_catalogue()) {
    if ((part.role != "locator" && part.role != "motion" && part.role != "resampler") || part.name == "none") continue;
    std::map<std::string, PartChoice> parts = {{"locator", {"wknn", {}}}, {"motion", {"steps", {}}}, {"filter", {"particle", {{"resample_below", 1}}}}};
    parts[part.role] = {part.name, {}};
    const auto factory = assemble(with(parts), site);
    ASSERT_TRUE(factory) << part.name << ": " << to_string(factory.fault());
    const double error_m = walk_error_m(*(*factory)->make_tracker(Random(1)), *site);
    const auto [like, fresh] = by_error[part.role].try_emplace(error_m, part.name);
    EXPECT_TRUE(fresh) << part.name << " does just what " << like->second << " does";
  }
  EXPECT_EQ(by_error.size(), 3u);
}

Fault fault(std::map<std::string, PartChoice> parts) {
  const auto made = assemble(with(std::move(parts)), hall_site());
  EXPECT_FALSE(made);
  return made ? Fault{} : made.fault();
}

// Every filter with every measurement: assembled where the catalogue says that the filter takes it, else refused by name.
TEST(Parts, AFilterRefusesWhatItDoesNotUnderstand) {
  struct Row {
    std::string role, part;
    std::string locator;
    Takes needed;
  };
  const Row rows[] = {{"measurement", "fix", "wknn", Takes::kFixes},           {"azimuth", "resolved", "wknn", Takes::kLinear},
                      {"azimuth", "direction", "wknn", Takes::kGaussian},      {"speed", "speed", "wknn", Takes::kGaussian},
                      {"measurement", "ranges", "trilateration", Takes::kGaussian}, {"measurement", "field", "radio-field", Takes::kAny}};
  for (const FilterRow& filter : filter_catalogue()) {
    for (const Row& row : rows) {
      const std::map<std::string, PartChoice> parts = {
          {"locator", {row.locator, {}}}, {"motion", {"constant-velocity", {}}}, {"filter", {filter.description.name, {}}}, {row.role, {row.part, {}}}};
      if (filter.takes >= row.needed) {
        EXPECT_TRUE(assemble(with(parts), hall_site())) << filter.description.name << " " << row.part;
        continue;
      }
      const Fault refusal = fault(parts);
      EXPECT_EQ(refusal.code, FaultCode::kConflict);
      EXPECT_EQ(refusal.field, "parts.filter") << filter.description.name << " " << row.part;
      EXPECT_THAT(refusal.cause, HasSubstr("`" + filter.description.name + "` takes " + std::string(words_of(filter.takes)) + " only"));
      EXPECT_THAT(refusal.cause, HasSubstr("`" + row.part + "` is none: `particle`"));
    }
  }
}

TEST(Parts, AResamplerNeedsParticles) {
  for (const FilterRow& filter : filter_catalogue()) {
    const auto parts = [&](const char* resampler) -> std::map<std::string, PartChoice> {
      return {{"locator", {"wknn", {}}}, {"filter", {filter.description.name, {}}}, {"resampler", {resampler, {}}}};
    };
    EXPECT_TRUE(assemble(with(parts("systematic")), hall_site())) << "what stands there when a spec is silent";
    if (filter.takes == Takes::kAny) {
      EXPECT_TRUE(assemble(with(parts("perturbing")), hall_site()));
      continue;
    }
    const Fault refusal = fault(parts("perturbing"));
    EXPECT_EQ(refusal.field, "parts.resampler");
    EXPECT_THAT(refusal.cause, HasSubstr(filter.description.name));
  }
}

TEST(Parts, TheSameInformationTwiceIsRefused) {
  const auto heading = fault({{"locator", {"wknn", {}}}, {"motion", {"walk", {}}}, {"azimuth", {"direction", {}}}});
  EXPECT_EQ(heading.code, FaultCode::kConflict);
  EXPECT_EQ(heading.field, "parts.azimuth");
  EXPECT_THAT(heading.cause, HasSubstr("twice"));
  const auto own = fault({{"locator", {"wknn", {}}}, {"motion", {"street", {}}}, {"heading", {"track-kalman", {}}}, {"azimuth", {"direction", {}}}});
  EXPECT_EQ(own.field, "parts.azimuth");
  EXPECT_THAT(own.cause, HasSubstr("own track"));
  const auto speed = fault({{"locator", {"wknn", {}}}, {"motion", {"steps", {}}}, {"speed", {"speed", {}}}});
  EXPECT_EQ(speed.field, "parts.speed");
  EXPECT_EQ(fault({{"locator", {"wknn", {}}}, {"motion", {"still", {}}}, {"speed", {"speed", {}}}}).field, "parts.motion");
  const auto resolved = fault({{"locator", {"wknn", {}}}, {"motion", {"street", {}}}, {"speed", {"speed", {}}}, {"azimuth", {"resolved", {}}}});
  EXPECT_EQ(resolved.field, "parts.speed");
  EXPECT_THAT(resolved.cause, HasSubstr("twice"));
}

TEST(Parts, SatelliteFixesWeighByTheSigmaTheirReceiverStates) {
  auto site = std::make_shared<Site>();
  site->georeference = Georeference{{48.0, 11.0}, 0.0};
  const auto factory = *assemble(with({{"measurement", {"none", {}}}, {"motion", {"still", {{"wander_m_rts", 0.0}}}}, {"filter", {"kalman", {}}}}), site);
  const auto tracker = factory->make_tracker(Random(1), std::nullopt);
  tracker->feed(GnssFix{at(1.0), site->georeference->to_geo({0.0, 0.0}), 4.0, {}, {}});
  tracker->feed(GnssFix{at(1.0), site->georeference->to_geo({10.0, 0.0}), 8.0, {}, {}});
  const auto position = tracker->position(at(1.0));
  ASSERT_TRUE(position);
  EXPECT_NEAR(position->place.point.x_m, 10.0 * 16.0 / (16.0 + 64.0), 1e-3);  // weighted by 1 / sigma^2
  EXPECT_NEAR(position->place.point.y_m, 0.0, 1e-3);
}

// What a stranger writes first: a fix and no more.
class BareLocator final : public Locator {
 public:
  std::unique_ptr<Locator> clone() const override { return std::make_unique<BareLocator>(*this); }
  std::optional<Fix> locate(const RssScan&) override { return Fix{{{7.0, 3.0}, FloorOrdinal{2}}, 1.0, 4}; }
  int transmitters_known() const override { return 4; }
  int transmitters_unknown() const override { return 0; }
};
class BareModel final : public LocatorModel {
 public:
  std::unique_ptr<Locator> make() const override { return std::make_unique<BareLocator>(); }
};

TEST(Parts, ALocatorThatVotesForNoFloorSpeaksForItsFixes) {
  auto parts = std::make_shared<PipelineParts>();
  parts->site = hall_site();
  parts->map = RadioMap::build(parts->site->survey);
  parts->locator = std::make_shared<BareModel>();
  const MotionModelRow& still = *std::ranges::find_if(motion_model_catalogue(), [](const auto& row) { return row.description.name == "still"; });
  const FilterRow& kalman = *std::ranges::find_if(filter_catalogue(), [](const auto& row) { return row.description.name == "kalman"; });
  parts->motion = still.make(*check_settings(still.description, {"still", {}}, ""));
  parts->make_filter = [&] { return kalman.make(*check_settings(kalman.description, {"kalman", {}}, ""), parts->motion, nullptr); };
  FusionTracker tracker(parts, Random(1), {});
  tracker.feed(hall().scan_at({8.0, 6.0}, at(1.0)));
  const auto position = tracker.position(at(1.0));
  ASSERT_TRUE(position);
  EXPECT_EQ(position->place, (Place{{7.0, 3.0}, FloorOrdinal{2}}));
}

// A survey of walks whose fixes all err by the same bend: what a corrector is for.
std::shared_ptr<Site> walked_site() {
  auto site = hall_site();
  for (int walk = 0; walk < 6; ++walk) {
    for (int i = 0; i < 20; ++i) {
      ReferencePoint point;
      point.place = {{2.0 * i, 2.0 + walk}, FloorOrdinal{0}};
      point.walk = "walk-" + std::to_string(walk);
      point.scans = {hall().scan_at(point.place.point, at(10000.0 * walk + 2.0 * i))};
      site->survey.push_back(point);
    }
  }
  return site;
}

TEST(Corrector, IsTrainedOnTheSurveysWalksAndStoredWithItsProvenance) {
  const auto site = walked_site();
  const auto spec = *preset("p4");
  const auto factory = *assemble(spec, site);
  EXPECT_TRUE(factory->remarks().empty());
  const auto corrector = Corrector::parse(factory->learnt());
  ASSERT_TRUE(corrector);
  EXPECT_EQ(corrector->from.walks, 6);
  EXPECT_GT(corrector->from.samples, 60);
  EXPECT_LT(corrector->from.rmse_after_m, corrector->from.rmse_before_m);
  // Stored and loaded it is the same corrector, and nothing is trained again.
  auto stored = std::make_shared<Site>(*site);
  stored->correctors["p4"] = factory->learnt();
  const auto again = *assemble(spec, stored);
  EXPECT_EQ(again->learnt(), factory->learnt());
  const auto one = factory->make_tracker(Random(1)), two = again->make_tracker(Random(1));
  walk_error_m(*one, *site);
  walk_error_m(*two, *site);
  EXPECT_EQ(one->position(at(30)), two->position(at(30)));
}

TEST(Corrector, IsAddedToWhatTheFilterSays) {
  const auto site = walked_site();
  PipelineSpec plain = *preset("p4");
  plain.parts.erase("corrector");
  const auto factory = *assemble(*preset("p4"), site);
  const auto corrector = *Corrector::parse(factory->learnt());
  const auto corrected = factory->make_tracker(Random(1)), bare = (*assemble(plain, site))->make_tracker(Random(1));
  double most_m = 0.0;
  for (int i = 0; i < 12; ++i) {
    for (Tracker* each : {corrected.get(), bare.get()}) each->feed(hall().scan_at({2.0 + 1.3 * i, 3.5}, at(1.0 + i)));
    const auto inputs = dynamic_cast<const FusionTracker&>(*corrected).newest_correction_inputs();
    if (!inputs) continue;
    const BuildingPoint from = bare->position(at(1.0 + i))->place.point, to = corrected->position(at(1.0 + i))->place.point;
    EXPECT_NEAR(to.x_m - from.x_m, corrector.x(*inputs), 1e-9);
    EXPECT_NEAR(to.y_m - from.y_m, corrector.y(*inputs), 1e-9);
    most_m = std::max(most_m, distance_m(from, to));
  }
  EXPECT_GT(most_m, 0.2) << "it never had anything to correct";
}

TEST(Corrector, SaysSoWhenThereIsNone) {
  const auto factory = *assemble(*preset("p4"), hall_site());
  ASSERT_EQ(factory->remarks().size(), 1u);
  EXPECT_THAT(factory->remarks()[0], HasSubstr("0 walks"));
  EXPECT_EQ(factory->learnt(), "");
}

TEST(Corrector, RefusesAStoredOneThatIsBroken) {
  const std::string whole = (*assemble(*preset("p4"), walked_site()))->learnt();
  for (std::string broken : {std::string("{}"), std::string("nonsense"), whole.substr(0, whole.size() / 2)}) {
    EXPECT_FALSE(Corrector::parse(broken));
    auto site = std::make_shared<Site>(*hall_site());
    site->correctors["p4"] = broken;
    EXPECT_FALSE(assemble(*preset("p4"), site));
  }
}

TEST(Gate, AWildFixDoesNotMoveP4) {
  const auto site = hall_site();
  const auto tracker = (*assemble(*preset("p4"), site))->make_tracker(Random(1));
  for (int i = 0; i < 20; ++i) tracker->feed(hall().scan_at({8.0, 6.0}, at(1.0 + i)));
  const auto before = tracker->position(at(20.0))->place.point;
  tracker->feed(hall().scan_at({40.0, 12.0}, at(21.0)));  // a WiFi card fault
  EXPECT_LT(distance_m(tracker->position(at(21.0))->place.point, before), 0.5);
}

}  // namespace
}  // namespace wayfuse
