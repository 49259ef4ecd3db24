#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/result.hpp"
#include "wayfuse/proto/scan.hpp"
#include "wayfuse/proto/time.hpp"
#include "wayfuse/sdk/heading_estimator.hpp"
#include "wayfuse/sdk/marg.hpp"

namespace wayfuse {

/// Where the walker said to be.
struct TruePoint {
  PhoneTime time;
  BuildingPoint point;
};

/// The phone's own idea of its attitude, for comparison only.
struct RecordedAttitude {
  PhoneTime time;
  Quaternion body_to_enu;
};

/// One walk as recorded by "Indoor Location Competition 2.0" phones: what a phone's sensors and radio said, and the truth.
///
/// Phone time is the file's milliseconds since 1970. All lists ascend in time. A scan is a list as it arrived; `age` tells
/// when each reading was last seen by the radio. Longer lists than the protocol takes keep their youngest 512 readings.
struct RecordedWalk {
  std::string id;  ///< file name without `.txt`
  std::string floor_label;
  FloorOrdinal floor;
  std::string device_model;
  std::vector<MargSample> motion;  ///< sensors that spoke in the same millisecond share a sample
  std::vector<RecordedAttitude> attitudes;
  std::vector<RssScan> scans;
  std::vector<TruePoint> way_points;    ///< building frame
  std::vector<std::string> complaints;  ///< `file:line: cause` of every line that was left out
  std::vector<std::string> notes;       ///< `file: what` was taken otherwise than it is written

  /// On the straight line between the way points around `time`; absent before the first and after the last.
  std::optional<BuildingPoint> truth_at(PhoneTime time) const;
  /// From the first way point to the last, seconds.
  double duration_s() const;
};

/// Reads one trace file; way points are shifted by `floor_origin` into the building's frame.
///
/// Lines of other types (beacons, ranging) are passed over, lines that do not parse are left out and named in
/// `complaints`; kMalformed if they are more than one in twenty, or if the file holds no way point where some are needed.
/// So are lines of a wrong clock, an hour and more apart from the walk's other lines, and way points farther than 10 km from
/// the frame's origin. WIFI rows without a last-seen time were heard when they were listed; so were all rows of a walk none
/// of which was last seen within 600 s of its own time: `notes` say so. A device model that is no name is left empty.
Result<RecordedWalk> read_walk(const std::string& path, BuildingPoint floor_origin, bool needs_way_points = true);

}  // namespace wayfuse
