#include "server/zones/zone_presence.hpp"

#include <algorithm>
#include <cstdlib>

namespace wayfuse {
namespace {

constexpr Duration kLongestInterval = std::chrono::seconds(30);  // a phone unheard for longer has not stood there all the time
constexpr double kWalkAFloor_m = 12.0;                           // stairs and the way to them

double credit_of(Duration passed, double walked_m, const ZoneRules& rules) {
  const double stood = rules.settle_at_rest > Duration{0}
                           ? seconds(std::clamp(passed, Duration{0}, kLongestInterval)) / seconds(rules.settle_at_rest)
                           : 1.0;
  const double walked = rules.settle_m > 0.0 ? std::max(walked_m, 0.0) / rules.settle_m : 1.0;
  return stood + walked;
}

double apart_m(const Place& a, const Place& b) {
  return distance_m(a.point, b.point) + kWalkAFloor_m * std::abs(a.floor.value - b.floor.value);
}

// Adds up while the evidence stands, begins anew when it does not.
void gather(double& credit, bool stands, bool stood_before, double gain) {
  credit = !stands ? 0.0 : stood_before ? credit + gain : 1e-9;
}

}  // namespace

ZonePresence::Change ZonePresence::take(const Evidence& evidence, const ZoneRecord& zone, const ZoneRules& rules) {
  const double gain = seen_at_ ? credit_of(evidence.at - *seen_at_, evidence.walked_m, rules) : 0.0;
  seen_at_ = evidence.at;
  mass_ = evidence.mass;
  const bool says_in = evidence.mass >= rules.enter;
  const bool says_out = evidence.mass <= rules.leave;
  const bool says_beyond = evidence.mass_tolerated <= rules.leave;
  note_side(inside_ ? says_out : says_in, evidence);
  if (!inside_) {
    gather(credit_in_, says_in, credit_in_ > 0.0, gain);
    if (credit_in_ < 1.0) return Change::kNone;
    const bool withdrawn = withdraws(rules);
    *this = ZonePresence();
    inside_ = true;
    mass_ = evidence.mass;
    seen_at_ = changed_at_ = evidence.at;
    last_on_side_ = evidence.place;
    radius95_on_side_m_ = evidence.radius95_m;
    return withdrawn ? Change::kExitWithdrawn : Change::kEntered;
  }
  gather(credit_out_, says_out, credit_out_ > 0.0, gain);
  gather(credit_beyond_, says_beyond, credit_beyond_ > 0.0, gain);
  const auto since = [&](std::optional<ServerTime>& begin, double credit) {
    if (credit < 1.0) return begin.reset();
    if (!begin) begin = evidence.at;
  };
  since(out_since_, credit_out_);
  since(beyond_since_, credit_beyond_);
  if (beyond_since_ && withdraws(rules)) {
    leave(evidence.at);
    return Change::kEntryWithdrawn;
  }
  return exit_if_due(evidence.at, zone);
}

ZonePresence::Change ZonePresence::tick(ServerTime now, const ZoneRecord& zone, const ZoneRules& rules) {
  if (!inside_) {
    if (changed_at_ && now - *changed_at_ > rules.corrected_within) changed_at_.reset();
    return Change::kNone;
  }
  if (zone.timeout && seen_at_ && now - *seen_at_ >= *zone.timeout) return leave(now);
  return exit_if_due(now, zone);
}

// The earlier of the two ways out, told `exit_delay` later; an infinite wait never ends.
ZonePresence::Change ZonePresence::exit_if_due(ServerTime now, const ZoneRecord& zone) {
  std::optional<ServerTime> due = beyond_since_;
  if (out_since_ && zone.tolerance_timeout) {
    const ServerTime tolerated = *out_since_ + *zone.tolerance_timeout;
    due = due ? std::min(*due, tolerated) : tolerated;
  }
  if (!due || !zone.exit_delay || now < *due + *zone.exit_delay) return Change::kNone;
  return leave(now);
}

ZonePresence::Change ZonePresence::leave(ServerTime now) {
  const double mass = mass_;
  const auto seen = seen_at_;
  const auto place = last_on_side_;
  *this = ZonePresence();
  mass_ = mass;
  seen_at_ = seen;
  changed_at_ = now;
  last_on_side_ = place;
  return Change::kLeft;
}

// Whether the phone came to the other side by a jump: further than it walked, and out of the circle it was said to be in.
void ZonePresence::note_side(bool other_side, const Evidence& evidence) {
  if (!other_side) {
    last_on_side_ = evidence.place;
    radius95_on_side_m_ = evidence.radius95_m;
    walked_off_side_m_ = 0.0;
    off_side_since_.reset();
    jumped_ = false;
    return;
  }
  walked_off_side_m_ += evidence.walked_m;
  if (off_side_since_) return;
  off_side_since_ = evidence.at;
  jumped_ = last_on_side_ && apart_m(*last_on_side_, evidence.place) > walked_off_side_m_ + radius95_on_side_m_;
}

bool ZonePresence::withdraws(const ZoneRules& rules) const {
  return jumped_ && changed_at_ && off_side_since_ && *off_side_since_ - *changed_at_ <= rules.corrected_within;
}

}  // namespace wayfuse
