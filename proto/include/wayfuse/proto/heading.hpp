#pragma once

#include <cmath>
#include <numbers>

namespace wayfuse {

/// Wraps any finite angle to (-pi, pi].
inline double wrap_angle_rad(double angle_rad) {
  const double wrapped = std::remainder(angle_rad, 2.0 * std::numbers::pi);
  return wrapped <= -std::numbers::pi ? std::numbers::pi : wrapped;
}

/// A horizontal direction: radians from the x axis (east), counter-clockwise, always in (-pi, pi].
///
/// The only convention inside wayfuse. A compass azimuth (from the y axis, north, clockwise) exists at the edges only: in
/// JSON, on screens and in formulas of [P2] and [P5].
class Heading {
 public:
  constexpr Heading() = default;
  static Heading from_radians(double angle_rad) { return Heading(wrap_angle_rad(angle_rad)); }
  static Heading from_azimuth(double azimuth_rad) { return Heading(wrap_angle_rad(std::numbers::pi / 2 - azimuth_rad)); }
  /// Of the vector (x, y); (0, 0) gives heading 0.
  static Heading from_vector(double x, double y) { return Heading(wrap_angle_rad(std::atan2(y, x))); }

  double radians() const { return angle_rad_; }
  /// Clockwise from the y axis, in [0, 2 pi).
  double azimuth_rad() const {
    const double azimuth = std::numbers::pi / 2 - angle_rad_;
    return azimuth < 0 ? azimuth + 2 * std::numbers::pi : azimuth;
  }
  double cos() const { return std::cos(angle_rad_); }
  double sin() const { return std::sin(angle_rad_); }

  Heading turned_by(double angle_rad) const { return from_radians(angle_rad_ + angle_rad); }
  /// The turn that leads from `from` to this one, in (-pi, pi].
  double minus(Heading from) const { return wrap_angle_rad(angle_rad_ - from.angle_rad_); }

  bool operator==(const Heading&) const = default;

 private:
  explicit constexpr Heading(double angle_rad) : angle_rad_(angle_rad) {}
  double angle_rad_ = 0.0;
};

}  // namespace wayfuse
