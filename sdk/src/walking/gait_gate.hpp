#pragma once

#include "sdk/src/attitude/rotation.hpp"

namespace wayfuse {

/// What the last two seconds of acceleration look like, as the numbers that tell walking from fidgeting.
struct GaitFeatures {
  double swing_mps2 = 0.0;       ///< standard deviation of |a| below 3 Hz
  double sharpness = 0.0;        ///< deviation above 3 Hz relative to it: heels hit the ground, hands do not
  double uprightness = 0.0;      ///< deviation along gravity relative to across
  double periodicity = 0.0;      ///< highest autocorrelation of |a| between 0.32 and 1.4 s, -1..1
  double excess_mps2 = 0.0;      ///< mean |a| above g: swung about
  double tilting_rad = 0.0;      ///< gravity's turn in the body over the window
};

struct GaitGateSettings {
  // Logistic regression of walking (three public sets of phones carried in all ways) against hand motion, see README.
  double constant = -8.33;
  double log_swing = -0.79, log_sharpness = 2.13, log_uprightness = 2.29, periodicity = 7.49, excess = -0.30, log_tilting = -0.99;
  double memory = 0.7;           ///< share of the old log-odds kept each half second; larger decides later
  double begin_log_odds = 1.0;   ///< walking begins above
  double end_log_odds = -3.0;    ///< and ends below
  double still_mps2 = 0.3;       ///< less swing than this is no walking whatever it looks like
};

/// Decides, twice a second, whether the phone's owner walks. Needs the accelerometer alone. A plain struct.
struct GaitGate {
  static constexpr double kTick_s = 0.04;      // the ring's grid
  static constexpr int kWindow = 50;           // 2 s
  static constexpr int kLeastFilled = 30;      // decides from 1.2 s on
  static constexpr int kNewest = 8, kOldest = 35;  // lags

  bool walking = false;
  double log_odds = 0.0;     ///< nothing known yet
  GaitFeatures features;

  /// One reading, `dt_s` after the one before; true when a new decision was made.
  bool feed(const GaitGateSettings& settings, Vector3 acceleration_mps2, double dt_s);

 private:
  struct Tick {
    double low = 0.0, high_square = 0.0, along = 0.0, across_square = 0.0, total = 0.0;
    Vector3 gravity;
  };
  void measure();

  Tick ring_[kWindow];
  int filled_ = 0, next_ = 0, since_decision_ = 0;
  double until_tick_s_ = kTick_s;
  double first_ = 0.0, second_ = 0.0, high_square_ = 0.0, in_tick_ = 0.0;
  Vector3 slow_, gravity_;
  bool started_ = false;
};

}  // namespace wayfuse
