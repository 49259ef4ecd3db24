#include "sdk/src/walking/lift_detector.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/src/attitude/rotation.hpp"

namespace wayfuse {
namespace {

constexpr double kGapS = 0.5;
constexpr double kWalkedS = 1.0;
constexpr double kStillMps2 = 0.06;       // of the smoothed acceleration: before this, nothing has begun
constexpr double kBusyBaselineS = 10.0;   // walking averages out, slowly
constexpr double kCruiseBaselineS = 4.0;
constexpr double kLeastKept = 0.6, kMostKept = 1.7, kUnevenS = 1.0;   // of its speed, while a lift cruises
constexpr double kHandledBaselineS = 0.7;  // taken out of a pocket

}  // namespace

void LiftDetector::begin_anew(const Felt& now) {
  LiftDetector anew;
  anew.first_ = anew.low_ = anew.baseline_ = now.up_mps2;
  anew.up_ = now.up;
  anew.started_ = true;
  anew.ride_ = riding() ? before_ : ride_;
  anew.told_m_ = told_m_;
  anew.ended_ = ended_;
  *this = anew;
}

// What looked like a ride was none.
void LiftDetector::give_up() {
  if (riding()) ride_ = before_;
  phase_ = Phase::kStanding;
  stands_s_ = stood_s_ = 0.0;
}

void LiftDetector::follow(const Felt& now, double memory_s) {
  const double gain = std::min(1.0, now.dt_s / memory_s);
  baseline_ += gain * (low_ - baseline_);
  up_ = up_ + (now.up - up_) * gain;
}

void LiftDetector::feed(const LiftDetectorSettings& s, const Felt& now) {
  if (!started_ || now.dt_s > kGapS) return begin_anew(now);
  if (now.dt_s <= 0.0) return;
  const double gain = now.dt_s / (s.smooth_s + now.dt_s);
  first_ += gain * (now.up_mps2 - first_);
  low_ += gain * (first_ - low_);
  const double fast = now.up_mps2 - low_;
  shake_ += std::min(1.0, now.dt_s / s.shake_s) * (fast * fast - shake_);
  height_m_ = now.height_m;
  const double felt = low_ - baseline_;
  const bool tilted = norm(now.up - up_) > s.tilts_rad;
  const bool walked = now.step && seconds(now.time - *now.step) < kWalkedS;
  const bool quiet = !walked && !tilted && shake_ < s.quiet_mps2 * s.quiet_mps2;
  stands_s_ = quiet ? stands_s_ + now.dt_s : 0.0;
  if (phase_ == Phase::kStanding) stand(s, now, felt, quiet);
  // On the way there is no acceleration but the pulses': what is felt in between is the sensor's error.
  if (phase_ != Phase::kCruising || std::abs(felt) > s.begins_mps2) speed_mps_ += felt * now.dt_s;
  rise_m_ += speed_mps_ * now.dt_s;
  pulse_s_ += now.dt_s;
  lasted_s_ += now.dt_s;
  if (phase_ != Phase::kStanding) return carry_on(s, now, felt, tilted);
  if (std::abs(felt) < s.begins_mps2 || stood_s_ < s.stands_s) return;
  phase_ = Phase::kStarting;
  up_ = now.up;
}

// Nothing has begun yet: gravity is followed, and the sums start where the acceleration leaves it.
void LiftDetector::stand(const LiftDetectorSettings& s, const Felt& now, double felt, bool quiet) {
  follow(now, quiet && std::abs(felt) < s.begins_mps2 ? s.baseline_s : kBusyBaselineS);
  const bool shaken = shake_ > s.startles_mps2 * s.startles_mps2;
  if (std::abs(felt) >= kStillMps2 && felt * speed_mps_ >= 0.0 && !shaken && stood_s_ >= s.stands_s) return;
  since_ = now.time;
  stood_s_ = stands_s_;
  speed_mps_ = rise_m_ = pulse_s_ = lasted_s_ = peak_mps2_ = top_mps_ = handled_s_ = uneven_s_ = 0.0;
  height_at_start_m_ = now.height_m;
}

void LiftDetector::carry_on(const LiftDetectorSettings& s, const Felt& now, double felt, bool tilted) {
  const bool handled = tilted || shake_ > s.restless_mps2 * s.restless_mps2;
  handled_s_ = handled ? handled_s_ + now.dt_s : 0.0;
  const double patience_s = phase_ == Phase::kStarting ? 0.0 : s.handled_s;   // what begins while handled is the hand
  const bool walks = now.step && *now.step > since_;
  const bool endless = lasted_s_ > s.most_ride_s || std::abs(speed_mps_) > s.most_speed_mps;
  if (walks || endless || handled_s_ > patience_s) return give_up();
  switch (phase_) {
    case Phase::kStarting: start(s, felt); break;
    case Phase::kCruising: cruise(s, now, felt); break;
    case Phase::kStopping: stop(s, now.time, felt); break;
    case Phase::kSettling:
      settled_s_ += now.dt_s;
      if (std::abs(felt) > s.begins_mps2) {   // it did not stop, or the hand goes on
        if (felt * top_mps_ < 0.0) return give_up();
        phase_ = Phase::kCruising;
        break;
      }
      if (settled_s_ >= s.settles_s) return arrive(s);
      break;
    case Phase::kStanding: break;
  }
  if (phase_ == Phase::kCruising || riding()) believe(s, now.time);
}

void LiftDetector::start(const LiftDetectorSettings& s, double felt) {
  peak_mps2_ = std::max(peak_mps2_, std::abs(felt));
  if (pulse_s_ > s.most_pulse_s || peak_mps2_ > s.most_peak_mps2) {
    baseline_ = low_;   // no lift pushes so long or so hard
    return give_up();
  }
  if (felt * speed_mps_ > 0.0 && std::abs(felt) > s.ends_mps2) return;
  if (pulse_s_ < s.least_pulse_s || peak_mps2_ < s.least_peak_mps2 || std::abs(speed_mps_) < s.least_speed_mps) return give_up();
  top_mps_ = speed_mps_;
  phase_ = Phase::kCruising;
}

void LiftDetector::cruise(const LiftDetectorSettings& s, const Felt& now, double felt) {
  if (std::abs(felt) < s.begins_mps2) {
    const double kept = speed_mps_ / top_mps_;
    uneven_s_ = kept < kLeastKept || kept > kMostKept ? uneven_s_ + now.dt_s : 0.0;
    if (uneven_s_ > kUnevenS) return give_up();   // a hand that stopped half way
    return follow(now, handled_s_ > 0.0 ? kHandledBaselineS : kCruiseBaselineS);
  }
  if (felt * top_mps_ > 0.0) return;
  phase_ = Phase::kStopping;
  pulse_s_ = 0.0;
  up_ = now.up;
}

void LiftDetector::stop(const LiftDetectorSettings& s, PhoneTime time, double felt) {
  if (pulse_s_ > s.most_pulse_s) return give_up();
  if (felt * top_mps_ < 0.0 && std::abs(felt) > s.ends_mps2) return;
  if (std::abs(speed_mps_) > s.stopped * std::abs(top_mps_)) {
    if (speed_mps_ * top_mps_ < 0.0) return give_up();
    phase_ = Phase::kCruising;   // a hand sank and comes back
    return;
  }
  phase_ = Phase::kSettling;
  stopped_ = time;
  settled_s_ = 0.0;
}

std::optional<double> LiftDetector::climbed() const {
  if (!height_m_ || !height_at_start_m_) return std::nullopt;
  return *height_m_ - *height_at_start_m_;
}

// Under way: further than an arm reaches, and still going; a barometer must have begun to see it.
void LiftDetector::believe(const LiftDetectorSettings& s, PhoneTime time) {
  if (!riding()) {
    const bool going = std::abs(rise_m_) >= s.reach_m && std::abs(speed_mps_) >= 0.5 * std::abs(top_mps_) && stands_s_ >= s.stands_s;
    const auto climbed_m = climbed();
    if (!going || (climbed_m && *climbed_m * top_mps_ < s.least_seen_m * std::abs(top_mps_))) return;
    before_ = ride_;
    ride_ = LiftRide{since_, time, 0.0, 0.0, true};
  }
  ride_->end = time;
  ride_->rise_m = rise_m_;
  ride_->rise_sigma_m = std::hypot(s.rise_sigma_m, s.speed_sigma_mps * lasted_s_);
}

void LiftDetector::arrive(const LiftDetectorSettings& s) {
  const double lasted_s = lasted_s_ - settled_s_;
  // The second pulse's impulse less the first one's: half of it was missing, or too much, all the way.
  const double left_mps = speed_mps_, rise_m = rise_m_ - left_mps * (settled_s_ + 0.5 * lasted_s);
  const bool far = std::abs(rise_m) >= s.least_rise_m && rise_m * top_mps_ > 0.0 && std::abs(rise_m) >= s.least_mean_mps * lasted_s;
  const bool contradicted = climbed() && std::abs(*climbed() - rise_m) > std::max(s.disagrees_m, 0.4 * std::abs(rise_m));
  if (!far || contradicted) return give_up();
  ride_ = LiftRide{since_, stopped_, rise_m, std::hypot(s.rise_sigma_m, s.speed_sigma_mps * lasted_s / std::sqrt(2.0)), false};
  if (const auto climbed_m = climbed()) {
    const double felt_weight = 1.0 / (ride_->rise_sigma_m * ride_->rise_sigma_m);
    const double seen_weight = 1.0 / (s.barometer_sigma_m * s.barometer_sigma_m);
    ride_->rise_m = (felt_weight * rise_m + seen_weight * *climbed_m) / (felt_weight + seen_weight);
    ride_->rise_sigma_m = 1.0 / std::sqrt(felt_weight + seen_weight);
  }
  told_m_ += ride_->rise_m;
  ended_ = true;
  phase_ = Phase::kStanding;
  stands_s_ = stood_s_ = 0.0;
}

std::optional<double> LiftDetector::take() {
  if (!ended_) return std::nullopt;
  const double rise_m = told_m_;
  told_m_ = 0.0;
  ended_ = false;
  return rise_m;
}

}  // namespace wayfuse
