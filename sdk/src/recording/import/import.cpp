#include "sdk/src/recording/import/import.hpp"

#include <algorithm>
#include <filesystem>

#include "sdk/src/recording/import/attitude_trial.hpp"
#include "sdk/src/recording/import/floor_label.hpp"
#include "sdk/src/recording/import/recorded_walk.hpp"
#include "sdk/src/recording/import/step_trial.hpp"

namespace wayfuse {
namespace {

void sort_by_time(std::vector<RecordedEvent>& events) {
  std::stable_sort(events.begin(), events.end(), [](const auto& a, const auto& b) { return time_of(a) < time_of(b); });
}

Result<ImportedRecording> read_ilc20(const std::string& path, const ImportSettings& settings) {
  auto walk = read_walk(path, {}, false);
  if (!walk) return walk.fault();
  ImportedRecording recording;
  recording.header = {walk->device_model, "Indoor Location Competition 2.0", "", {}};
  recording.complaints = std::move(walk->complaints);
  recording.complaints.insert(recording.complaints.end(), walk->notes.begin(), walk->notes.end());
  const FloorOrdinal floor = settings.floor ? *settings.floor : floor_ordinals({walk->floor_label}).front();
  for (const TruePoint& mark : walk->way_points) recording.events.push_back(TruthMark{mark.time, {mark.point, floor}});
  for (const MargSample& sample : walk->motion) recording.events.push_back(sample);
  for (RssScan& scan : walk->scans) recording.events.push_back(std::move(scan));
  sort_by_time(recording.events);
  if (!recording.events.empty()) recording.header.started_at = UnixTime{time_of(recording.events.front()).time_since_epoch()};
  if (walk->way_points.empty()) recording.complaints.push_back(path + ": no TYPE_WAYPOINT line, so no truth");
  return recording;
}

ImportedRecording motion_only(const char* app, std::vector<MargSample> samples, std::string lack) {
  ImportedRecording recording;
  recording.header = {"", app, "", {}};
  recording.events.assign(std::make_move_iterator(samples.begin()), std::make_move_iterator(samples.end()));
  sort_by_time(recording.events);
  recording.complaints.push_back(std::move(lack));
  return recording;
}

Result<ImportedRecording> read_broad(const std::string& path, const ImportSettings&) {
  auto trial = read_broad_trial(path);
  if (!trial) return trial.fault();
  return motion_only("BROAD", std::move(trial->samples), path + ": motion only; true attitudes have no place in a recording");
}

Result<ImportedRecording> read_tyrex(const std::string& path, const ImportSettings&) {
  auto trial = read_tyrex_trial(path, TyrexField::kCalibrated);
  if (!trial) return trial.fault();
  return motion_only("On Attitude Estimation with Smartphones", std::move(trial->samples),
                     path + ": motion only, calibrated sensors; true attitudes have no place in a recording");
}

Result<ImportedRecording> read_oxford(const std::string& path, const ImportSettings&) {
  auto trial = read_oxford_trial(path);
  if (!trial) return trial.fault();
  return motion_only("Oxford step counter", std::move(trial->samples),
                     path + ": accelerations only; true step counts have no place in a recording");
}

}  // namespace

const std::vector<ImportFormat>& import_formats() {
  static const std::vector<ImportFormat> formats = {
      {"ilc20", "a trace of Indoor Location Competition 2.0 (.txt)", read_ilc20},
      {"getsensordata", "a log of the GetSensorData application (IPIN competitions)", read_get_sensor_data},
      {"broad", "a trial of BROAD (.csv); motion only", read_broad},
      {"tyrex", "a trial's folder of 'On Attitude Estimation with Smartphones'; motion only", read_tyrex},
      {"oxford-steps", "a walk of the Oxford step counter (.csv); motion only", read_oxford}};
  return formats;
}

Result<ImportedRecording> import_recording(std::string_view format, const std::string& path, const ImportSettings& settings) {
  const auto& formats = import_formats();
  const auto found = std::ranges::find(formats, format, &ImportFormat::name);
  if (found != formats.end()) return found->read(path, settings);
  std::string names;
  for (const ImportFormat& known : formats) names += (names.empty() ? "" : ", ") + std::string(known.name);
  return Fault{FaultCode::kUnknownName, "format", "'" + std::string(format) + "' is none; there are " + names};
}

}  // namespace wayfuse
