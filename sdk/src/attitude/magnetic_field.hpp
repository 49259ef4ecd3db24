#pragma once

#include <cstdint>

#include "sdk/src/attitude/rotation.hpp"
#include "wayfuse/proto/place.hpp"

namespace wayfuse {

using Matrix3 = double[3][3];

/// Sums over some time of what the magnetometer said, in the body and turned into the inertial frame.
struct MagneticSums {
  double count = 0.0;
  Vector3 body;              ///< sum of m
  Vector3 inertial;          ///< sum of R m
  Matrix3 rotation = {};     ///< sum of R
  double square = 0.0;       ///< sum of |m|^2

  void add(const MagneticSums& other);
  /// Forgets: scales everything.
  void scale(double factor);
};

struct HardIronSettings {
  double ridge = 0.02;              ///< pulls towards none; larger = slower and safer
  double accept_ratio = 0.2;        ///< residual variance after/before at and below which the solution is taken whole
  double refuse_ratio = 0.4;        ///< at and above which it is refused; linear between
  double floor_ut = 0.7;            ///< residual of a perfect fit
  double most_ut = 200.0;           ///< larger offsets are not believed
  double step_ut = 3.0;             ///< left unexplained over a few seconds: a magnet came or went, the window starts afresh
  double refine_gain = 0.15;        ///< once an offset is in use, share of a new solution taken each second
  double zero_ratio = 1.3;          ///< "no offset" is preferred while it leaves no more than this times the best residual
};

/// Finds the constant offset a magnetometer carries in the body (hard iron) from the gyroscope's attitude.
///
/// m = R' h + b, with the field h constant in the inertial frame over the window: least squares gives
/// (I - E[R]' E[R]) b = E[m] - E[R]' E[R m]. Taken only when it explains most of what is left unexplained: an ungated fit to a
/// field that bends in space makes headings worse. A plain struct.
struct HardIron {
  static constexpr int kSeconds = 20;

  Vector3 offset_ut;
  MagneticSums ring[kSeconds];
  MagneticSums current;
  int next = 0;
  double seconds_in_current = 0.0;

  enum class News : std::uint8_t { kNone, kMoved, kStep };
  /// One block; tells whether the offset has changed, or the field took a step that no turn explains.
  News add(const HardIronSettings& settings, const MagneticSums& block, double dt_s);
  void clear();

 private:
  MagneticSums newest(int how_many) const;
  News solve(const HardIronSettings& settings);
};

struct MagneticHeadingSettings {
  double heading_sigma_rad_rts = 0.122;   ///< of the compass, rad times root second (7 degrees): larger averages longer
  double norm_scale = 0.10;               ///< relative mismatch at which a field is another one and counts a quarter
  double dip_scale_rad = 0.175;           ///< the same for the dip (10 degrees)
  double turn_scale_rad = 1.0;            ///< a north so far from the average, beyond twice its sigma, counts a quarter
  double odd_square = 4.0;                ///< mismatch, squared and in these scales, beyond which it does not count at all
  double reference_s = 20.0;              ///< averaging of norm and dip
  double accept_field_s = 20.0;           ///< a steady other field becomes the reference
  double least_support_s = 1.0;           ///< and sooner, if the reference has less support than it, but not before this
  double bias_spread_rad = 0.05;          ///< spread of the compass at which it teaches the gyroscope's bias half as much (3 degrees)
  double field_sigma_rad = 0.02;          ///< what a heading is never better than: the field itself bends
  double spread_share = 0.5;              ///< share of the compass's spread that averaging does not take away
};

/// Where magnetic north stands in the inertial frame, and whether to believe it.
///
/// The compass is averaged as vectors, field and rotation apart, so that a hard-iron offset found later corrects all that was
/// averaged before it was known: north is where E[R m] - E[R] b points. A plain struct.
struct MagneticHeading {
  Vector3 field;                ///< weighted mean of R m
  Matrix3 rotation = {};        ///< weighted mean of R
  bool pointed = false;
  double norm_ut = 0.0, dip_rad = 0.0;                       ///< reference; norm 0 = none yet
  double candidate_norm_ut = 0.0, candidate_dip_rad = 0.0, candidate_s = 0.0;
  double averaged_s = 0.0;
  double support_s = 0.0;       ///< how long the field has agreed with the reference
  bool switched = false;        ///< this block made another field, better supported, the reference
  double spread_rad2 = 0.0;     ///< running mean square of the compass against its own average
  double quality = 0.0;         ///< 0..1, running mean of how much the field was believed

  /// Turn from the inertial frame to (magnetic) east-north, of the frame's axes.
  double heading_rad(Vector3 offset_ut) const;
  /// One block: how much it counts, 0..1, by 1 / (1 + mismatch^2)^2: no threshold about which a bent field could flicker.
  double judge(const MagneticHeadingSettings& settings, const MagneticSums& block, Vector3 offset_ut, double dt_s);
  /// How far the block's north is from the average, counter-clockwise; 0 while there is none.
  double away_rad(const MagneticSums& block, Vector3 offset_ut) const;
  /// Moves north by `gain` (0..1) towards the block's, which is `away_rad` off.
  void average(const MagneticSums& block, double away_rad, double gain, double dt_s);
  /// What was averaged so far keeps the offset it has now.
  void freeze(Vector3 offset_ut);

 private:
  void follow_candidate(const MagneticHeadingSettings& settings, double norm_ut, double dip_rad, double dt_s);
};

}  // namespace wayfuse
