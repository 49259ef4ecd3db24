#include "server/maps/map_desk.hpp"

#include <algorithm>

#include "server/quality/map_gate.hpp"
#include "server/quality/recorded_track.hpp"
#include "server/quality/survey_planner.hpp"

namespace wayfuse {

namespace {
constexpr std::size_t kDoubtsNamed = 20;
}  // namespace

/// Two maps, the walks, and what is known of how each map does on them.
struct MapDesk::Case {
  BuildingRecord record;
  std::string pipeline;                  // asked for; empty = the building's own
  std::string with;                      // fingerprint of the pipeline in force
  MapMaterial candidate;
  std::optional<MapMaterial> live;       // absent: nothing is in force
  std::vector<StoredQualityWalk> walks;
  std::vector<MapQuality> candidate_quality;
  std::vector<MapQuality> live_quality;
  std::vector<MapQuality> fresh;         // to be noted
  std::vector<std::string> remarks;

  bool complete(const std::vector<MapQuality>& known) const {
    return std::ranges::all_of(walks, [&](const StoredQualityWalk& walk) {
      const auto found = std::ranges::find(known, walk.record.id, &MapQuality::walk_id);
      return found != known.end() && found->measured_with == with;
    });
  }

  Result<void> measure_side(MapMaterial material, std::span<const QualityWalk> ready, std::vector<MapQuality>& known, bool remark, UnixTime now) {
    if (complete(known) && !remark) return {};
    const auto building = Building::make(record, std::move(material));
    if (!building) return building.fault();
    if (remark) look_over(**building);
    if (complete(known)) return {};
    auto measured = measure(**building, pipeline, ready, now);
    if (!measured) return measured.fault();
    known = *std::move(measured);
    fresh.insert(fresh.end(), known.begin(), known.end());
    return {};
  }

  /// What an operator should know of the build.
  void look_over(const Building& building) {
    if (!building.map_is_whole()) remarks.emplace_back("points were erased since this version was built");
    if (!building.distrusted().empty()) remarks.push_back(std::to_string(building.distrusted().size()) + " access points are left out: distrusted");
    const auto doubts = building.doubts();
    if (!doubts.empty()) remarks.push_back(std::to_string(doubts.size()) + " points are left out: the rest of the survey contradicts them");
    for (std::size_t i = 0; i < std::min(kDoubtsNamed, doubts.size()); ++i) {
      remarks.push_back((doubts[i].walk.empty() ? "" : "walk '" + doubts[i].walk + "', ") + to_string(doubts[i].doubt));
    }
    for (const std::string& each : building.remarks()) remarks.push_back(each);
  }

