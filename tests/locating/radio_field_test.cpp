#include "server/locating/radio_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/locating/radio_field_locator.hpp"

namespace wayfuse {
namespace {

// A corridor of 40 m with a radio every 5 m, surveyed by `walks` walks of one fingerprint every 1.3 s, two floors of other radios.
//
//   x 0 ---- 10 ---- 20 ---- 30 ---- 40      level = -40 - 1.5 |x - radio|
double level_dbm(double x_m, int radio) { return -40.0 - 1.5 * std::abs(x_m - 5.0 * radio); }

ScanReading reading(int floor, int radio, double rss_dbm, Duration age = Duration{0}) {
  return {Bssid{0x00'10'00'00'00'00u + static_cast<std::uint64_t>(floor * 256 + radio)}, rss_dbm, age, 2412, {}, {}};
}

RssScan scan_at(double x_m, int floor, double offset_db = 0.0, double time_s = 0.0) {
  RssScan scan{PhoneTime(from_seconds(time_s)), {}};
  for (int radio = 0; radio <= 8; ++radio) {
    const double level = level_dbm(x_m, radio) + offset_db;
    if (level > -95.0) scan.readings.push_back(reading(floor, radio, level));
  }
  return scan;
}

std::vector<ReferencePoint> corridor() {
  std::vector<ReferencePoint> survey;
  for (int floor = 0; floor < 2; ++floor) {
    for (int walk = 0; walk < 4; ++walk) {
      for (int i = 0; i <= 30; ++i) {
        const double x_m = walk % 2 ? 40.0 - 1.3 * i : 1.3 * i;
        survey.push_back({{{x_m, 0.0}, FloorOrdinal{floor}}, 0.0, "phone", "walk " + std::to_string(floor * 4 + walk), {},
                          {scan_at(x_m, floor, 0.0, i)}});
      }
    }
  }
  return survey;
}

RadioFieldSettings in_step() {
  RadioFieldSettings settings;
  settings.learn = false;
  return settings;
}

class RadioFieldCorridor : public testing::Test {
 protected:
  RadioFieldCorridor() : survey_(corridor()), field_(std::make_shared<RadioField>(survey_, in_step())), locator_(field_->make()) {}

  float likelihood(float x_m, float y_m, int floor) const {
    float value = 0.0f;
    locator_->add_log_likelihood({&x_m, 1}, {&y_m, 1}, FloorOrdinal{floor}, {&value, 1});
    return value;
  }

  std::vector<ReferencePoint> survey_;
  std::shared_ptr<RadioField> field_;
  std::unique_ptr<Locator> locator_;
};

// The formula of radio_field.hpp written down plainly, in doubles: one node of one distance.
//   L = 1/b log((sum K e^{-b (d - m)} + n) / (sum K + n)),  K = e^{-(r^2 - n^2) / 2 h^2 - n^2 / 2 B^2},  down to a hundredth of the nearest's
struct PlainField {
  const RadioField& field;
  const RadioField::Storey& storey;
  std::vector<double> sorensen, cosine;  // a fingerprint: the scan's distances

  PlainField(const RadioField& of, const RadioField::Storey& on, const std::vector<RadioStrength>& heard, double sum, double squares) : field(of), storey(on) {
    for (const SurveyFingerprint& there : field.fingerprints()) {
      double common = 0.0, product = 0.0, their_sum = 0.0, their_squares = 0.0;
      for (const RadioStrength& theirs : there.heard) {
        const auto strength = static_cast<double>(theirs.strength);
        their_sum += strength, their_squares += strength * strength;
        for (const RadioStrength& ours : heard) {
          if (ours.radio != theirs.radio) continue;
          common += std::min(static_cast<double>(ours.strength), strength);
          product += static_cast<double>(ours.strength) * strength;
        }
      }
      sorensen.push_back(1.0 - 2.0 * common / (sum + their_sum));
      cosine.push_back(1.0 - product / std::sqrt(squares * their_squares));
    }
  }

  double level(BuildingPoint node, const std::vector<double>& distances, double middle, double sharpness, int without_walk) const {
    const double h = field.weights().bandwidth_m, beyond = field.settings().beyond_m;
    double nearest2 = INFINITY;
    const auto square = [&](std::uint32_t i) { return std::pow(distance_m(field.fingerprints()[i].place.point, node), 2); };
    for (std::uint32_t i = storey.begin; i < storey.end; ++i) nearest2 = std::min(nearest2, square(i));
    double above = field.settings().neutral, below = field.settings().neutral;
    for (std::uint32_t i = storey.begin; i < storey.end; ++i) {
      if (nearest2 > 4.0 * beyond * beyond || square(i) - nearest2 >= -2.0 * std::log(0.01) * h * h) continue;
      if (field.fingerprints()[i].walk == without_walk) continue;
      const double kernel = std::exp(-(square(i) - nearest2) / (2.0 * h * h) - nearest2 / (2.0 * beyond * beyond));
      above += kernel * std::exp(-sharpness * (distances[i] - middle));
      below += kernel;
    }
    return std::log(above / below) / sharpness;
  }
  BuildingPoint node_at(int column, int row) const {
    return {static_cast<double>(storey.x_m) + 2.0 * column, static_cast<double>(storey.y_m) + 2.0 * row};
  }
  std::pair<double, double> pair_at(int column, int row, int without_walk = -1) const {
    const RadioFieldSettings& s = field.settings();
    return {level(node_at(column, row), sorensen, static_cast<double>(storey.sorensen_middle), s.sorensen_sharpness, without_walk),
            level(node_at(column, row), cosine, static_cast<double>(storey.cosine_middle), s.cosine_sharpness, without_walk)};
  }
  double log_likelihood_at(int column, int row) const {
    const auto [by_sorensen, by_cosine] = pair_at(column, row);
    return field.weights().sorensen * by_sorensen + field.weights().cosine * by_cosine;
  }
};

TEST_F(RadioFieldCorridor, IsTheFormulaOfItsHeader) {
  RssScan scan = scan_at(13.0, 0, -12.0);  // nothing so loud that it is looked at apart
  for (std::size_t i = 0; i < scan.readings.size(); ++i) scan.readings[i].age = from_seconds(0.4 * static_cast<double>(i));
  scan.readings.push_back(reading(9, 9, -80.0));  // on no map
  std::vector<RadioStrength> heard;
  double sum = 0.0, squares = 0.0, ages = 0.0;
  for (const ScanReading& each : scan.readings) {
    const ReadingStrength& of = field_->settings().strength;
    const double faded = std::exp(-std::max(0.0, seconds(each.age) - of.fresh_s) / of.fade_s);
    const double strength = std::pow((each.rss_dbm + 100.0) / 100.0, of.power) * faded;
    sum += strength, squares += strength * strength, ages += strength * seconds(each.age);
    if (const auto radio = field_->radios().find(RadioNames::key(each))) heard.push_back({*radio, static_cast<float>(strength)});
  }
  ASSERT_EQ(heard.size() + 1, scan.readings.size());
  ASSERT_TRUE(locator_->locate(scan));
  EXPECT_NEAR(seconds(locator_->heard_before()), ages / sum - field_->weights().delay_s, 1e-5);

  const RadioField::Storey& storey = field_->storeys()[0];
  const PlainField plain(*field_, storey, heard, sum, squares);
  const auto scratch = field_->borrow();
  field_->match(heard, static_cast<float>(sum), static_cast<float>(std::sqrt(squares)), *scratch);
  field_->expose(storey, *scratch);
  for (int row = 0; row < storey.rows; row += 3) {
    for (int column = 0; column < storey.columns; ++column) {
      const std::uint32_t number = storey.first_node + static_cast<std::uint32_t>(row * storey.columns + column);
      for (const int without_walk : {-1, 2}) {
        const auto [by_sorensen, by_cosine] = plain.pair_at(column, row, without_walk);
        const RadioField::Pair pair = field_->node(number, *scratch, without_walk);
        ASSERT_NEAR(pair.sorensen, by_sorensen, 2e-5) << column << " " << row;
        ASSERT_NEAR(pair.cosine, by_cosine, 2e-5) << column << " " << row;
      }
    }
  }
  // Between four nodes: in proportion to how near each of them is.
  for (const auto& [right, up] : {std::pair{0.0, 0.0}, {0.25, 0.0}, {0.0, 0.75}, {0.7, 0.2}}) {
    const int column = storey.columns / 3, row = storey.rows / 2;
    const BuildingPoint corner = plain.node_at(column, row);
    const double expected = (1 - up) * ((1 - right) * plain.log_likelihood_at(column, row) + right * plain.log_likelihood_at(column + 1, row)) +
                            up * ((1 - right) * plain.log_likelihood_at(column, row + 1) + right * plain.log_likelihood_at(column + 1, row + 1));
    EXPECT_NEAR(likelihood(static_cast<float>(corner.x_m + 2.0 * right), static_cast<float>(corner.y_m + 2.0 * up), 0), expected, 1e-3) << right << " " << up;
  }
}

TEST_F(RadioFieldCorridor, FindsTheFloorAndThePlace) {
  const auto fix = locator_->locate(scan_at(20.0, 1));
  ASSERT_TRUE(fix);
  EXPECT_EQ(fix->place.floor, FloorOrdinal{1});
  EXPECT_NEAR(fix->place.point.x_m, 20.0, 3.0);
  EXPECT_EQ(locator_->floors().front().floor, FloorOrdinal{1});
  EXPECT_GT(locator_->floors().front().probability, 0.99);
}

TEST_F(RadioFieldCorridor, SpeaksOnBeyondTheSurveyEverMoreQuietly) {
  ASSERT_TRUE(locator_->locate(scan_at(2.0, 0)));
  const float edge = likelihood(1.0f, 0.0f, 0), beyond = likelihood(-8.0f, 0.0f, 0), farther = likelihood(-16.0f, 0.0f, 0);
  EXPECT_GT(edge, beyond);
  EXPECT_GT(beyond, farther);
  EXPECT_GT(farther, 0.0f) << "it sounds like that end of the corridor, not like anywhere";
  EXPECT_GT(beyond, likelihood(30.0f, 0.0f, 0)) << "whoever left the corridor here is not torn back onto its other end";
  EXPECT_EQ(likelihood(-40.0f, 0.0f, 0), 0.0f) << "far out ground is neutral";
}

TEST_F(RadioFieldCorridor, PeaksWhereTheScanWasHeardAndIsNeutralWhereNobodySurveyed) {
  locator_->locate(scan_at(10.0, 0));
  EXPECT_GT(likelihood(10.0f, 0.0f, 0), likelihood(20.0f, 0.0f, 0) + 1.0f);
  EXPECT_GT(likelihood(10.0f, 0.0f, 0), likelihood(3.0f, 0.0f, 0));
  EXPECT_EQ(likelihood(500.0f, 500.0f, 0), 0.0f);
}

TEST_F(RadioFieldCorridor, APhoneThatHearsFiveDecibelsMoreStaysWhereItIs) {
  const auto usual = locator_->locate(scan_at(15.0, 0));
  const auto louder = locator_->locate(scan_at(15.0, 0, 5.0));
  ASSERT_TRUE(usual && louder);
  EXPECT_NEAR(louder->place.point.x_m, usual->place.point.x_m, 1.5);
}

// Every other radio, the loudest among them, was heard a while and 20 m ago.
TEST_F(RadioFieldCorridor, WhatWasHeardLongAgoSpeaksEverMoreQuietly) {
  const auto x_m = [&](double age_s) {
    RssScan scan = scan_at(30.0, 0);
    const RssScan before = scan_at(10.0, 0);
    for (std::size_t i = 0; i < scan.readings.size(); i += 2) {
      scan.readings[i] = before.readings[i];
      scan.readings[i].age = from_seconds(age_s);
    }
    return locator_->locate(scan)->place.point.x_m;
  };
  EXPECT_LT(x_m(0.0), 18.0);
  EXPECT_EQ(x_m(2.0), x_m(0.0)) << "a cache of 2 s is fresh";
  EXPECT_GT(x_m(4.0), x_m(2.0) + 4.0);
  EXPECT_GT(x_m(7.0), 25.0);
  EXPECT_NEAR(x_m(8.5), 30.0, 1.0);
  EXPECT_EQ(x_m(20.0), x_m(8.5));
}

TEST_F(RadioFieldCorridor, VirtualAccessPointsOfARadioCountOnce) {
  RssScan scan = scan_at(12.0, 0);
  const auto alone = locator_->locate(scan);
  const auto readings = scan.readings;
  for (ScanReading each : readings) {
    each.bssid.value |= std::uint64_t{0x02} << 40;  // a derived, locally administered address of the same radio
    scan.readings.push_back(each);
  }
  const auto doubled = locator_->locate(scan);
  ASSERT_TRUE(alone && doubled);
  EXPECT_EQ(doubled->place, alone->place);
  EXPECT_EQ(locator_->transmitters_known(), alone->transmitters);
}

TEST_F(RadioFieldCorridor, DrawsLieWhereTheLikelihoodIs) {
  locator_->locate(scan_at(30.0, 0));
  Random random(7);
  std::vector<float> x(500), y(500);
  ASSERT_TRUE(locator_->draw(FloorOrdinal{0}, random, x, y));
  double mean = 0.0;
  for (const float each : x) mean += static_cast<double>(each) / 500.0;
  EXPECT_NEAR(mean, 30.0, 3.0);
  EXPECT_FALSE(locator_->draw(FloorOrdinal{9}, random, x, y));
}

// Two places that sound alike: drawn one by one, one of them would have 1000 draws of 2000, give or take 22.
TEST(RadioField, DrawsShareOutEvenly) {
  std::vector<ReferencePoint> survey;
  for (int walk = 0; walk < 2; ++walk) {
    survey.push_back({{{100.0 * walk, 0.0}, FloorOrdinal{0}}, 0.0, "phone", "walk " + std::to_string(walk), {}, {scan_at(20.0, 0)}});
  }
  const auto locator = std::make_shared<RadioField>(survey, in_step())->make();
  ASSERT_TRUE(locator->locate(scan_at(20.0, 0)));
  std::vector<float> x(2000), y(2000);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    ASSERT_TRUE(locator->draw(FloorOrdinal{0}, random, x, y));
    EXPECT_NEAR(static_cast<double>(std::ranges::count_if(x, [](float each) { return each > 50.0f; })), 1000.0, 1.0) << seed;
  }
}

// Two corners that sound alike, one of them surveyed twenty times as often.
TEST(RadioField, DrawsDoNotFlockToWhereManySurveyed) {
  std::vector<ReferencePoint> survey;
  const auto pass = [&](double x_m, int walk) {
    for (int i = 0; i < 3; ++i) {
      survey.push_back({{{x_m + i, 0.0}, FloorOrdinal{0}}, 0.0, "phone", "walk " + std::to_string(walk), {}, {scan_at(20.0, 0, 0.0, 3.0 * i)}});
    }
  };
  for (int walk = 0; walk < 20; ++walk) pass(0.0, walk);
  pass(40.0, 20);
  const auto locator = std::make_shared<RadioField>(survey, in_step())->make();
  ASSERT_TRUE(locator->locate(scan_at(20.0, 0)));
  Random random(3);
  std::vector<float> x(2000), y(2000);
  ASSERT_TRUE(locator->draw(FloorOrdinal{0}, random, x, y));
  EXPECT_NEAR(static_cast<double>(std::ranges::count_if(x, [](float each) { return each > 20.0f; })), 1000.0, 250.0);
}

TEST_F(RadioFieldCorridor, StrongRadiosNobodyHeardAroundAreImplausible) {
  RssScan scan = scan_at(20.0, 0);
  for (int i = 0; i < 3; ++i) scan.readings.push_back(reading(7, i, -35.0));
  const auto fix = locator_->locate(scan);
  ASSERT_TRUE(fix);
  EXPECT_NEAR(fix->place.point.x_m, 20.0, 3.0);
  EXPECT_EQ(locator_->implausible(FloorOrdinal{0}, {20.0, 0.0}), 3);
  locator_->locate(scan_at(20.0, 0));
  EXPECT_EQ(locator_->implausible(FloorOrdinal{0}, {20.0, 0.0}), 0);
}

// Three halls of one floor, 100 m apart, and a phone where nobody surveyed.
TEST(RadioField, RadiosHeardFromCloseByLiveCloseToEachOther) {
  std::vector<ReferencePoint> survey;
  for (int hall = 0; hall < 3; ++hall) {
    for (int walk = 0; walk < 2; ++walk) {
      for (int i = 0; i <= 30; ++i) {
        RssScan scan = scan_at(1.3 * i, hall, 0.0, i);
        survey.push_back({{{100.0 * hall + 1.3 * i, 0.0}, FloorOrdinal{0}}, 0.0, "phone", std::to_string(2 * hall + walk), {}, {scan}});
      }
    }
  }
  const auto field = std::make_shared<RadioField>(survey, in_step());
  const auto locator = field->make();
  const auto out_of_place = [&](int a, int b, int c) {
    RssScan scan;
    for (int i = 0; i < 40; ++i) scan.readings.push_back(reading(9, i, -70.0));  // of shops that opened since
    scan.readings.push_back(reading(a, 1, -35.0));
    scan.readings.push_back(reading(b, 4, -35.0));
    scan.readings.push_back(reading(c, 7, -35.0));
    EXPECT_TRUE(locator->locate(scan));
    return locator->out_of_place(FloorOrdinal{0}, {150.0, 0.0});
  };
  EXPECT_EQ(out_of_place(1, 1, 1), 0);
  EXPECT_EQ(out_of_place(1, 1, 2), 1);
  EXPECT_EQ(out_of_place(0, 1, 2), 2);
  EXPECT_EQ(out_of_place(2, 2, 2), 3) << "together, but 70 m from the phone";
}

TEST_F(RadioFieldCorridor, NothingKnownIsNoFix) {
  EXPECT_FALSE(locator_->locate(RssScan{}));
  RssScan foreign;
  foreign.readings.push_back(reading(9, 9, -70.0));
  EXPECT_FALSE(locator_->locate(foreign));
  EXPECT_EQ(locator_->transmitters_unknown(), 1);
}

TEST_F(RadioFieldCorridor, ACloneAnswersTheSameWhileAScanIsAtHand) {
  locator_->locate(scan_at(25.0, 0));
  const auto clone = locator_->clone();
  const float before = likelihood(25.0f, 1.0f, 0);
  locator_->rest();
  float value = 0.0f;
  const float x_m = 25.0f, y_m = 1.0f;
  clone->add_log_likelihood({&x_m, 1}, {&y_m, 1}, FloorOrdinal{0}, {&value, 1});
  EXPECT_EQ(value, before);
}

TEST(RadioField, AnEmptySurveyAnswersNothing) {
  const auto field = std::make_shared<RadioField>(std::span<const ReferencePoint>{}, RadioFieldSettings{});
  EXPECT_FALSE(field->make()->locate(scan_at(1.0, 0)));
}

// Upstairs somebody stood twice only; its own radios are heard there, and those below through the ceiling.
TEST(RadioField, AFloorSurveyedAtTwoPointsCanBeVotedFor) {
  auto survey = corridor();
  const auto upstairs = [](double x_m) {
    RssScan scan = scan_at(x_m, 2);
    for (const ScanReading& below : scan_at(x_m, 1, -6.0).readings) scan.readings.push_back(below);
    return scan;
  };
  for (const double x_m : {10.0, 14.0}) survey.push_back({{{x_m, 0.0}, FloorOrdinal{2}}, 0.0, "phone", "", {}, {upstairs(x_m)}});
  const auto field = std::make_shared<RadioField>(survey, in_step());
  const auto locator = field->make();
  ASSERT_TRUE(locator->locate(upstairs(12.0)));
  EXPECT_EQ(locator->floors().front().floor, FloorOrdinal{2});
}

TEST(RadioField, LearntWeightsStayNearTheirStandardWhereTheSurveyIsSilent) {
  std::vector<ReferencePoint> one = {{{{1.0, 1.0}, FloorOrdinal{0}}, 0.0, "phone", "", {}, {scan_at(1.0, 0), scan_at(1.0, 0)}}};
  const RadioField field(one, RadioFieldSettings{});
  EXPECT_DOUBLE_EQ(field.weights().sorensen, FieldWeights{}.sorensen);
}

TEST(RadioField, LearnsFromWalksLeavingEachOut) {
  const auto survey = corridor();
  const RadioField field(survey, RadioFieldSettings{});
  EXPECT_GT(field.weights().sorensen, 1.0);
}

TEST(SurveyFingerprints, AHotSpotThatPassedByIsNoRadio) {
  auto survey = corridor();
  ScanReading hot_spot = reading(5, 5, -50.0);
  hot_spot.bssid.value |= std::uint64_t{0x02} << 40;
  survey[3].scans[0].readings.push_back(hot_spot);
  survey[4].scans[0].readings.push_back(hot_spot);
  const SurveyReading read = read_survey(survey, {});
  EXPECT_FALSE(read.radios.find(RadioNames::key(hot_spot)));
  EXPECT_TRUE(read.radios.find(RadioNames::key(reading(0, 0, -50.0))));
}

TEST(SurveyFingerprints, ReadingsAreMatchedWhereTheyBelongInTime) {
  // With a delay of 2 s what was stamped at x = 0 belongs 2 s of walking on: 2.6 m.
  const SurveyReading read = read_survey(corridor(), SurveyReadingSettings{});
  ASSERT_FALSE(read.fingerprints.empty());
  const SurveyFingerprint& second = read.fingerprints[1];  // 2 s after the first place of walk 0: at 2.6 m
  EXPECT_NEAR(second.place.point.x_m, 2.6, 1e-6);
  const auto strongest = std::ranges::max_element(second.heard, {}, &RadioStrength::strength);
  EXPECT_EQ(strongest->radio, *read.radios.find(RadioNames::key(reading(0, 0, -50.0))));
}

}  // namespace
}  // namespace wayfuse
