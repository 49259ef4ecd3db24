#include "server/tracking/heading_filter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "wayfuse/proto/heading.hpp"

namespace wayfuse {
namespace {
constexpr double kMostVariance = std::numbers::pi * std::numbers::pi / 3.0;  // of a heading nobody knows: uniform
}

void HeadingFilter::start(double heading_rad, double sigma_rad) {
  heading_rad_ = wrap_angle_rad(heading_rad);
  variance_rad2_ = std::min(sigma_rad * sigma_rad, kMostVariance);
  started_ = true;
}

void HeadingFilter::predict(double turn_rad, double dt_s) {
  heading_rad_ = wrap_angle_rad(heading_rad_ + turn_rad);
  const double q = settings_.turn_sigma_rad_rts * settings_.turn_sigma_rad_rts * std::max(0.0, dt_s);
  variance_rad2_ = std::min(variance_rad2_ + q, kMostVariance);
}

void HeadingFilter::update(double track_heading_rad, double track_m) {
  if (!(track_m > 0.0)) return;
  const double sigma_rad = settings_.track_sigma_m / track_m;
  update_with_variance(track_heading_rad, sigma_rad * sigma_rad);
}

void HeadingFilter::update_with_variance(double measured_rad, double variance_rad2) {
  const double gain = variance_rad2_ / (variance_rad2_ + variance_rad2);
  if (!std::isfinite(gain)) return;
  heading_rad_ = wrap_angle_rad(heading_rad_ + gain * wrap_angle_rad(measured_rad - heading_rad_));
  variance_rad2_ *= 1.0 - gain;
}

}  // namespace wayfuse
