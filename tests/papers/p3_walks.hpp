#pragma once

#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "tests/papers/experiment.hpp"

/// The walks of [P3] through hall and room, and the systems that are compared on them.
namespace wayfuse::papers::p3 {

/// N(0, pi/50) is read as mean and standard deviation, 3.6 degrees and 0.063 dB; beside it as mean and variance, 14.4 degrees and 0.25 dB.
inline constexpr double kDeviation = std::numbers::pi / 50.0;
inline const double kRootOfVariance = std::sqrt(kDeviation);

inline constexpr const char* kRssi = "RSSI alone";
inline constexpr const char* kPdr = "PDR alone";
inline constexpr const char* kPf = "PF";
inline constexpr const char* kPfGuarded = "PF, guarded";
inline constexpr const char* kOurs = "algorithm 2";
inline constexpr const char* kOursGuarded = "algorithm 2, guarded";
inline constexpr const char* kEager = "algorithm 2, T = 0.01";
inline constexpr const char* kRoom = "room, one node blocked";

enum class Air { kConstant, kDrifts, kJumps };
const char* name(Air air);

struct Run {
  std::map<std::string, Track> tracks;
  std::vector<BuildingPoint> truth;
  std::map<std::string, std::vector<std::vector<double>>> exponents;  ///< of the nodes, after each step
  std::vector<double> true_exponents;
};

/// One walk of 173 steps through the hall: every system of the paper's table, guarded and unguarded, and PDR alone.
Run hall(const Presets& presets, Air air, std::uint64_t seed);
/// The same with N(0, pi/50) read as a variance: PDR alone, PF and algorithm 2.
Run hall_with_variance(const Presets& presets, Air air, std::uint64_t seed);
/// One walk through the room with a node blocked from half-way on.
Run room(const Presets& presets, std::uint64_t seed);
/// The largest of any node after any step: eq. 12 is a node's.
double exponent_error(const Run& run, const std::string& system);

/// The perturbation sweep: neither the offset's size nor the fixes' weight is printed, nor whether particles that move by eq. 7 draw noise of
/// their own. Without any, the offsets alone keep them apart.
struct Sweep {
  const char* name;
  double offset_m;
  bool exact_steps;
  Air air = Air::kConstant;
};
inline constexpr Sweep kSweeps[] = {{"perturbation sweep", 0.3, true}, {"sweep, offsets of 1 m", 1.0, true}, {"sweep, noise in every step", 0.3, false},
                                    {"sweep, exponent jumps", 0.3, true, Air::kJumps}};
inline constexpr double kShares[] = {0.0, 0.1, 0.2, 0.3, 0.5, 0.8};
std::string share_name(double share);
std::map<std::string, Track> swept(const Presets& presets, const Sweep& sweep, std::uint64_t seed);

}  // namespace wayfuse::papers::p3
