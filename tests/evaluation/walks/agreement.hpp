#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// Where two halves of the radios, located apart, each say a scan was heard: errors against the truth, metres.
struct HalvesOfScan {
  PhoneTime heard;
  BuildingPoint one;
  BuildingPoint other;
};

/// How much of the error of scans is no radio's own.
///
/// Two halves of the radios have no reading in common: what they are off by together, E[one . other], is not the noise of radios. It comes
/// from what all of them share, as the marks that say where a walk was, its clock, and the walks the map there is made of. No locator
/// takes more than the rest out of a single scan.
struct Agreement {
  /// What a mean over pairs of errors came to, in square metres (both axes together).
  struct Mean {
    double sum_m2 = 0.0;
    std::size_t count = 0;
    double m2() const { return count == 0 ? 0.0 : sum_m2 / static_cast<double>(count); }
  };
  static constexpr double kLag_s = 4.0;
  static constexpr std::size_t kLags = 11;  ///< of scans of one walk: 0 s (apart by less than half of kLag_s), 4 s .. 40 s

  std::size_t walks = 0;
  Mean scan;                       ///< squared error of one half, of a scan
  Mean scan_shared;                ///< of that, what both halves are off by together
  Mean walk;                       ///< squared mean error of one half, of a walk with at least kFewestScans
  Mean walk_shared;
  std::array<Mean, kLags> lagged;  ///< one half of a scan, the other half of another one so much later

  static constexpr std::size_t kFewestScans = 6;
  void add(std::span<const HalvesOfScan> walk);
};

}  // namespace wayfuse
