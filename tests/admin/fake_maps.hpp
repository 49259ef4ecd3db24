#pragma once

#include "admin/map_control.hpp"

namespace wayfuse {

/// Answers every question about maps at once with something small, and remembers the last promotion.
class FakeMaps final : public MapControl {
 public:
  void build_map(BuildingId, Done<std::uint64_t> done) override { done(Fault{FaultCode::kEmptyRadioMap, "survey", "no points"}); }
  void compare_map(BuildingId, std::uint64_t version, const std::string& pipeline, Done<MapComparisonView> done) override {
    done(comparison(version, pipeline));
  }
  void promote_map(BuildingId, const MapPromotion& promotion, Done<MapPromoted> done) override {
    promoted = promotion;
    MapPromoted answer{std::nullopt, comparison(promotion.version, "")};
    if (promotion.override_gate) answer.publication = Publication{1, promotion.version, Publication::Act::kPromoted, {}, promotion.by_key, promotion.reason};
    done(std::move(answer));
  }
  void roll_back_map(BuildingId, std::uint64_t by_key, const std::string& reason, Done<Publication> done) override {
    done(Publication{2, 1, Publication::Act::kRolledBack, {}, by_key, reason});
  }
  void expected_accuracy(BuildingId, FloorOrdinal floor, Done<ExpectedAccuracy> done) override {
    ExpectedAccuracy accuracy;
    accuracy.floor = floor;
    accuracy.columns = 2, accuracy.rows = 1;
    accuracy.points = {3, 0};
    accuracy.expected_m = {2.504, std::nullopt};
    accuracy.median_m = 2.5;
    done(std::move(accuracy));
  }
  void survey_plan(BuildingId, FloorOrdinal floor, Done<SurveyPlan> done) override {
    done(SurveyPlan{floor, 4.1, {{{{0, 0}, {40, 0}}, 40.0, 3.2, "new ground"}}});
  }
  void access_points(BuildingId, Done<std::vector<AccessPointView>> done) override { done(std::vector{view()}); }
  void trust_access_point(BuildingId, Bssid, AccessPointTrust trust, Done<AccessPointView> done) override {
    AccessPointView answer = view();
    answer.record.trust = trust;
    done(std::move(answer));
  }
  void walks_changed(BuildingId) override { ++walks_changes; }
  Result<RecordingFacts> check_recording(const std::string& content) const override {
    if (content.empty()) return Fault{FaultCode::kMalformed, "line 1", "the recording is empty"};
    return RecordingFacts{"Model", UnixTime(std::chrono::seconds(1'700'000'000))};
  }

  MapPromotion promoted;
  int walks_changes = 0;

 private:
  static MapComparisonView comparison(std::uint64_t version, const std::string& pipeline) {
    MapComparisonView view;
    view.version = version;
    view.live = 1;
    view.pipeline = pipeline;
    view.verdict = "worse";
    view.reasons = {"the mean error rises"};
    return view;
  }
  static AccessPointView view() {
    AccessPointView view;
    view.record.bssid = {0x001b2c000001};
    view.record.state = AccessPointState::kMoved;
    view.record.distance_m = 61.0;
    view.on_map = true;
    view.resurvey = {{{1, 2}, {0}}};
    return view;
  }
};

}  // namespace wayfuse
