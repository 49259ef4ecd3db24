#pragma once

#include <vector>

#include "wayfuse/proto/random.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse::simulator {

/// What a hand, or the body it belongs to, does to a phone up and down apart from the gait: smooth moves from one height to
/// another, knocks, and the sway of somebody who stands.
class HandMoves {
 public:
  /// Sways from the start to the end of a walk; moves are added.
  explicit HandMoves(Random& random);

  /// By `rise_m` within `lasting_s`, without a jolt at either end.
  void move(Duration at, double rise_m, double lasting_s) { moves_.push_back({at, rise_m, lasting_s}); }
  /// A knock that rings out within a tenth of a second.
  void knock(Duration at, double mps2) { knocks_.push_back({at, mps2}); }
  /// Somebody who cannot keep still: crouches, raises the phone, shifts their weight, knocks against something; so many times
  /// a minute until `end`.
  void fidget(double per_min, Duration end, Random& random);

  /// Upwards, m/s2.
  double acceleration_mps2(Duration since_start) const;

 private:
  struct Move {
    Duration at;
    double rise_m, lasting_s;
  };
  struct Knock {
    Duration at;
    double mps2;
  };
  struct Wave {
    double radps, phase_rad, mps2;
  };

  std::vector<Move> moves_;
  std::vector<Knock> knocks_;
  std::vector<Wave> sway_;
};

}  // namespace wayfuse::simulator
