#include <algorithm>
#include <array>
#include <cmath>

#include "server/pipeline/field_tracker.hpp"
#include "server/pipeline/reckoning.hpp"

// When a field tracker gives its track up for another one: a phone that was carried off, or a track that was never right.

namespace wayfuse {
namespace {

constexpr double kFewAgree = 0.25;           // of the cloud with a scan
constexpr std::size_t kDrawn = 64;           // places that speak for a scan
constexpr double kOutdone = 5.0;             // log-likelihood they are ahead by; honest tracks begin to suffer at 3
constexpr double kOutdoneForGood = 12.0;     // no scan of an honest walk was as far ahead, but where its track was lost
constexpr double kHeadStart = 0.5;            // of what it takes to win, for a rival whose places were ahead by kOutdone
constexpr int kScansElsewhere = 3;           // in a row: one scan errs, three do not err so far alike

}  // namespace

// Before the scan is weighed: does it fit where the track is? True when scans have gone elsewhere for good: a phone that was
// carried off is looked for where they say, on whatever floor.
bool FieldTracker::astray(const Fix& fix, BuildingPoint carried) {
  const auto misfit = locator_->misfit(*floor_, minus(cloud_.spread().mean, carried));
  contradicted_ = misfit && SecondOpinion::contradicts(*misfit, locator_->mismatch());
  if (!misfit || locator_->mismatch() > SecondOpinion::kSurveyed) return false;  // where nobody surveyed, scans speak for wherever it is least unlike
  watch_.compare(*misfit, {plus(fix.place.point, carried), fix.place.floor}, *newest_);
  return watch_.elsewhere();
}

// How far places drawn from the newest scan alone are ahead of the track in foretelling it, log-likelihood; 0 where it cannot say. A
// track may be a little way off, where the survey about it still resembles the scan.
double FieldTracker::outdone(double log_evidence) const {
  if (locator_->mismatch() > SecondOpinion::kFitsNothing) return 0.0;
  std::array<float, kDrawn> x_m, y_m, gained{};
  Random random = random_;  // nobody's track depends on having asked
  const FloorOrdinal there = votes_.front().floor;
  if (!locator_->draw(there, random, x_m, y_m)) return 0.0;
  locator_->add_log_likelihood(x_m, y_m, there, gained);
  const double best = static_cast<double>(std::ranges::max(gained));
  double likelihood = 0.0;
  for (const float each : gained) likelihood += std::exp(static_cast<double>(each) - best) / kDrawn;
  return best + std::log(likelihood) - log_evidence;
}

// True when the track was given up for another one that foretells the scans better.
bool FieldTracker::second_opinion(double log_evidence, const Fix& fix, BuildingPoint carried) {
  if (!parts_->settings.second_opinion) return false;
  const double behind = outdone(log_evidence);
  const bool surveyed = locator_->mismatch() <= SecondOpinion::kSurveyed;  // elsewhere it takes more to be contradicted, and another scan to be left
  if (surveyed && behind > kOutdoneForGood && !watch_.copied()) {
    watch_.left_at_once(*newest_);
    give_up(fix, carried);
    return true;
  }
  const bool outdone_by_far = behind > (surveyed ? kOutdone : kOutdoneForGood);
  contradicted_ = contradicted_ || outdone_by_far;
  const SecondOpinion::First first{log_evidence, contradicted_, second_.begun() ? cloud_.spread().mean : BuildingPoint{}, *floor_};
  if (second_.hear(*locator_, first, carried, echo(), compass(), random_)) {
    change_places();
    return true;
  }
  if (second_.begun() || !contradicted_) return false;
  const FloorOrdinal there = votes_.front().floor;
  second_.begin(parts_->settings, *locator_, there, parts_->walkable.plan(there), carried, compass(), random_, outdone_by_far && surveyed ? kHeadStart : 0.0);
  return false;
}

// Scans have gone elsewhere for good: the rival that is there already becomes the track, or one begun from the newest scan, which
// has then said all that it can (true). The old track is heard on as the rival.
bool FieldTracker::give_up(const Fix& fix, BuildingPoint carried) {
  const Place there{plus(fix.place.point, carried), votes_.front().floor};
  const bool anew = !second_.speaks_for(there);
  if (anew) second_.begin(parts_->settings, *locator_, there.floor, parts_->walkable.plan(there.floor), carried, compass(), random_);
  if (!second_.begun()) return false;
  change_places();
  if (!parts_->settings.second_opinion) second_.drop();
  return anew;
}

void FieldTracker::change_places() {
  FloorOrdinal floor = *floor_;
  second_.change_places(cloud_, floor);
  stand_on(floor);
}

// Where the winner stands, whatever floor the newest scan votes for: it won by several, and its walkers are there.
void FieldTracker::stand_on(FloorOrdinal floor) {
  if (floor != *floor_) {
    floors_ = votes_;
    const auto own = std::ranges::find(floors_, floor, &FloorProbability::floor);
    if (own != floors_.end()) std::swap(own->probability, floors_.front().probability);
    most_probable_first(floors_);
    floor_ = floor;
  }
  cloud_.enter(parts_->walkable.plan(floor));
}

// Scan after scan speaks for another place than the cloud's [SAFETY C16].
bool FieldTracker::elsewhere(double agreeing) {
  const bool trusted = locator_->mismatch() < kFits;  // where nobody surveyed, scans speak for wherever it is least unlike
  scans_elsewhere_ = trusted && agreeing < kFewAgree ? scans_elsewhere_ + 1 : 0;
  if (scans_elsewhere_ < kScansElsewhere) return false;
  scans_elsewhere_ = 0;
  return true;
}

}  // namespace wayfuse
