#pragma once

#include "admin/recording_control.hpp"

namespace wayfuse {

/// Building 1 has one recording, number 7, of phone-1.
class FakeRecordings final : public RecordingControl {
 public:
  Result<RecordingState> order(BuildingId building, const RecordingOrder& order) override {
    if (building.value != 1) return no_building();
    ordered = order;
    RecordingState state;
    if (order.on_for > Duration{0}) state.until = UnixTime{order.on_for};
    state.bytes = order.bytes, state.kept = order.kept, state.tracked = order.tracked;
    return state;
  }
  Result<RecordingState> state(BuildingId building) const override {
    if (building.value != 1) return no_building();
    return RecordingState{};
  }
  Result<std::vector<RecordingSummary>> recordings(BuildingId building, std::uint64_t after, std::size_t most) const override {
    if (building.value != 1) return no_building();
    std::vector<RecordingSummary> found;
    for (const std::uint64_t id : {7u, 8u, 9u}) {
      if (id > after && found.size() < most) found.push_back(summary(id));
    }
    return found;
  }
  Result<RecordingSummary> recording(std::uint64_t id, BuildingId building) const override {
    if (id != 7 || building.value > 1) return none();
    return summary(id);
  }
  Result<std::shared_ptr<BodySource>> content(std::uint64_t id, BuildingId building) const override {
    if (id != 7 || building.value > 1) return none();
    return std::shared_ptr<BodySource>(std::make_shared<OneLine>());
  }
  Result<void> erase(std::uint64_t id, BuildingId building) override {
    if (id != 7 || building.value > 1) return none();
    return {};
  }
  Result<std::size_t> erase_all(BuildingId building, const std::string& tracked) override {
    if (building.value != 1) return no_building();
    return tracked.empty() ? 3u : 1u;
  }
  void replay(std::uint64_t id, BuildingId building, const ReplayQuestion& question, std::function<void(Result<ReplayAnswer>)> done) override {
    if (id != 7 || building.value > 1) return done(none());
    asked = question;
    ReplayAnswer answer;
    answer.pipeline = question.pipeline.empty() ? "default" : question.pipeline;
    answer.as_it_was = question.pipeline.empty();
    answer.steps = 3;
    ReplayStep without;
    without.number = 1, without.at = PhoneTime{std::chrono::seconds(1)}, without.applied_through = 2, without.map_version = 4;
    without.no_position = Fault{FaultCode::kNotFound, "", "no fresh scan heard yet"};
    ReplayStep with;
    with.number = 2, with.at = PhoneTime{std::chrono::seconds(2)}, with.applied_through = 4, with.map_version = 4;
    with.said = true, with.as_live = true;
    with.explanation = Explanation{};
    with.explanation->tracked = "phone-1", with.explanation->pipeline = answer.pipeline;
    with.explanation->readings = {{Bssid{1}, -61.0, std::chrono::milliseconds(300), "", -55.0, 24}};
    answer.page = {without, with};
    answer.remarks = {"older pieces of the recording are gone"};
    done(std::move(answer));
  }

  std::optional<RecordingOrder> ordered;
  std::optional<ReplayQuestion> asked;

 private:
  class OneLine final : public BodySource {
   public:
    std::optional<std::string> next() override { return said_++ == 0 ? std::optional<std::string>("{\"type\":\"wayfuse-recording\"}\n") : std::nullopt; }
    void on_ready(std::function<void()>) override {}

   private:
    int said_ = 0;
  };
  static RecordingSummary summary(std::uint64_t id) {
    RecordingSummary summary;
    summary.id = id, summary.building = {1}, summary.tracked = "phone-1", summary.pipeline = "default", summary.seed = ~std::uint64_t{0};
    return summary;
  }
  static Fault no_building() { return {FaultCode::kUnknownBuilding, "building", "there is no such building"}; }
  static Fault none() { return {FaultCode::kNotFound, "recording", "there is no recording of this number here"}; }
};

}  // namespace wayfuse
