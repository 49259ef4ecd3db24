#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "wayfuse/proto/random.hpp"

namespace wayfuse {

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
    const float radius = std::sqrt(-2.0f * std::log(u.first));
    const float angle = 2.0f * std::numbers::pi_v<float> * u.second;
    return {radius * std::cos(angle), radius * std::sin(angle)};
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
