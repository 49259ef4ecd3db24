#pragma once

#include <cstdint>
#include <optional>

#include "wayfuse/sdk/marg.hpp"
#include "wayfuse/sdk/motion_tracker.hpp"

namespace wayfuse {

struct LiftDetectorSettings {
  double smooth_s = 0.15;             ///< each of two poles; larger overlooks short pulses, smaller hears the hand
  double baseline_s = 3.0;            ///< how fast the sensor's idea of gravity is followed while nothing happens
  double shake_s = 0.5;               ///< memory of what is too fast for a lift
  double quiet_mps2 = 0.45;           ///< less of that: somebody stands
  double startles_mps2 = 0.8;         ///< the jolt of a lift that sets off is less
  double stands_s = 0.6;              ///< how long, before a lift can set off
  double restless_mps2 = 1.3;         ///< more of that: somebody walks or handles the phone
  double tilts_rad = 0.3;             ///< turned over by more than this, the sensor's error along the vertical is another one
  double begins_mps2 = 0.22;          ///< a pulse begins above,
  double ends_mps2 = 0.10;            ///< and ends below
  double least_peak_mps2 = 0.33, most_peak_mps2 = 2.2;
  double least_pulse_s = 0.5, most_pulse_s = 5.0;
  double least_speed_mps = 0.55, most_speed_mps = 8.0;
  double most_ride_s = 120.0;
  double reach_m = 1.5;               ///< carried further than an arm or a crouch does, still at speed: a ride is under way
  double handled_s = 3.0;             ///< on the way the phone may be turned over or shaken for so long
  double settles_s = 0.8;             ///< stands still after the stop
  double stopped = 0.35;              ///< share of the ride's speed that may be left over after the stop: errors of the two pulses
  double least_rise_m = 2.0;
  double least_mean_mps = 0.35;
  double speed_sigma_mps = 0.05;      ///< of a pulse's impulse
  double rise_sigma_m = 0.2;          ///< hands rise and sink meanwhile
  double barometer_sigma_m = 0.5;     ///< of a rise, smoothed as Climb does
  double least_seen_m = 0.2;          ///< a barometer must have seen so much before a ride is believed to be under way
  double disagrees_m = 1.5;           ///< and if in the end it is off by so much, and two fifths of the rise, there was none
};

/// Rides in lifts, felt by the vertical acceleration alone: a pulse, even speed, the opposite pulse, and nobody walking.
///
/// A lift stands before and after its ride, so the two pulses must cancel: what is left over is the error of the first and of
/// the second, and is shared between them. While it cruises, what is felt is the sensor's error, and is followed. Hands and
/// crouching people end what they began within an arm's length; a ride is only believed further than that. Causal. A plain
/// struct: copying it saves it.
struct LiftDetector {
  /// What was felt at one instant.
  struct Felt {
    PhoneTime time;
    double dt_s = 0.0;                  ///< since the one before
    double up_mps2 = 0.0;               ///< specific force along the vertical, gravity included
    Vector3 up;                         ///< the vertical, in the body
    std::optional<PhoneTime> step;      ///< the newest one of a walk so far
    std::optional<double> height_m;     ///< by the barometer
  };
  void feed(const LiftDetectorSettings& settings, const Felt& now);
  /// The ride under way, once it is believed; the newest one after that.
  const std::optional<LiftRide>& ride() const { return ride_; }
  bool riding() const { return ride_ && ride_->under_way; }
  /// Metres of rides that ended since the last call; absent without one.
  std::optional<double> take();

 private:
  enum class Phase : std::uint8_t { kStanding, kStarting, kCruising, kStopping, kSettling };

  void begin_anew(const Felt& now);
  void give_up();
  void stand(const LiftDetectorSettings& settings, const Felt& now, double felt, bool quiet);
  void carry_on(const LiftDetectorSettings& settings, const Felt& now, double felt, bool tilted);
  void start(const LiftDetectorSettings& settings, double felt);
  void cruise(const LiftDetectorSettings& settings, const Felt& now, double felt);
  void stop(const LiftDetectorSettings& settings, PhoneTime time, double felt);
  void follow(const Felt& now, double memory_s);
  void arrive(const LiftDetectorSettings& settings);
  void believe(const LiftDetectorSettings& settings, PhoneTime time);
  std::optional<double> climbed() const;   // since the start, by the barometer

  Phase phase_ = Phase::kStanding;
  bool started_ = false;
  double first_ = 0.0, low_ = 0.0, baseline_ = 0.0;   // m/s2
  Vector3 up_;                                        // the vertical in the body, as it was for that baseline
  double shake_ = 0.0;                                // mean square of what is faster
  double stands_s_ = 0.0, stood_s_ = 0.0, settled_s_ = 0.0;   // quiet so far, when the ride may have begun, after it
  // Of the ride that may be one: since when, how fast and far, upwards positive.
  PhoneTime since_, stopped_;
  double pulse_s_ = 0.0, lasted_s_ = 0.0, peak_mps2_ = 0.0, handled_s_ = 0.0, uneven_s_ = 0.0, speed_mps_ = 0.0, top_mps_ = 0.0, rise_m_ = 0.0;
  std::optional<double> height_m_, height_at_start_m_;
  std::optional<LiftRide> ride_, before_;
  double told_m_ = 0.0;
  bool ended_ = false;
};

}  // namespace wayfuse
