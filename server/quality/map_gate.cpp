#include "server/quality/map_gate.hpp"

#include "server/quality/recorded_track.hpp"

namespace wayfuse {

std::vector<QualityWalk> read_walks(const std::vector<StoredQualityWalk>& walks, const MagneticField& field, std::vector<std::string>& remarks) {
  std::vector<QualityWalk> ready;
  for (const StoredQualityWalk& walk : walks) {
    auto recording = read_recording(walk.content, field);
    if (recording) {
      ready.push_back({walk.record.id, std::move(recording->track)});
    } else {
      remarks.push_back("quality walk '" + walk.record.name + "' is left out: " + to_string(recording.fault()));
    }
  }
  return ready;
}

MapJudgement judge_map(const Building& candidate, const Building* live, const std::vector<StoredQualityWalk>& walks, UnixTime now) {
  MapJudgement judgement;
  const std::string survey = "survey version " + std::to_string(candidate.record().survey_version);
  judgement.reason = survey;
  if (live == nullptr || live->map_version() == 0) return judgement;
  std::vector<std::string> remarks;
  const auto ready = read_walks(walks, candidate.record().magnetic_field, remarks);
  const auto after = measure(candidate, "", ready, now);
  const auto before = measure(*live, "", ready, now);
  if (!after || !before) {
    judgement.reason += "; not measured: " + to_string(after ? before.fault() : after.fault());
    return judgement;
  }
  const MapComparison comparison = compare(*after, *before);
  judgement.publish = comparison.verdict != Verdict::kWorse;
  judgement.reason += "; " + std::string(to_string(comparison.verdict));
  for (const std::string& reason : comparison.reasons) judgement.reason += ": " + reason;
  judgement.qualities = *after;
  judgement.qualities.insert(judgement.qualities.end(), before->begin(), before->end());
  return judgement;
}

}  // namespace wayfuse
