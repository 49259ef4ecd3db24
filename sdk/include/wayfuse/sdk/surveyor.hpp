#pragma once

#include <string>
#include <vector>

#include "wayfuse/proto/message.hpp"
#include "wayfuse/proto/random.hpp"

namespace wayfuse {

/// Collects reference points and cuts them into batches with idempotency keys.
///
/// Thread: confined to its owner. Positions between two marks of a walk are placed on the straight line in time.
class Surveyor {
 public:
  Surveyor(std::string device_model, Random random);

  /// A standing point with its scans.
  Result<void> add_point(Place place, double sigma_m, std::vector<RssScan> scans, UnixTime at);
  /// A walk: the surveyor marks way points, scans fall between them.
  Result<void> begin_walk(std::string name);
  Result<void> mark(PhoneTime time, Place place, double sigma_m);
  Result<void> scan(const RssScan& scan, UnixTime at);
  /// Places the walk's scans; each reading goes to where the walker was at `time - age`.
  Result<void> end_walk();

  /// Batches ready to upload, each within the limits; hands them over once.
  std::vector<SurveyBatch> take_batches();

 private:
  struct Walk;
  std::string device_model_;
  Random random_;
  std::vector<ReferencePoint> points_;
  std::vector<std::pair<PhoneTime, Place>> marks_;
  std::vector<std::pair<RssScan, UnixTime>> scans_;
  std::string walk_;
  double walk_sigma_m_ = 0.0;
};

}  // namespace wayfuse
