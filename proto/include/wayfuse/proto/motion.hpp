#pragma once

#include <cstdint>
#include <optional>

#include "wayfuse/proto/heading.hpp"
#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// What a phone's heading is measured against.
enum class HeadingReference : std::uint8_t {
  kMagnetic,   ///< magnetic east/north: the server adds declination and frame rotation
  kTrue,       ///< true east/north
  kArbitrary,  ///< an unknown but slowly drifting origin: gyroscope only
};

/// How the walker moved over one interval, as computed on the phone.
struct MotionReport {
  PhoneTime time;                        ///< end of the interval
  Duration interval{0};                  ///< its length, 0..60 s
  Heading heading;                       ///< walking direction at the end, against `reference`
  double heading_sigma_rad = 0.0;        ///< 1 standard deviation, 0..pi
  HeadingReference reference = HeadingReference::kMagnetic;
  double turn_rate_radps = 0.0;          ///< mean over the interval, counter-clockwise positive, within 2,000 deg/s
  std::uint16_t steps = 0;               ///< completed in the interval
  double step_length_m = 0.0;            ///< mean of those steps, 0..3
  std::optional<double> speed_mps;       ///< mean horizontal speed, 0..20, where the phone knows it apart from steps
  double distance_sigma_m = 0.0;         ///< of the distance covered in the interval
  bool turning = false;
  bool at_rest = false;                  ///< lying or standing still: zero displacement
  std::optional<double> climb_m;         ///< change of height in the interval (barometer, stairs, lift)
  std::optional<double> field_horizontal_ut;  ///< magnetic field, horizontal part
  std::optional<double> field_vertical_ut;    ///< downward part
  bool operator==(const MotionReport&) const = default;

  /// Distance covered: steps times length, else speed times interval, 0 at rest.
  double distance_m() const;
};

/// A satellite fix, for hand-over at doors.
struct GnssFix {
  PhoneTime time;
  GeoPoint point;
  double sigma_m = 0.0;                  ///< per horizontal axis, 0..10 km
  std::optional<double> speed_mps;
  std::optional<double> course_azimuth_rad;  ///< true, clockwise from north
  bool operator==(const GnssFix&) const = default;
};

}  // namespace wayfuse
