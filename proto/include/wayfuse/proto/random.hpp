#pragma once

#include <array>
#include <cstdint>

namespace wayfuse {

/// The one random generator: xoshiro256++ (Blackman and Vigna 2019), seeded through SplitMix64.
///
/// Same seed, same bits, on every platform and standard library. Its state is a plain array, so that a session can be
/// saved and replayed exactly. Thread: confined to its owner.
class Random {
 public:
  using State = std::array<std::uint64_t, 4>;

  explicit Random(std::uint64_t seed);

  /// 64 uniform bits.
  std::uint64_t bits();
  /// Uniform in [0, 1), 53 bits.
  double uniform();
  /// Standard normal, by the polar method without a cached second value, so that the state is the whole state.
  double normal();
  /// Uniform in 0..bound-1 without bias; `bound` > 0.
  std::uint64_t below(std::uint64_t bound);
  /// A generator whose stream is independent of this one's; advances this one.
  Random split();

  const State& state() const { return state_; }
  void restore(const State& state) { state_ = state; }

 private:
  State state_;
};

}  // namespace wayfuse
