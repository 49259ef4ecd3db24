#include <algorithm>

#include "server/sessions/role.hpp"
#include "wayfuse/proto/codec.hpp"

namespace wayfuse {
namespace {

/// Batches go to the store; each is acknowledged after COMMIT and not before [SAFETY C18].
class SurveyRole final : public RoleConversation, public std::enable_shared_from_this<SurveyRole> {
 public:
  SurveyRole(RoleSeat seat, BuildingId building)
      : world_(seat.world), output_(seat.output), post_(std::move(seat.post)), building_(building) {}

  bool receive(ClientMessage& message) override {
    if (auto* batch = std::get_if<SurveyBatch>(&message)) {
      if (admit(batch->idempotency_key)) store(std::move(*batch));
      return true;
    }
    if (auto* walk = std::get_if<SurveyWalk>(&message)) {
      if (admit(walk->idempotency_key)) store(std::move(*walk));
      return true;
    }
    return false;
  }

  void tick() override {}
  void goodbye() override { connected_ = false; }
  void disconnected() override { connected_ = false; }

 private:
  // False = the connection has too many uploads under way already.
  bool admit(const std::string& key) {
    if (in_flight_ < world_.settings.survey_batches_in_flight) {
      ++in_flight_;
      return true;
    }
    world_.counters.survey_refused++;
    output_.send(report({FaultCode::kRateLimited, "", "too many batches wait for the store"}, 0, key, std::chrono::seconds(1)));
    return false;
  }

  void store(SurveyBatch batch) {
    auto done = answering(batch.idempotency_key, batch.points.size());
    world_.store.store(building_, std::move(batch), std::move(done));
  }

  // A part is kept as it came; the building's keeper places the scans once the walk is whole.
  void store(SurveyWalk walk) {
    WalkPartDraft part{walk.idempotency_key, walk.walk, walk.part, walk.last, static_cast<std::uint32_t>(walk.scans.size()), {}};
    auto done = answering(part.idempotency_key, 0);
    part.content = encode(ClientMessage(std::move(walk)), Encoding::kCbor);
    world_.store.with_building(building_, [part = std::move(part), done = std::move(done)](Result<BuildingDatabase*> database) {
      done(database ? (*database)->store_walk_part(part) : Result<SurveyAck>(database.fault()));
    });
  }

  // Counts the answer, on the store's thread, and brings it back to the connection's strand.
  std::function<void(Result<SurveyAck>)> answering(const std::string& key, std::size_t points) {
    return [weak = weak_from_this(), &world = world_, building = building_, post = post_, key, points](Result<SurveyAck> answer) {
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
    };
  }

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
