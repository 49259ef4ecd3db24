#include "sdk/src/simulator/hand_moves.hpp"

#include <cmath>
#include <numbers>

namespace wayfuse::simulator {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kSwayWaves = 4;
constexpr double kSwayLeast_hz = 0.2, kSwayMost_hz = 1.2, kSway_m = 0.0015;
constexpr double kKnock_radps = 2 * kPi * 12.0, kKnock_s = 0.03;

}  // namespace

HandMoves::HandMoves(Random& random) {
  for (int i = 0; i < kSwayWaves; ++i) {
    const double radps = 2 * kPi * (kSwayLeast_hz + (kSwayMost_hz - kSwayLeast_hz) * random.uniform());
    sway_.push_back({radps, 2 * kPi * random.uniform(), kSway_m * radps * radps});
  }
}

void HandMoves::fidget(double per_min, Duration end, Random& random) {
  Duration at{0};
  while (per_min > 0.0) {
    at += from_seconds(-60.0 / per_min * std::log(1.0 - random.uniform()));
    if (at >= end) return;
    const double hold_s = 0.5 + 5.0 * random.uniform(), vigour = 0.6 + 0.8 * random.uniform();
    const Duration back = at + from_seconds(hold_s + 1.0);
    switch (random.below(4)) {
      case 0:
        move(at, -0.5 * vigour, 0.9);   // crouches
        move(back, 0.5 * vigour, 0.9);
        break;
      case 1:
        move(at, 0.4 * vigour, 0.8);    // raises the phone
        move(back, -0.4 * vigour, 0.8);
        break;
      case 2:
        move(at, -0.04 * vigour, 0.6);  // from one foot to the other
        move(at + from_seconds(0.6), 0.04 * vigour, 0.6);
        break;
      default: knock(at, 10.0 * vigour);
    }
    at = back;
  }
}

double HandMoves::acceleration_mps2(Duration since_start) const {
  const double now_s = seconds(since_start);
  double sum = 0.0;
  for (const Wave& wave : sway_) sum += wave.mps2 * std::sin(wave.radps * now_s + wave.phase_rad);
  for (const Move& move : moves_) {
    const double t = (now_s - seconds(move.at)) / move.lasting_s;
    // The second derivative of 10 t^3 - 15 t^4 + 6 t^5, the smoothest way from 0 to 1.
    if (t > 0.0 && t < 1.0) sum += move.rise_m / (move.lasting_s * move.lasting_s) * 60.0 * t * (1.0 + t * (2.0 * t - 3.0));
  }
  for (const Knock& knock : knocks_) {
    const double t_s = now_s - seconds(knock.at);
    if (t_s > 0.0 && t_s < 0.3) sum += knock.mps2 * std::exp(-t_s / kKnock_s) * std::sin(kKnock_radps * t_s);
  }
  return sum;
}

}  // namespace wayfuse::simulator
