#include "server/pipeline/second_opinion.hpp"

#include <algorithm>
#include <utility>

namespace wayfuse {
namespace {

// Of a distance in signal space. A scan from unsurveyed ground speaks for wherever it is least unlike: more is asked of it, and one
// that fits nothing is not asked at all.
constexpr double kContradicts = 0.05;
constexpr double kContradictsOffSurvey = 0.2;
constexpr double kMostOfAScan = 8.0;       // log Bayes factor: no scan is surer than that
constexpr double kWins = 1.6;
constexpr double kLoses = -1.0;
constexpr double kLosesForGood = -4.0;     // who was the track before it lost: scans in a row err alike, and may right themselves
constexpr int kScans = 8;                  // undecided by then, there is nothing to decide
constexpr double kSame_m = 8.0;            // both speak for one place

}  // namespace

bool SecondOpinion::contradicts(double misfit, double mismatch) {
  return mismatch < kFitsNothing && misfit > (mismatch > kSurveyed ? kContradictsOffSurvey : kContradicts);
}

void SecondOpinion::begin(const WalkerSettings& settings, Locator& locator, FloorOrdinal floor, const WalkableArea::Plan* plan,
                          BuildingPoint carried, const CompassPrior& compass, Random& random, double lead) {
  rival_ = std::make_unique<Rival>(Rival{WalkerCloud(settings), floor, lead * kWins, 0, false});
  rival_->cloud.enter(plan);
  rival_->cloud.start_from(locator, floor, carried, compass, random);
  if (!rival_->cloud.started()) drop();
}

bool SecondOpinion::speaks_for(Place place) const {
  return rival_ && rival_->floor == place.floor && distance_m(rival_->cloud.spread().mean, place.point) < kSame_m;
}

void SecondOpinion::walk(double dx_m, double dy_m, double sigma_m, double on_foot_s, Random& random) {
  if (rival_) rival_->cloud.walk(dx_m, dy_m, sigma_m, on_foot_s, random);
}

bool SecondOpinion::hear(Locator& locator, const First& first, BuildingPoint carried, double echo, const CompassPrior& compass, Random& random) {
  if (!rival_) return false;
  WalkerCloud& cloud = rival_->cloud;
  const double ahead = cloud.weigh(locator, rival_->floor, carried, echo).log_evidence - first.log_evidence;
  // Who was the track stays what it was: drawn to where the scans say, it would be nobody's opinion.
  if (!rival_->unseated) cloud.renew(cloud.renewed(), locator, rival_->floor, carried, compass, random);
  cloud.settle(random);
  const bool may_gain = first.contradicted || rival_->unseated;
  rival_->lead += (1.0 - echo) * std::clamp(ahead, -kMostOfAScan, may_gain ? kMostOfAScan : 0.0);
  if (rival_->lead >= kWins) return true;
  if (speaks_for({first.mean, first.floor}) || rival_->lead <= (rival_->unseated ? kLosesForGood : kLoses) || ++rival_->heard >= kScans) drop();
  return false;
}

void SecondOpinion::change_places(WalkerCloud& track, FloorOrdinal& floor) {
  std::swap(track, rival_->cloud);
  std::swap(floor, rival_->floor);
  rival_->lead = 0.0;
  rival_->heard = 0;
  rival_->unseated = true;
}

}  // namespace wayfuse
