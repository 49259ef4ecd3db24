#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "wayfuse/proto/fix.hpp"
#include "wayfuse/proto/motion.hpp"
#include "wayfuse/proto/result.hpp"
#include "wayfuse/sdk/heading_estimator.hpp"
#include "wayfuse/sdk/marg.hpp"

namespace wayfuse {

/// What a MotionTracker has learnt of its phone and its walker: keep it when the application ends, give it back at the start.
struct MotionCalibration {
  SensorCalibration sensors;
  double step_scale = 1.0;          ///< of this walker's steps against the general model, 0.7..1.4
  double step_scale_sigma = 0.10;
  bool operator==(const MotionCalibration&) const = default;
};

struct MotionTrackerSettings {
  std::string heading_estimator = "block_marg";  ///< a name from heading_estimator_names()
  Duration report_interval = std::chrono::milliseconds(500);  ///< longest silence; every step is reported at once
  std::optional<MotionCalibration> calibration;  ///< from last time
};

/// How the phone is carried.
enum class Carrying : std::uint8_t {
  kUnknown,
  kLying,      ///< at rest, flat
  kHeld,       ///< in the hand before the face
  kCalling,    ///< at the ear
  kPocket,     ///< in a pocket or a bag
  kSwinging,   ///< in the hand of a swinging arm
};

/// How its owner gets up or down.
enum class Climbing : std::uint8_t { kNone, kStairs, kLift };

/// A ride in a lift, as felt by the vertical acceleration (and the barometer where there is one).
struct LiftRide {
  PhoneTime start;
  PhoneTime end;                        ///< so far, while under way
  double rise_m = 0.0;                  ///< upwards positive; so far, while under way
  double rise_sigma_m = 0.0;
  bool under_way = false;               ///< believed once it went further than an arm reaches; may still be taken back
  bool operator==(const LiftRide&) const = default;
};

/// What is known of the walk right now.
struct WalkState {
  bool walking = false;
  double confidence = 0.0;              ///< 0..1 that this is walking
  std::uint64_t steps = 0;              ///< since the start
  std::optional<PhoneTime> last_step;
  double cadence_hz = 0.0;              ///< steps a second; 0 = not walking
  double step_length_m = 0.0;           ///< of the newest step
  double speed_mps = 0.0;
  double speed_sigma_mps = 0.0;
  Carrying carrying = Carrying::kUnknown;
  Climbing climbing = Climbing::kNone;  ///< stairs need a barometer, a lift does not
  std::optional<LiftRide> lift;         ///< the newest; absent before the first
};

/// The phone's own motion: attitude and steps in, MotionReports out.
///
/// Thread: confined to its owner. Same samples, same reports, bit for bit.
class MotionTracker {
 public:
  /// Fault kUnknownName names the estimators there are.
  static Result<MotionTracker> create(const MotionTrackerSettings& settings);
  MotionTracker(MotionTracker&&) noexcept;
  MotionTracker& operator=(MotionTracker&&) noexcept;
  ~MotionTracker();

  /// Takes one sample; a report comes out at every step and at least every `report_interval`. When walking is recognised, the
  /// steps of the seconds before follow one by one, a tenth of a second apart, each with the heading it was made in.
  std::optional<MotionReport> feed(const MargSample& sample);
  std::optional<Attitude> attitude() const;
  WalkState walk() const;

  void expect(const MagneticField& field);
  /// A fused position that came back: over straight stretches it teaches the length of this walker's steps.
  void taught(const FusedPosition& position);
  MotionCalibration calibration() const;

 private:
  struct State;
  explicit MotionTracker(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The names MotionTrackerSettings::heading_estimator knows.
std::vector<std::string> heading_estimator_names();

}  // namespace wayfuse
