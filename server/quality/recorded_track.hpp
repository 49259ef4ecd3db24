#pragma once

#include <string>
#include <string_view>

#include "server/quality/walk_quality.hpp"

namespace wayfuse {

/// A recorded walk as it was uploaded.
struct TrackRecording {
  std::string device_model;
  UnixTime recorded_at;
  RecordedTrack track;
};

/// Reads either the SDK's recording (what the sensors felt, with `truth` marks) or the protocol's `survey_walk` documents, one
/// a line (what the phone reported). Sensors become steps by the phone's own motion tracker, not by a copy of it.
///
/// Faults name the line, or the mark: fewer than two marks, no scan between them, marks that do not ascend.
Result<TrackRecording> read_recording(std::string_view content, const MagneticField& field = {});

}  // namespace wayfuse
