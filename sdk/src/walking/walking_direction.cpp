#include "sdk/src/walking/walking_direction.hpp"

#include <algorithm>
#include <numbers>

namespace wayfuse {

void WalkingDirection::feed(const WalkingDirectionSettings& s, Vector3 acceleration, double turned_rad, double dt_s, bool walking) {
  if (!started_ || dt_s > 1.0) {
    first_ = second_ = acceleration;
    mean_x_ = acceleration.x;
    mean_y_ = acceleration.y;
    started_ = true;
    return;
  }
  if (dt_s <= 0.0) return;
  const double x = 2.0 * std::numbers::pi * 3.0 * dt_s, gain = x / (1.0 + x), slow = std::min(1.0, dt_s / 3.0);
  const double before = second_.z;
  first_ = first_ + (acceleration - first_) * gain;
  second_ = second_ + (first_ - second_) * gain;
  mean_x_ += slow * (second_.x - mean_x_);
  mean_y_ += slow * (second_.y - mean_y_);
  // The average turns with the walker.
  const double c = std::cos(turned_rad), sn = std::sin(turned_rad);
  const double ahead_x = c * ahead_x_ - sn * ahead_y_, ahead_y = sn * ahead_x_ + c * ahead_y_;
  ahead_x_ = ahead_x;
  ahead_y_ = ahead_y;
  if (!walking) return;
  walked_s_ = std::min(walked_s_ + dt_s, s.memory_s);
  const double share = std::min(1.0, dt_s / std::max(walked_s_, 1.0)), change = (second_.z - before) / dt_s;
  ahead_x_ += share * ((second_.x - mean_x_) * change - ahead_x_);
  ahead_y_ += share * ((second_.y - mean_y_) * change - ahead_y_);
}

void WalkingDirection::carry(const WalkingDirectionSettings& s, Vector3 rate, Vector3 up, double dt_s, bool at_rest) {
  const double gain = carried_ ? std::min(1.0, dt_s / 1.5) : 1.0;
  square_rate_ += gain * (dot(rate, rate) - square_rate_);
  up_ = up_ + (up - up_) * gain;
  carried_ = true;
  const double turning = std::sqrt(square_rate_);
  const Carrying before = carrying;
  if (at_rest && std::abs(up_.z) > 0.95) carrying = Carrying::kLying;
  else if (turning > s.swinging_rate_radps) carrying = Carrying::kSwinging;
  else if (turning > s.held_rate_radps) carrying = Carrying::kPocket;
  else if (up_.z > 0.25 && std::abs(up_.x) < 0.5) carrying = Carrying::kHeld;
  else if (std::abs(up_.x) > 0.35 && up_.z < 0.5) carrying = Carrying::kCalling;
  else if (up_.y > 0.75) carrying = Carrying::kHeld;  // upright before the face
  else carrying = Carrying::kPocket;
  const auto worn = [](Carrying how) { return how == Carrying::kPocket || how == Carrying::kSwinging; };
  if (carrying != before && !(worn(carrying) && worn(before))) walked_s_ = std::min(walked_s_, 1.0);  // look afresh
}

bool WalkingDirection::by_gait(const WalkingDirectionSettings& s, double swing_mps2) const {
  const bool odd = carrying == Carrying::kCalling || carrying == Carrying::kPocket || carrying == Carrying::kSwinging;
  return odd && walked_s_ >= s.trust_after_s && swing_mps2 < s.running_swing_mps2 && ahead_x_ * ahead_x_ + ahead_y_ * ahead_y_ > 1e-12;
}

Heading WalkingDirection::direction(const WalkingDirectionSettings& s, const Attitude& attitude, double swing_mps2) const {
  if (!by_gait(s, swing_mps2)) return facing_of(attitude.body_to_enu);
  const Quaternion d = attitude.body_to_enu * conjugate(attitude.body_to_level);
  return Heading::from_vector(ahead_x_, ahead_y_).turned_by(2.0 * std::atan2(d.z, d.w));
}

double WalkingDirection::sigma_rad(const WalkingDirectionSettings& s, const Attitude& attitude, double swing_mps2) const {
  double extra = s.held_sigma_rad;
  if (by_gait(s, swing_mps2)) extra = s.gait_sigma_rad;
  else if (carrying == Carrying::kCalling || carrying == Carrying::kPocket || carrying == Carrying::kSwinging) extra = 1.8;
  return std::clamp(std::hypot(attitude.heading_sigma_rad, extra), 0.0, std::numbers::pi);
}

}  // namespace wayfuse
