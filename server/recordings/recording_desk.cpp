#include "server/recordings/recording_desk.hpp"

#include <algorithm>

#include "server/buildings/map_versions.hpp"

namespace wayfuse {
namespace {

Fault no_recording() { return {FaultCode::kNotFound, "recording", "there is no recording of this number here"}; }

}  // namespace

/// One replay, until its maps are at hand.
struct RecordingDesk::Job {
  std::shared_ptr<const RecordedSession> session;
  RecordingSummary summary;
  TapePieces pieces;
  ReplayQuestion question;
  std::function<void(Result<ReplayAnswer>)> done;
  ReplayStage stage;
  struct Wanted {
    TrackedWith with;
    MapMaterial material;
  };
  std::vector<Wanted> wanted;      // retired, or never in memory
  std::vector<std::string> remarks;
};

Result<void> RecordingDesk::known(BuildingId building) const {
  const auto there = ready_building(buildings_, store_, building);
  return there ? Result<void>{} : there.fault();
}

Result<RecordingState> RecordingDesk::order(BuildingId building, const RecordingOrder& order) {
  if (const auto there = known(building); !there) return there.fault();
  return shelf_.order(building, order);
}

Result<RecordingState> RecordingDesk::state(BuildingId building) const {
  if (const auto there = known(building); !there) return there.fault();
  return shelf_.state(building);
}

Result<std::vector<RecordingSummary>> RecordingDesk::recordings(BuildingId building, std::uint64_t after, std::size_t most) const {
  if (const auto there = known(building); !there) return there.fault();
  return shelf_.list(building, after, most);
}

Result<RecordingSummary> RecordingDesk::recording(std::uint64_t id, BuildingId building) const {
  const auto summary = shelf_.summary(id, building);
  if (!summary) return no_recording();
  return *summary;
}

Result<std::shared_ptr<BodySource>> RecordingDesk::content(std::uint64_t id, BuildingId building) const {
  const auto summary = shelf_.summary(id, building);
  const auto session = shelf_.find(id, building);
  if (!summary || !session) return no_recording();
  const auto in = buildings_.find(session->building);
  return recording_lines(*summary, in ? in->record().name : std::string(), session->tape.pieces());
}

Result<void> RecordingDesk::erase(std::uint64_t id, BuildingId building) {
  if (!shelf_.erase(id, building)) return no_recording();
  return {};
}

Result<std::size_t> RecordingDesk::erase_all(BuildingId building, const std::string& tracked) {
  if (const auto there = known(building); !there) return there.fault();
  return shelf_.erase_all(building, tracked);
}

void RecordingDesk::replay(std::uint64_t id, BuildingId building, const ReplayQuestion& question,
                           std::function<void(Result<ReplayAnswer>)> done) {
  const auto summary = shelf_.summary(id, building);
  auto job = std::make_shared<Job>();
  job->session = shelf_.find(id, building);
  if (!summary || !job->session) return done(no_recording());
  if (!question.pipeline.empty()) {
    if (const auto spec = preset(question.pipeline); !spec) return done(spec.fault());
  }
  job->summary = *summary;
  job->pieces = job->session->tape.pieces();
  job->question = question;
  job->done = std::move(done);
  if (job->pieces.empty()) return job->done(no_recording());
  gather(std::move(job));
}

// Which snapshots are needed, and which of them are still in memory.
void RecordingDesk::gather(std::shared_ptr<Job> job) {
  auto with = tracked_with(job->pieces);
  const bool elsewhere = job->question.map_version &&
                         std::ranges::any_of(with, [&](const TrackedWith& each) { return each.map_version != *job->question.map_version; });
  if (elsewhere) {  // one map for all, under the description that was in force last
    TrackedWith instead = with.back();
    instead.map_version = *job->question.map_version;
    instead.snapshot = buildings_.find(job->session->building);
    const auto now = instead.snapshot.lock();
    if (!now || now->map_version() != instead.map_version || !TrackedWith::same_description(now->record(), *instead.description)) instead.snapshot.reset();
    with = {instead};
  }
  for (TrackedWith& each : with) {
    const auto alike = [&](const auto& other) { return other.same_map(each); };
    if (std::ranges::any_of(job->stage.buildings, alike, [](const auto& made) -> const TrackedWith& { return made.first; })) continue;
    if (std::ranges::any_of(job->wanted, alike, &Job::Wanted::with)) continue;
    if (auto alive = each.snapshot.lock()) {
      job->stage.buildings.emplace_back(each, std::move(alive));
    } else {
      job->wanted.push_back({each, {}});
    }
  }
  if (job->wanted.size() > kMapsMade) {
    return job->done(Fault{FaultCode::kConflict, "radio_map_version",
                           "the recording went over " + std::to_string(job->wanted.size()) + " maps that are retired; name one to replay it on"});
  }
  if (elsewhere && job->wanted.empty()) job->stage.instead = job->stage.buildings.front().second;
  if (job->wanted.empty()) return run_([this, job] { play(job); });
  store_.with_building(job->session->building, [this, job, elsewhere](Result<BuildingDatabase*> database) {
    if (!database) return job->done(database.fault());
    if (const auto read = read_maps(*job, **database); !read) return job->done(read.fault());
    run_([this, job, elsewhere] {
      for (Job::Wanted& wanted : job->wanted) {
        const auto made = Building::make(*wanted.with.description, std::move(wanted.material));
        if (!made) return job->done(made.fault());
        if (!(*made)->map_is_whole()) job->remarks.push_back("points of radio map " + std::to_string(wanted.with.map_version) + " were erased since: it is not what it was");
        job->stage.buildings.emplace_back(wanted.with, *made);
        if (elsewhere) job->stage.instead = *made;
      }
      play(job);
    });
  });
}

Result<void> RecordingDesk::read_maps(Job& job, BuildingDatabase& database) const {
  MapVersions versions(database);
  for (Job::Wanted& wanted : job.wanted) {
    if (wanted.with.map_version == 0) continue;  // nothing surveyed
    const auto map = versions.find(wanted.with.map_version);
    if (!map) return Fault{map.fault().code, "radio_map_version", map.fault().cause};
    auto material = versions.material(*map);
    if (!material) return material.fault();
    wanted.material = *std::move(material);
  }
  return {};
}

void RecordingDesk::play(std::shared_ptr<Job> job) {
  auto answer = wayfuse::replay(job->pieces, job->session->seed, job->stage, job->question);
  if (!answer) return job->done(answer.fault());
  if (job->summary.pieces_dropped > 0) answer->remarks.emplace_back("older pieces of the recording are gone: it begins in the middle of the walk");
  if (!answer->as_it_was && !job->summary.from_the_start) {
    answer->remarks.emplace_back("the recording begins in the middle of the walk: the other pipeline or map begins where the live one stood");
  }
  answer->remarks.insert(answer->remarks.end(), job->remarks.begin(), job->remarks.end());
  for (ReplayStep& step : answer->page) {
    if (step.explanation) step.explanation->tracked = job->session->tracked;
  }
  job->done(std::move(answer));
}

}  // namespace wayfuse
