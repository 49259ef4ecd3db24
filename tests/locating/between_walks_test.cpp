#include "server/locating/between_walks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

namespace wayfuse {
namespace {

/// Radios about a hall of 60 m by 24 m, heard 1.5 dB fainter with every metre; those of `floor` only.
RssScan scan_at(BuildingPoint point, int floor, double time_s) {
  RssScan scan{PhoneTime(from_seconds(time_s)), {}};
  const BuildingPoint radios[] = {{0, 0}, {20, 0}, {40, 0}, {60, 0}, {0, 24}, {20, 24}, {40, 24}, {60, 24}};
  std::uint64_t number = 0x00'10'00'00'00'00u + 100u * static_cast<unsigned>(floor);
  for (const BuildingPoint radio : radios) {
    const double level = -35.0 - 1.5 * distance_m(radio, point);
    if (level > -95.0) scan.readings.push_back({Bssid{number}, level, Duration{0}, 2412, {}, {}});
    ++number;
  }
  return scan;
}

/// Walks along both long sides of the hall, 16 m apart, and on a floor above along one.
std::vector<ReferencePoint> walked() {
  std::vector<ReferencePoint> survey;
  int walk = 0;
  const auto along = [&](double y_m, int floor) {
    for (int i = 0; i <= 28; ++i) {
      const BuildingPoint point{2.0 + 2.0 * i, y_m};
      survey.push_back({{point, FloorOrdinal{floor}}, 0.0, "phone", "walk " + std::to_string(walk), {}, {scan_at(point, floor, 1000.0 * walk + 2.0 * i)}});
    }
    ++walk;
  };
  for (int i = 0; i < 3; ++i) along(4.0, 0), along(20.0, 0), along(4.0, 1);
  return survey;
}

const RadioFieldSettings kAsMarked{.delay_s = 0.0, .learn = false};

TEST(FingerprintsBetween, StandOnGroundWithSurveyedGroundOnBothSides) {
  RadioFieldSettings settings = kAsMarked;
  settings.between = false;
  const RadioField field(walked(), settings);
  const auto made = fingerprints_between(field);
  ASSERT_GE(made.size(), 12u);
  for (const SurveyFingerprint& each : made) {
    EXPECT_EQ(each.walk, -1);
    EXPECT_EQ(each.place.floor, FloorOrdinal{0}) << "above, nothing lies between anything";
    EXPECT_GE(each.place.point.y_m, 9.0) << "not where a walk speaks for itself, nor beyond the outer ones";
    EXPECT_LE(each.place.point.y_m, 15.0);
  }
}

TEST(FingerprintsBetween, HearBothSidesFaintly) {
  const RadioField field(walked(), kAsMarked);
  const RadioField::Storey& storey = field.storeys().front();
  ASSERT_LT(storey.surveyed_end, storey.end);
  for (std::uint32_t i = storey.begin; i < storey.end; ++i) EXPECT_EQ(field.fingerprints()[i].walk < 0, i >= storey.surveyed_end);
  float strongest = 0.0f, strongest_between = 0.0f;
  for (std::uint32_t i = storey.begin; i < storey.end; ++i) {
    for (const RadioStrength& heard : field.fingerprints()[i].heard) {
      float& most = i < storey.surveyed_end ? strongest : strongest_between;
      most = std::max(most, heard.strength);
    }
  }
  EXPECT_GT(strongest_between, 0.2f * strongest);
  EXPECT_LT(strongest_between, strongest);
}

/// Log-likelihood of a scan in the middle of the hall, there against at the side.
double lead_of_the_middle(const RadioFieldSettings& settings) {
  const auto locator = std::make_shared<const RadioField>(walked(), settings)->make();
  EXPECT_TRUE(locator->locate(scan_at({30.0, 12.0}, 0, 5000.0)));
  const std::array x_m = {30.0f, 30.0f}, y_m = {12.0f, 4.0f};
  std::array<float, 2> likelihood{};
  locator->add_log_likelihood(x_m, y_m, FloorOrdinal{0}, likelihood);
  return static_cast<double>(likelihood[0] - likelihood[1]);
}

TEST(FingerprintsBetween, LetAScanFromTheMiddleBelongThere) {
  RadioFieldSettings without = kAsMarked;
  without.between = false;
  EXPECT_GT(lead_of_the_middle(kAsMarked), lead_of_the_middle(without) + 1.0);
}

TEST(FingerprintsBetween, HaveNoSayInHowWellAScanFitsTheSurvey) {
  RadioFieldSettings without = kAsMarked;
  without.between = false;
  const auto with_them = std::make_shared<const RadioField>(walked(), kAsMarked)->make();
  const auto without_them = std::make_shared<const RadioField>(walked(), without)->make();
  const RssScan scan = scan_at({30.0, 12.0}, 0, 5000.0);
  ASSERT_TRUE(with_them->locate(scan) && without_them->locate(scan));
  EXPECT_EQ(with_them->mismatch(), without_them->mismatch());
  EXPECT_EQ(with_them->floors().front().probability, without_them->floors().front().probability);
}

TEST(FingerprintsBetween, OfNothingAreNone) {
  EXPECT_TRUE(RadioField({}, {}).fingerprints().empty());
}

}  // namespace
}  // namespace wayfuse
