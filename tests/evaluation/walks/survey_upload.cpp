#include "tests/evaluation/walks/survey_upload.hpp"

#include <stdlib.h>

#include <cstdio>
#include <stdexcept>

#include "tests/evaluation/datasets/split.hpp"
#include "wayfuse/sdk/surveyor.hpp"

namespace wayfuse {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kUploadsAhead = 4;  // batches sent before the answers to earlier ones are awaited
constexpr int kTurnsMost = 20'000;        // without an answer; then it will not come

}  // namespace

ScratchFolder::ScratchFolder() {
  std::string pattern = (fs::temp_directory_path() / "wayfuse-eval-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error(pattern + ": cannot make a temporary folder");
  path_ = pattern;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

BuildingRecord record_of(const RecordedSite& site) {
  BuildingRecord record;
  record.name = site.name;
  record.georeference = site.georeference;
  record.floors = site.floors;
  return record;
}

Result<std::vector<SurveyBatch>> batches_of(const RecordedWalk& walk) {
  Surveyor surveyor(walk.device_model.empty() ? "unknown" : walk.device_model, Random(fnv1a(walk.id)));
  if (const auto begun = surveyor.begin_walk(walk.id); !begun) return begun.fault();
  std::optional<PhoneTime> marked;
  for (const TruePoint& point : walk.way_points) {
    if (marked == point.time) continue;  // marked twice in one millisecond
    marked = point.time;
    if (const auto done = surveyor.mark(point.time, {point.point, walk.floor}, 0.0); !done) return done.fault();
  }
  for (const RssScan& scan : walk.scans) {
    if (const auto done = surveyor.scan(scan, UnixTime(scan.time.time_since_epoch())); !done) return done.fault();
  }
  if (const auto ended = surveyor.end_walk(); !ended) return ended.fault();
  return surveyor.take_batches();
}

ClientSettings phone_settings(Role role, BuildingId building, std::string device_model) {
  ClientSettings settings;
  settings.role = role;
  settings.building = building;
  settings.device_model = std::move(device_model);
  settings.app = "wayfuse-eval";
  settings.batch_interval = settings.rest_interval = Duration{0};  // the position is measured, not the radio's sleep
  return settings;
}

Result<void> upload_survey(Client& client, const std::vector<RecordedWalk>& survey, const std::optional<Fault>& refused,
                           const std::function<void()>& work, const std::function<void(std::vector<SurveyBatch>&)>& spoil) {
  const auto settle = [&](std::size_t waiting) -> Result<void> {
    for (int turn = 0; client.uploads_waiting() > waiting; ++turn) {
      if (refused) return *refused;
      if (turn == kTurnsMost) return Fault{FaultCode::kTimeout, "survey", "an upload was never acknowledged"};
      work();
    }
    return {};
  };
  for (const RecordedWalk& walk : survey) {
    auto batches = batches_of(walk);
    if (!batches) {
      std::fprintf(stderr, "left out of the survey: %s: %s\n", walk.id.c_str(), to_string(batches.fault()).c_str());
      continue;
    }
    if (spoil) spoil(*batches);
    for (SurveyBatch& batch : *batches) {
      if (const auto queued = client.upload(std::move(batch)); !queued) return queued;
      if (const auto settled = settle(kUploadsAhead); !settled) return settled;
    }
  }
  return settle(0);
}

}  // namespace wayfuse
