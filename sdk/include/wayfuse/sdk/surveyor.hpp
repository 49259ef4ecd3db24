#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "wayfuse/proto/message.hpp"
#include "wayfuse/proto/random.hpp"
#include "wayfuse/proto/scan_splitter.hpp"

namespace wayfuse {

/// Collects reference points and cuts them into batches with idempotency keys, ready for Client::upload.
///
/// Thread: confined to its owner. Positions between two marks of a walk lie on the straight line between them, at a steady
/// pace: mark every turn, every stop and every start. Or hand the walk over as recorded, with the phone's motion.
class Surveyor {
 public:
  Surveyor(std::string device_model, Random random);

  /// A standing point with its scans. Stored as several points of the same place where one message could not carry it.
  Result<void> add_point(Place place, double sigma_m, std::vector<RssScan> scans, UnixTime at);

  /// A walk: the surveyor marks way points, scans fall between them.
  Result<void> begin_walk(std::string name);
  /// The walker is at `place` at `time`; marks come in time order.
  Result<void> mark(PhoneTime time, Place place, double sigma_m);
  Result<void> scan(const RssScan& scan, UnixTime at);
  /// Places the walk's scans: readings heard within 2 s of each other become one point, where the walker was in the middle of
  /// them. What the phone's cache repeats from an earlier scan counts once. Readings heard before the first mark,
  /// after the last one or between marks of two floors have no place: they are left out and counted.
  Result<void> end_walk();
  /// What the phone's motion tracker reports on the way, for end_recorded_walk().
  Result<void> motion(const MotionReport& report);
  /// Instead of end_walk(): the walk as it was recorded, in parts that fit a message each; the server places the scans between
  /// the marks by the motion, so that bends need no mark. `wall` is `phone` on the wall clock. Each part goes to
  /// Client::upload and is sent again after a break until it is acknowledged.
  Result<std::vector<SurveyWalk>> end_recorded_walk(PhoneTime phone, UnixTime wall);

  /// Batches ready to upload, each within the limits; hands them over once.
  std::vector<SurveyBatch> take_batches();

  /// Those without a place, and of longer scans than a message takes the oldest ones (keep_youngest).
  std::size_t readings_left_out() const { return left_out_; }

 private:
  struct Mark {
    PhoneTime time;
    Place place;
    double sigma_m = 0.0;
  };
  struct Spot;
  std::optional<Spot> where(PhoneTime time) const;
  void place_scan(const RssScan& scan, UnixTime at);
  std::string new_key();

  std::string device_model_;
  Random random_;
  std::vector<std::pair<ReferencePoint, std::size_t>> points_;  // with the bytes of their JSON spelling
  bool walking_ = false;
  std::string walk_;
  std::vector<Mark> marks_;
  std::vector<std::pair<RssScan, UnixTime>> scans_;
  std::vector<MotionReport> motion_;
  ScanSplitter splitter_;
  std::size_t left_out_ = 0;
};

}  // namespace wayfuse