  Result<void> measure_both(UnixTime now) {
    const auto ready = read_walks(walks, record.magnetic_field, remarks);
    if (const auto done = measure_side(std::move(candidate), ready, candidate_quality, true, now); !done) return done;
    if (!live) return {};
    return measure_side(std::move(*live), ready, live_quality, false, now);
  }
};

namespace {

std::optional<MapQuality> of_walk(const std::vector<MapQuality>& qualities, std::uint64_t walk) {
  const auto found = std::ranges::find(qualities, walk, &MapQuality::walk_id);
  return found == qualities.end() ? std::nullopt : std::optional(*found);
}

}  // namespace

MapDesk::MapDesk(DatabaseDirectory& store, const BuildingShelf& shelf, BuildingKeeper& keeper, AccessPointDesk& access_points,
                 BuildingKeeper::Run run, std::function<UnixTime()> wall_now)
    : store_(store), shelf_(shelf), keeper_(keeper), access_points_(access_points), run_(std::move(run)), wall_now_(std::move(wall_now)) {}

Result<std::shared_ptr<MapDesk::Case>> MapDesk::read_case(BuildingDatabase& database, std::uint64_t version, const std::string& pipeline) const {
  MapVersions versions(database);
  auto found = std::make_shared<Case>();
  auto record = database.building();
  if (!record) return record.fault();
  found->record = *std::move(record);
  found->pipeline = pipeline;
  const auto spec = preset(pipeline.empty() ? found->record.pipeline : pipeline);
  if (!spec) return spec.fault();
  found->with = measured_with(*spec);
  const auto map = versions.find(version);
  if (!map) return map.fault();
  auto candidate = versions.material(*map);
  if (!candidate) return candidate.fault();
  found->candidate = *std::move(candidate);
  const auto live = versions.live();
  if (!live) return live.fault();
  if (*live) {
    auto material = versions.material(**live);
    if (!material) return material.fault();
    found->live = *std::move(material);
  }
  const auto walks = database.quality_walks();
  if (!walks) return walks.fault();
  for (const QualityWalkRecord& walk : *walks) {
    auto content = database.quality_walk_content(walk.id);
    if (!content) return content.fault();
    found->walks.push_back({walk, *std::move(content)});
  }
  for (const auto& [number, known] : {std::pair(std::optional(version), &found->candidate_quality),
                                      std::pair(*live ? std::optional((*live)->version) : std::nullopt, &found->live_quality)}) {
    if (!number) continue;
    auto qualities = database.qualities(*number);
    if (!qualities) return qualities.fault();
    *known = *std::move(qualities);
  }
  return found;
}

// Reads, replays what is not known yet, writes the new figures down.
void MapDesk::gather(BuildingId building, std::uint64_t version, const std::string& pipeline, Done<std::shared_ptr<Case>> done) {
  store_.with_building(building, [this, building, version, pipeline, done = std::move(done)](Result<BuildingDatabase*> database) {
    if (!database) return done(database.fault());
    const auto found = read_case(**database, version, pipeline);
    if (!found) return done(found.fault());
    run_([this, building, maps = *found, done] {
      if (const auto measured = maps->measure_both(wall_now_()); !measured) return done(measured.fault());
      if (!maps->pipeline.empty() || maps->fresh.empty()) return done(maps);
      store_.with_building(building, [maps, done](Result<BuildingDatabase*> open) {
        if (!open) return done(open.fault());
        for (const MapQuality& quality : maps->fresh) {
          // A walk or map removed meanwhile takes its figures with it.
          if (const auto noted = (*open)->note_quality(quality); !noted && noted.fault().code != FaultCode::kNotFound) return done(noted.fault());
        }
        done(maps);
      });
    });
  });
}

void MapDesk::build_map(BuildingId building, Done<std::uint64_t> done) {
  store_.with_building(building, [this, building, done = std::move(done)](Result<BuildingDatabase*> database) {
    if (!database) return done(database.fault());
    const auto staged = MapVersions(**database).stage(wall_now_());
    if (!staged) return done(staged.fault());
    gather(building, staged->version, "", [version = staged->version, done](Result<std::shared_ptr<Case>> maps) {
      maps ? done(version) : done(maps.fault());
    });
  });
}

void MapDesk::compare_map(BuildingId building, std::uint64_t version, const std::string& pipeline, Done<MapComparisonView> done) {
  gather(building, version, pipeline, [version, done = std::move(done)](Result<std::shared_ptr<Case>> maps) {
    if (!maps) return done(maps.fault());
    const Case& found = **maps;
    const MapComparison comparison = compare(found.candidate_quality, found.live_quality);
    MapComparisonView view;
    view.version = version;
    if (found.live) view.live = found.live->version;
    view.pipeline = found.pipeline.empty() ? found.record.pipeline : found.pipeline;
    view.verdict = to_string(comparison.verdict);
    view.reasons = comparison.reasons;
    view.remarks = found.remarks;
    view.candidate = comparison.candidate.walks > 0 ? comparison.candidate : pool(found.candidate_quality);
    view.in_force = comparison.live.walks > 0 ? comparison.live : pool(found.live_quality);
    view.difference_m = comparison.mean_m.difference;
    view.low_m = comparison.mean_m.interval.low;
    view.high_m = comparison.mean_m.interval.high;
    for (const StoredQualityWalk& walk : found.walks) {
      view.walks.push_back({walk.record.id, walk.record.name, of_walk(found.candidate_quality, walk.record.id),
                            of_walk(found.live_quality, walk.record.id)});
    }
    done(std::move(view));
  });
}

void MapDesk::promote_map(BuildingId building, const MapPromotion& promotion, Done<MapPromoted> done) {
  compare_map(building, promotion.version, "", [this, building, promotion, done = std::move(done)](Result<MapComparisonView> compared) {
    if (!compared) return done(compared.fault());
    if (compared->live == promotion.version) return done(Fault{FaultCode::kConflict, "version", "it is live already"});
    if (promotion.expected_live && promotion.expected_live != compared->live) {
      const std::string now = compared->live ? "version " + std::to_string(*compared->live) : "nothing";
      return done(Fault{FaultCode::kConflict, "expected_live", now + " is live now"});
    }
    if (compared->verdict == to_string(Verdict::kWorse) && !promotion.override_gate) return done(MapPromoted{std::nullopt, *std::move(compared)});
    const auto live = compared->live;
    publish(building, promotion, live, *std::move(compared), done);
  });
}

void MapDesk::publish(BuildingId building, const MapPromotion& promotion, std::optional<std::uint64_t> live, MapComparisonView comparison,
                      Done<MapPromoted> done) {
  store_.with_building(building, [this, building, promotion, live, comparison = std::move(comparison), done = std::move(done)](Result<BuildingDatabase*> database) {
    if (!database) return done(database.fault());
    Publication publication;
    publication.version = promotion.version;
    publication.at = wall_now_();
    publication.by_key = promotion.by_key;
    publication.reason = promotion.reason;
    const auto published = (*database)->promote(publication, live);
    if (!published) return done(published.fault());
    keeper_.refresh(building, [done, promoted = MapPromoted{*published, comparison}] { done(promoted); });  // answered when it is in force
  });
}

void MapDesk::roll_back_map(BuildingId building, std::uint64_t by_key, const std::string& reason, Done<Publication> done) {
  store_.with_building(building, [this, building, by_key, reason, done = std::move(done)](Result<BuildingDatabase*> database) {
    if (!database) return done(database.fault());
    Publication publication;
    publication.at = wall_now_();
    publication.by_key = by_key;
    publication.reason = reason;
    const auto back = (*database)->roll_back(publication);
    if (!back) return done(back);
    keeper_.refresh(building, [done, back] { done(back); });
  });
}

void MapDesk::with_model(BuildingId id, Done<std::shared_ptr<const AccuracyModel>> done) {
  const auto found = ready_building(shelf_, store_, id);
  if (!found) return done(found.fault());
  const std::shared_ptr<const Building> building = *found;
  const auto pipeline = building->pipeline("");
  if (!pipeline) return done(pipeline.fault());
  std::shared_ptr<const AccuracyModel> ready;
  {
    const std::lock_guard lock(mutex_);
    Promise& promise = promises_[id];
    if (promise.building != building) promise = Promise{building, nullptr, std::move(promise.waiting)};
    ready = promise.model;
    if (!ready) {
      promise.waiting.push_back(done);
      if (promise.waiting.size() > 1) return;  // somebody's question is being worked on: the answer serves all
    }
  }
  if (ready) return done(ready);
  run_([this, id, building, spec = (*pipeline)->spec()] {
    const auto model = AccuracyModel::learn(building->site(), spec);
    std::vector<Done<std::shared_ptr<const AccuracyModel>>> waiting;
    {
      const std::lock_guard lock(mutex_);
      Promise& promise = promises_[id];
      if (model && promise.building == building) promise.model = *model;
      waiting.swap(promise.waiting);
    }
    for (const auto& each : waiting) each(model);
  });
}

void MapDesk::expected_accuracy(BuildingId building, FloorOrdinal floor, Done<ExpectedAccuracy> done) {
  with_model(building, [floor, done = std::move(done)](Result<std::shared_ptr<const AccuracyModel>> model) {
    if (!model) return done(model.fault());
    done((*model)->expected(floor));
  });
}

void MapDesk::survey_plan(BuildingId building, FloorOrdinal floor, Done<SurveyPlan> done) {
  with_model(building, [floor, done = std::move(done)](Result<std::shared_ptr<const AccuracyModel>> model) {
    if (!model) return done(model.fault());
    done(plan_survey(**model, floor));
  });
}

void MapDesk::access_points(BuildingId building, Done<std::vector<AccessPointView>> done) { access_points_.list(building, std::move(done)); }

void MapDesk::trust_access_point(BuildingId building, Bssid bssid, AccessPointTrust trust, Done<AccessPointView> done) {
  access_points_.trust(building, bssid, trust, [this, building, done = std::move(done)](Result<AccessPointView> view) {
    if (view) keeper_.refresh(building);
    done(std::move(view));
  });
}

void MapDesk::walks_changed(BuildingId building) {
  store_.with_building(building, [this, building](Result<BuildingDatabase*> database) {
    if (!database) return;
    const auto live = (*database)->live_map();
    if (!live || !*live) return;
    gather(building, **live, "", [this, building](const Result<std::shared_ptr<Case>>&) { keeper_.refresh(building); });
  });
}

Result<MapControl::RecordingFacts> MapDesk::check_recording(const std::string& content) const {
  const auto recording = read_recording(content);
  if (!recording) return recording.fault();
  return RecordingFacts{recording->device_model, recording->recorded_at};
}

}  // namespace wayfuse
