#pragma once

#include <memory>
#include <string>
#include <vector>

#include "wayfuse/proto/motion.hpp"
#include "wayfuse/proto/result.hpp"
#include "wayfuse/sdk/heading_estimator.hpp"
#include "wayfuse/sdk/marg.hpp"

namespace wayfuse {

struct MotionTrackerSettings {
  std::string heading_estimator = "block_marg";  ///< a name from heading_estimator_names()
  Duration report_interval = std::chrono::milliseconds(500);  ///< longest silence; every step is reported at once
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

  /// Takes one sample; a report comes out at every step and at least every `report_interval`.
  std::optional<MotionReport> feed(const MargSample& sample);
  std::optional<Attitude> attitude() const;
  void expect(const MagneticField& field);

 private:
  struct State;
  explicit MotionTracker(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The names MotionTrackerSettings::heading_estimator knows.
std::vector<std::string> heading_estimator_names();

}  // namespace wayfuse
