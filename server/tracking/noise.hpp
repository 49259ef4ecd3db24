#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "wayfuse/proto/random.hpp"

namespace wayfuse {

/// Natural logarithm of a number in (0, 1], within 2e-6, by additions, multiplications and one division alone: the vector units
/// repeat it bit by bit (particle_kernels.cpp), and so does every platform. atanh's series on the mantissa.
inline float log_of_unit(float u) {
  const auto bits = std::bit_cast<std::uint32_t>(u);
  const int exponent = static_cast<int>(bits >> 23) - 127;
  const float m = std::bit_cast<float>((bits & 0x7fffffu) | 0x3f800000u);
  const float t = (m - 1.0f) / (m + 1.0f);
  const float t2 = t * t;
  const float p = (((1.0f / 9.0f * t2 + 1.0f / 7.0f) * t2 + 1.0f / 5.0f) * t2 + 1.0f / 3.0f) * t2 + 1.0f;
  return static_cast<float>(exponent) * std::numbers::ln2_v<float> + (t + t) * p;
}

struct CosineAndSine {
  float cosine;
  float sine;
};
/// Of a share of a full turn, in [0, 1), within 6e-7, in the same manner: Taylor's series on an eighth of a turn to either side.
inline CosineAndSine cosine_and_sine_of_turn(float turn) {
  const float r = turn * 4.0f;
  const int q = static_cast<int>(r + 0.5f);
  const float a = (r - static_cast<float>(q)) * (std::numbers::pi_v<float> / 2);
  const float a2 = a * a;
  const float s = (((-1.0f / 5040.0f * a2 + 1.0f / 120.0f) * a2 + -1.0f / 6.0f) * a2 + 1.0f) * a;
  const float c = (((1.0f / 40320.0f * a2 + -1.0f / 720.0f) * a2 + 1.0f / 24.0f) * a2 + -0.5f) * a2 + 1.0f;
  const float cosine = q & 1 ? s : c, sine = q & 1 ? c : s;
  return {(q + 1) & 2 ? -cosine : cosine, q & 2 ? -sine : sine};
}

constexpr float kTurnsPerRad = 0.5f / std::numbers::pi_v<float>;
/// Of any angle of moderate size, in the same manner: within 2e-6 for |angle| < 10.
inline CosineAndSine cosine_and_sine(float angle_rad) {
  const float turns = angle_rad * kTurnsPerRad;
  return cosine_and_sine_of_turn(turns - std::floor(turns));
}

/// Independent noise for every particle of a cloud, addressed by number instead of drawn in sequence.
///
/// Particle i's draw depends on the key and on i alone, so a loop may run in any order and over any vector width and still
/// give the same bits. One key a step comes from the session's generator. The mixer is the 32-bit finaliser `lowbias32`
/// (C. Wellons, 2018), twice with different keys; normals by the Box-Muller transform, two at a time.
class Noise {
 public:
  explicit Noise(Random& random) : key_(random.bits()) {}
  explicit Noise(std::uint64_t key) : key_(key) {}

  std::uint64_t key() const { return key_; }

  struct Pair {
    float first;
    float second;
  };
  /// Two uniform numbers: (0, 1] and [0, 1).
  Pair uniform(std::uint32_t i) const {
    const std::uint32_t a = mix(i * 2u + 1u + static_cast<std::uint32_t>(key_));
    const std::uint32_t b = mix(a ^ static_cast<std::uint32_t>(key_ >> 32));
    return {(static_cast<float>(a >> 8) + 1.0f) * 0x1.0p-24f, static_cast<float>(b >> 8) * 0x1.0p-24f};
  }
  /// Two independent standard normals.
  Pair normal(std::uint32_t i) const {
    const Pair u = uniform(i);
    const float radius = std::sqrt(std::max(-2.0f * log_of_unit(u.first), 0.0f));
    const CosineAndSine way = cosine_and_sine_of_turn(u.second);
    return {radius * way.cosine, radius * way.sine};
  }

  static std::uint32_t mix(std::uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return x;
  }

 private:
  std::uint64_t key_;
};

}  // namespace wayfuse
