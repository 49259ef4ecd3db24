#pragma once

#include <cstdint>
#include <optional>

#include "wayfuse/proto/heading.hpp"
#include "wayfuse/proto/motion.hpp"
#include "wayfuse/sdk/marg.hpp"

namespace wayfuse {

/// Unit quaternion, body -> (east, north, up).
struct Quaternion {
  double w = 1.0;
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  bool operator==(const Quaternion&) const = default;
};

struct Attitude {
  PhoneTime time;
  Quaternion body_to_enu;
  Heading heading;                 ///< of the body's y axis, against `reference`
  double heading_sigma_rad = 0.0;
  double inclination_sigma_rad = 0.0;
  HeadingReference reference = HeadingReference::kMagnetic;
  Vector3 turn_rate_radps;         ///< bias removed, body frame
  bool at_rest = false;
};

/// What became of the readings fed so far, one count a reading.
struct SampleCounts {
  std::uint64_t used = 0;
  std::uint64_t duplicate = 0;    ///< same time as the sensor's newest
  std::uint64_t stale = 0;        ///< older than the sensor's newest
  std::uint64_t not_finite = 0;
  std::uint64_t overrange = 0;    ///< beyond what a phone can measure
  bool operator==(const SampleCounts&) const = default;
};

/// How the phone is turned, from its MARG samples. One instance a phone; thread: confined to its owner.
class HeadingEstimator {
 public:
  virtual ~HeadingEstimator() = default;
  /// Takes samples in time order; a NaN, stale or duplicate one is ignored and counted.
  virtual void feed(const MargSample& sample) = 0;
  /// Absent until gravity was seen.
  virtual std::optional<Attitude> attitude() const = 0;
  /// What the building knows of its magnetic field; may come at any time. With a norm, headings become true ones.
  virtual void expect(const MagneticField& field) = 0;
  virtual SampleCounts counts() const = 0;
};

}  // namespace wayfuse
