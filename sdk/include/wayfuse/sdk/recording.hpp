#pragma once

#include <cstdint>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "wayfuse/proto/motion.hpp"
#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/result.hpp"
#include "wayfuse/proto/scan.hpp"
#include "wayfuse/sdk/marg.hpp"

namespace wayfuse {

/// Where the phone truly was, as somebody who knows marked it.
struct TruthMark {
  PhoneTime time;
  Place place;
  bool operator==(const TruthMark&) const = default;
};

/// First line of a recording.
struct RecordingHeader {
  std::string device_model;
  std::string app;
  std::string building;              ///< its name, for people; may be empty
  UnixTime started_at;
  bool operator==(const RecordingHeader&) const = default;
};

using RecordedEvent = std::variant<MargSample, RssScan, GnssFix, TruthMark>;

PhoneTime time_of(const RecordedEvent& event);

/// One line of a recording, its end included; `sequence` = the number the sample had in its session.
std::string recording_line(const RecordedEvent& event, std::optional<std::uint64_t> sequence = {});

/// Writes a recording: JSON lines, one event each, described in sdk/README.md. Numbers keep their last bit.
///
/// Thread: confined to its owner. A stream that fails throws std::runtime_error at the next write.
class RecordingWriter {
 public:
  RecordingWriter(std::ostream& out, const RecordingHeader& header);
  void write(const RecordedEvent& event);

 private:
  std::ostream& out_;
};

/// Reads a recording back, line by line. Unknown event types and fields are skipped; a broken line is a fault naming it.
class RecordingReader {
 public:
  static Result<RecordingReader> open(std::istream& in);
  const RecordingHeader& header() const { return header_; }
  /// The next event; nothing at the end.
  Result<std::optional<RecordedEvent>> next();

 private:
  RecordingReader(std::istream& in, RecordingHeader header) : in_(&in), header_(std::move(header)) {}
  std::istream* in_;
  RecordingHeader header_;
  std::size_t line_ = 1;
};

}  // namespace wayfuse
