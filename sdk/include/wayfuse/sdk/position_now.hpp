#pragma once

#include <deque>
#include <optional>

#include "wayfuse/proto/fix.hpp"
#include "wayfuse/proto/message.hpp"
#include "wayfuse/proto/motion.hpp"

namespace wayfuse {

struct PositionNowSettings {
  double rejoin_s = 0.5;           ///< time constant with which a correction is walked in; smaller = quicker, less smooth
  double pace_s = 1.5;             ///< over which the walker's speed is taken: a step is an instant, walking is not
  double extrapolate_s = 1.0;      ///< beyond the newest report the walker is taken to go on for so long at most
  double idle_sigma_mps = 0.7;     ///< growth of uncertainty while no report tells what the walker does
  double step_sigma_m = 0.15;      ///< of a report that does not know its own distance_sigma_m, per step
  std::size_t reports_most = 4096; ///< kept since the last fused position
};

/// Where the phone is at this very moment, for a moving dot.
struct LivePosition {
  PhoneTime at;
  Place place;
  std::optional<GeoPoint> geo;
  double radius68_m = 0.0;
  double radius95_m = 0.0;
  Heading heading;                 ///< of the walker, local frame
  double speed_mps = 0.0;
  Duration since_fused{0};         ///< age of the server's word this rests on
  Integrity integrity = Integrity::kOk;
};

/// "Position now": carries the server's last fused position forward by the phone's own motion.
///
/// Between two calls the dot moves without a jump, whatever arrives between them: a correction starts where the dot was and
/// is walked in within about two `rejoin_s`, and as long as it lasts it counts into the radii. Only the floor switches at
/// once. Through a gap of the connection the reckoning goes on with growing radii.
/// Thread: confined to its owner. Cost of a call: constant; of a fused position: the reports since it was valid.
class PositionNow {
 public:
  explicit PositionNow(PositionNowSettings settings = {}) : settings_(settings) {}

  /// The building's frame and declination turn the phone's headings into its own.
  void welcomed(const Welcome& welcome);
  void moved(const MotionReport& report);
  /// The server's word; one that is valid before the newest known is passed over.
  void fused(const FusedPosition& position, PhoneTime now);
  /// Absent until the first fused position. Calls come in time order.
  std::optional<LivePosition> at(PhoneTime now);

 private:
  struct Reckoned {
    BuildingPoint point;
    double variance_m2 = 0.0;      // grown since the fused position, per axis at most
    double speed_mps = 0.0;
  };
  Heading to_local(const MotionReport& report) const;
  void add(const MotionReport& report, double part);
  double speed_mps() const { return pace_s_ > 0.0 ? pace_m_ / pace_s_ : 0.0; }
  void reckon_anew();
  Reckoned reckon(PhoneTime now) const;
  BuildingPoint shown(PhoneTime now) const;
  double remaining(PhoneTime now) const;

  PositionNowSettings settings_;
  std::optional<Georeference> frame_;
  double declination_rad_ = 0.0;
  std::deque<MotionReport> reports_;      // ascending, since the fused position and one before
  std::optional<FusedPosition> fused_;
  double turn_rad_ = 0.0;                 // what the server knows of the phone's heading error

  // Reckoned up to the newest report.
  BuildingPoint reached_;
  PhoneTime reached_at_;
  double travelled_m_ = 0.0;
  double along_variance_m2_ = 0.0;
  double heading_variance_ = 0.0;
  double pace_m_ = 0.0, pace_s_ = 0.0;    // travelled, and in what time, the older the less
  Heading heading_;

  // The correction being walked in.
  BuildingPoint offset_;
  PhoneTime offset_at_;
  PhoneTime asked_at_ = PhoneTime::min();
};

}  // namespace wayfuse
