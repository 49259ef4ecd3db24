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
  Quaternion body_to_level;        ///< without the compass: level, its heading from an arbitrary, slowly drifting origin
  Heading heading;                 ///< of the body's y axis, against `reference`
  double heading_sigma_rad = 0.0;
  double inclination_sigma_rad = 0.0;
  HeadingReference reference = HeadingReference::kMagnetic;
  Vector3 turn_rate_radps;         ///< bias removed, body frame
  double magnetic_quality = 0.0;   ///< 0..1: share of the last seconds in which the field was what it should be
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

/// What an estimator has learnt of the phone's sensors: keep it when the application ends, give it back when it starts.
struct SensorCalibration {
  Vector3 turn_rate_bias_radps;    ///< body frame
  double bias_sigma_radps = 0.0;   ///< per axis; 0 = nothing known
  Vector3 field_offset_ut;         ///< hard iron, body frame
  bool operator==(const SensorCalibration&) const = default;
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
  /// Absent where the estimator learns nothing.
  virtual std::optional<SensorCalibration> calibration() const { return std::nullopt; }
  /// Before the first sample; an estimator that learns nothing ignores it.
  virtual void start_with(const SensorCalibration& /*calibration*/) {}
};

}  // namespace wayfuse
