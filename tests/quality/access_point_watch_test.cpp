#include "server/quality/access_point_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "wayfuse/proto/random.hpp"

namespace wayfuse {
namespace {

/// A street of 120 m with an access point every 6 m, surveyed every 2 m. Levels fall by 25 dB a decade from -40 dBm at 1 m.
class Street {
 public:
  struct Transmitter {
    Bssid bssid;
    double x_m = 0.0;
    double power_db = 0.0;
  };
  Street() {
    for (int i = 0; i < 20; ++i) transmitters.push_back({Bssid{100u + static_cast<unsigned>(i)}, 6.0 * i, 0.0});
  }
  RssScan scan_at(double x_m, Random& random, double offset_db) const {
    RssScan scan;
    for (const Transmitter& each : transmitters) {
      const double level = -40.0 + each.power_db - 25.0 * std::log10(std::hypot(x_m - each.x_m, 3.0)) + 3.0 * random.normal() + offset_db;
      if (level > -85.0) scan.readings.push_back({each.bssid, std::min(level, 0.0), Duration{0}, 2412, {}, {}});
    }
    return scan;
  }
  std::vector<ReferencePoint> survey() const {
    Random random(1);
    std::vector<ReferencePoint> points;
    for (double x_m = 0.0; x_m <= 120.0; x_m += 2.0) {
      ReferencePoint point;
      point.place = {{x_m, 0.0}, {0}};
      point.scans = {scan_at(x_m, random, 0.0)};
      points.push_back(point);
    }
    return points;
  }
  /// Phones that walk the street up and down, each with an offset of its own and a position that errs by 2 m.
  void walk(AccessPointWatch& watch, std::uint64_t sessions, std::uint64_t first = 1) const {
    for (std::uint64_t session = first; session < first + sessions; ++session) {
      Random random(session);
      const double offset_db = 6.0 * random.normal();
      for (double x_m = 0.0; x_m <= 120.0; x_m += 4.0) {
        FusedPosition position;
        position.place = {{x_m + 2.0 * random.normal(), 0.0}, {0}};
        position.radius68_m = 3.0;
        watch.hear(session, scan_at(x_m, random, offset_db), position, UnixTime(std::chrono::seconds(session)));
      }
    }
  }
  std::vector<Transmitter> transmitters;
};

AccessPointState state_of(const AccessPointWatch& watch, std::uint64_t bssid, const std::vector<AccessPointRecord>& before = {}) {
  for (const AccessPointRecord& verdict : watch.verdicts(before, {})) {
    if (verdict.bssid.value == bssid) return verdict.state;
  }
  return AccessPointState::kOk;
}

TEST(AccessPointWatch, RaisesNoAlarmWhereNothingChanged) {
  const Street street;
  AccessPointWatch watch(std::make_shared<SurveyLevels>(street.survey()));
  street.walk(watch, 40);
  for (const AccessPointRecord& verdict : watch.verdicts({}, {})) {
    EXPECT_EQ(verdict.state, AccessPointState::kOk) << to_string(verdict.bssid) << " " << verdict.reason;
    EXPECT_NEAR(verdict.change_db.value_or(0.0), 0.0, 3.0);
  }
}

TEST(AccessPointWatch, TellsWhatVanishedMovedChangedPowerAndCameAnew) {
  const Street surveyed;
  Street street = surveyed;
  street.transmitters[3].power_db = -100.0;                             // gone
  street.transmitters[8].x_m = 108.0;                                   // 60 m down the street
  street.transmitters[13].power_db = 12.0;
  street.transmitters.push_back({Bssid{900}, 55.0, 0.0});
  AccessPointWatch watch(std::make_shared<SurveyLevels>(surveyed.survey()));
  street.walk(watch, 6);
  EXPECT_EQ(state_of(watch, 103), AccessPointState::kVanished);
  EXPECT_EQ(state_of(watch, 108), AccessPointState::kMoved);
  EXPECT_EQ(state_of(watch, 113), AccessPointState::kPowerChanged);
  EXPECT_EQ(state_of(watch, 900), AccessPointState::kNew);
  for (const AccessPointRecord& verdict : watch.verdicts({}, {})) {
    if (verdict.bssid.value == 108) { EXPECT_NEAR(verdict.distance_m.value(), 60.0, 12.0) << verdict.reason; }
    if (verdict.bssid.value == 113) { EXPECT_NEAR(verdict.change_db.value(), 12.0, 3.0); }
    const bool changed = verdict.bssid.value == 103 || verdict.bssid.value == 108 || verdict.bssid.value == 113;
    EXPECT_EQ(verdict.distrusted(), changed) << to_string(verdict.bssid) << " " << verdict.reason;
  }
}

TEST(AccessPointWatch, NoPhoneDecidesAlone) {
  const Street surveyed;
  Street street = surveyed;
  street.transmitters[3].power_db = -100.0;
  AccessPointWatch watch(std::make_shared<SurveyLevels>(surveyed.survey()));
  for (int round = 0; round < 10; ++round) street.walk(watch, 2);
  EXPECT_EQ(state_of(watch, 103), AccessPointState::kOk) << "two sessions, however long, are not three";
  street.walk(watch, 1, 3);
  street.walk(watch, 1, 3);
  EXPECT_EQ(state_of(watch, 103), AccessPointState::kVanished);
}

TEST(AccessPointWatch, WhatCameBackIsTrustedAgainAfterEvidenceOfItsOwn) {
  const Street street;
  AccessPointWatch watch(std::make_shared<SurveyLevels>(street.survey()));
  AccessPointRecord gone;
  gone.bssid = {103};
  gone.state = AccessPointState::kVanished;
  street.walk(watch, 1);
  EXPECT_EQ(state_of(watch, 103, {gone}), AccessPointState::kVanished) << "one phone is not enough";
  street.walk(watch, 5, 2);
  EXPECT_EQ(state_of(watch, 103, {gone}), AccessPointState::kOk);
}

TEST(AccessPointWatch, APhoneThatIsNotSureWhereItIsSaysNothing) {
  const Street street;
  AccessPointWatch watch(std::make_shared<SurveyLevels>(street.survey()));
  Random random(1);
  FusedPosition position;
  position.place = {{50.0, 0.0}, {0}};
  position.radius68_m = 20.0;
  watch.hear(1, street.scan_at(50.0, random, 0.0), position, {});
  position.radius68_m = 3.0;
  position.integrity = Integrity::kSuspect;
  watch.hear(1, street.scan_at(50.0, random, 0.0), position, {});
  EXPECT_EQ(watch.scans(), 0u);
}

}  // namespace
}  // namespace wayfuse
