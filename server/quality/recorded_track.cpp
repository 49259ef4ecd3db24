#include "server/quality/recorded_track.hpp"

#include <algorithm>
#include <sstream>

#include "wayfuse/proto/codec.hpp"
#include "wayfuse/sdk/motion_tracker.hpp"
#include "wayfuse/sdk/recording.hpp"

namespace wayfuse {
namespace {

// Of the phone's evidence, what the wire would have carried.
class Phone {
 public:
  Phone(MotionTracker motion, RecordedTrack& track) : motion_(std::move(motion)), track_(track) {}

  Result<void> operator()(const MargSample& sample) {
    if (auto report = motion_.feed(sample)) track_.evidence.emplace_back(*std::move(report));
    return {};
  }
  Result<void> operator()(const RssScan& scan) { return keep(scan); }
  Result<void> operator()(const GnssFix& fix) { return keep(fix); }
  Result<void> operator()(const TruthMark& mark) {
    track_.marks.push_back({mark.time, mark.place, 0.0});
    return {};
  }

 private:
  template <typename Sample>
  Result<void> keep(const Sample& sample) {
    if (auto sound = check(sample, "recording"); !sound) return sound;
    track_.evidence.emplace_back(sample);
    return {};
  }
  MotionTracker motion_;
  RecordedTrack& track_;
};

Result<TrackRecording> from_sensors(std::string_view content, const MagneticField& field) {
  std::istringstream in{std::string(content)};
  auto reader = RecordingReader::open(in);
  if (!reader) return reader.fault();
  auto motion = MotionTracker::create({});
  if (!motion) return motion.fault();
  if (field != MagneticField{}) motion->expect(field);
  TrackRecording recording{reader->header().device_model, reader->header().started_at, {}};
  Phone phone(*std::move(motion), recording.track);
  for (;;) {
    auto event = reader->next();
    if (!event) return event.fault();
    if (!*event) return recording;
    if (const auto taken = std::visit(phone, **event); !taken) return taken.fault();
  }
}

Result<TrackRecording> from_reports(std::string_view content) {
  std::vector<SurveyWalk> parts;
  std::istringstream in{std::string(content)};
  std::size_t number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    auto message = decode_client_message(line, Encoding::kJson);
    const std::string where = "line " + std::to_string(number);
    if (!message) return Fault{message.fault().code, where + ": " + message.fault().field, message.fault().cause};
    auto* part = std::get_if<SurveyWalk>(&*message);
    if (!part) return Fault{FaultCode::kUnknownType, where + ": type", "must be survey_walk"};
    parts.push_back(std::move(*part));
  }
  if (parts.empty()) return Fault{FaultCode::kMalformed, "line 1", "the recording is empty"};
  return TrackRecording{parts.front().device_model, parts.front().wall_time, track_of(parts)};
}

Result<void> measurable(const RecordedTrack& track) {
  if (track.marks.size() < 2) {
    return Fault{FaultCode::kMissingField, "truth", "a walk to measure by needs two marks at least: it has " + std::to_string(track.marks.size())};
  }
  for (std::size_t i = 1; i < track.marks.size(); ++i) {
    if (track.marks[i].time <= track.marks[i - 1].time) {
      return Fault{FaultCode::kOutOfRange, "truth[" + std::to_string(i) + "].time_us", "not after the mark before"};
    }
  }
  const bool heard = std::ranges::any_of(track.evidence, [&](const SampleBody& body) {
    const auto* scan = std::get_if<RssScan>(&body);
    return scan && scan->time >= track.marks.front().time && scan->time <= track.marks.back().time;
  });
  if (!heard) return Fault{FaultCode::kMissingField, "scan", "there is no scan between the first mark and the last"};
  return {};
}

}  // namespace

Result<TrackRecording> read_recording(std::string_view content, const MagneticField& field) {
  const bool sensors = content.substr(0, content.find('\n')).find("\"wayfuse-recording\"") != std::string_view::npos;
  auto recording = sensors ? from_sensors(content, field) : from_reports(content);
  if (!recording) return recording;
  std::ranges::stable_sort(recording->track.marks, {}, &WayPoint::time);
  if (const auto good = measurable(recording->track); !good) return good.fault();
  return recording;
}

}  // namespace wayfuse
