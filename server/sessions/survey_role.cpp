#include <algorithm>

#include "server/sessions/role.hpp"

namespace wayfuse {
namespace {

/// Batches go to the store; each is acknowledged after COMMIT and not before [SAFETY C18].
class SurveyRole final : public RoleConversation, public std::enable_shared_from_this<SurveyRole> {
 public:
  SurveyRole(RoleSeat seat, BuildingId building)
      : world_(seat.world), output_(seat.output), post_(std::move(seat.post)), building_(building) {}

  bool receive(ClientMessage& message) override {
    if (const auto* walk = std::get_if<SurveyWalk>(&message)) {
      world_.counters.survey_refused++;
      output_.send(
          report({FaultCode::kUnexpectedMessage, "type", "this server takes placed points: send the walk as survey batches"}, 0,
                 walk->idempotency_key));
      return true;
    }
    auto* batch = std::get_if<SurveyBatch>(&message);
    if (!batch) return false;
    if (in_flight_ >= world_.settings.survey_batches_in_flight) {
      world_.counters.survey_refused++;
      output_.send(report({FaultCode::kRateLimited, "", "too many batches wait for the store"}, 0, batch->idempotency_key,
                          std::chrono::seconds(1)));
      return true;
    }
    ++in_flight_;
    const std::string key = batch->idempotency_key;
    const auto points = batch->points.size();
    world_.store.store(
        building_, std::move(*batch),
        [weak = weak_from_this(), &world = world_, building = building_, post = post_, key, points](Result<SurveyAck> answer) {
          if (answer) {
            world.counters.survey_batches++;
            world.counters.survey_points += points;
            world.survey_changed(building);
          } else {
            world.counters.survey_refused++;
          }
          post([weak, key, answer = std::move(answer)] {
            if (const auto self = weak.lock()) self->stored(key, answer);
          });
        });
    return true;
  }

  void tick() override {}
  void goodbye() override { connected_ = false; }
  void disconnected() override { connected_ = false; }

 private:
  void stored(const std::string& key, const Result<SurveyAck>& answer) {
    --in_flight_;
    if (!connected_) return;
    if (answer) return output_.send(*answer);
    const FaultCode code = answer.fault().code;
    const bool passing = code == FaultCode::kStorageFull || code == FaultCode::kStorageFailed || code == FaultCode::kStoreBusy;
    output_.send(report(answer.fault(), 0, key, passing ? Duration(std::chrono::seconds(5)) : Duration{0}));
  }

  SessionWorld& world_;
  SessionOutput& output_;
  const Post post_;
  const BuildingId building_;
  std::size_t in_flight_ = 0;
  bool connected_ = true;
};

}  // namespace

Result<std::shared_ptr<RoleConversation>> begin_surveying(RoleSeat seat, const Hello& hello) {
  const BuildingId building = hello.building.value != 0 ? hello.building : seat.rights.building;
  const auto known = seat.world.store.buildings();
  if (std::ranges::find(known, building) == known.end()) {
    return Fault{FaultCode::kUnknownBuilding, "building", "there is no such building for this key"};
  }
  const auto snapshot = seat.world.buildings.find(building);
  Welcome welcome = welcome_from(seat.world, snapshot.get(), seat.rights.expires_at);
  welcome.building = building;
  seat.output.send(welcome);
  return std::shared_ptr<RoleConversation>(std::make_shared<SurveyRole>(std::move(seat), building));
}

}  // namespace wayfuse
