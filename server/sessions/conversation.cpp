#include <algorithm>
#include <utility>

#include "server/sessions/role.hpp"

namespace wayfuse {
namespace {

class ClientConversation final : public Conversation {
 public:
  ClientConversation(SessionWorld& world, SessionOutput& output, Post post, std::optional<Rights> rights,
                     Authenticate authenticate)
      : world_(world),
        output_(output),
        post_(std::move(post)),
        rights_(std::move(rights)),
        authenticate_(std::move(authenticate)),
        last_valid_(world.clock.now()) {}

  void receive(ClientMessage message) override {
    if (over_) return;
    if (!role_) return greet(message);
    if (std::holds_alternative<Goodbye>(message)) return leave();
    if (const auto* refresh = std::get_if<TokenRefresh>(&message)) return renew(*refresh);
    if (const auto* probe = std::get_if<ClockProbe>(&message)) {
      output_.send(ClockAnswer{probe->phone_time, world_.clock.wall_now()});
    } else if (!role_->receive(message)) {
      output_.send(report({FaultCode::kUnexpectedMessage, "type", "this message does not belong in the session's role"}));
      return;
    }
    last_valid_ = world_.clock.now();
  }

  void receive(const Fault& malformed) override {
    if (over_) return;
    world_.counters.malformed_messages++;
    if (!role_ || face_of(malformed.code).close_code != 0) return end(malformed);
    if (++malformed_ >= world_.settings.malformed_most) return end({FaultCode::kMalformed, "", "too many malformed messages"});
    output_.send(report(malformed));
  }

  void tick() override {
    if (over_) return;
    if (rights_ && rights_->expires_at && world_.clock.wall_now() >= *rights_->expires_at) {
      return end({FaultCode::kNotAuthenticated, "token", "it has expired"});
    }
    const Duration silence = world_.clock.now() - last_valid_;
    if (!role_) {
      if (silence > world_.settings.hello_deadline) end({FaultCode::kTimeout, "", "no hello came"});
      return;
    }
    if (role_->must_speak() && silence > world_.settings.idle_deadline) {
      return end({FaultCode::kTimeout, "", "no valid message came for too long"});
    }
    role_->tick();
  }

  Duration tick_interval() const override { return role_ ? role_->tick_interval() : Duration(std::chrono::seconds(1)); }

  void disconnected() override {
    over_ = true;
    if (role_) role_->disconnected();
  }

 private:
  void greet(const ClientMessage& message) {
    const auto* hello = std::get_if<Hello>(&message);
    if (!hello) return end({FaultCode::kHelloExpected, "type", "the first message must be hello"});
    if (!rights_) {
      auto found = authenticate_(hello->token);
      if (!found) return end(found.fault());
      rights_ = *std::move(found);
    }
    auto role = begin(*hello);
    if (!role) return end(role.fault());
    role_ = *std::move(role);
    last_valid_ = world_.clock.now();
  }

  Result<std::shared_ptr<RoleConversation>> begin(const Hello& hello) {
    if (!rights_->may(hello.role)) return Fault{FaultCode::kNotAllowed, "role", "the key's scope does not cover this role"};
    if (hello.building.value != 0 && !rights_->covers(hello.building)) {
      return Fault{FaultCode::kUnknownBuilding, "building", "there is no such building for this key"};
    }
    RoleSeat seat{world_, output_, post_, *rights_};
    switch (hello.role) {
      case Role::kTrack:
        return begin_tracking(std::move(seat), hello);
      case Role::kSurvey:
        return begin_surveying(std::move(seat), hello);
      case Role::kObserve:
        return begin_observing(std::move(seat), hello);
    }
    return Fault{FaultCode::kUnknownName, "role", "no such role"};
  }

  // A fresh token must open the same doors: a session does not change its owner.
  void renew(const TokenRefresh& refresh) {
    auto found = authenticate_(refresh.token);
    if (!found) return output_.send(report(found.fault()));
    std::optional<UnixTime> expires_at = found->expires_at;
    Rights same = *std::move(found);
    same.expires_at = rights_->expires_at;
    if (same != *rights_) {
      return output_.send(report({FaultCode::kNotAllowed, "token", "it is not this session's key with the same scope"}));
    }
    rights_->expires_at = expires_at;
    last_valid_ = world_.clock.now();
    output_.send(TokenAccepted{time_left(world_, expires_at)});
  }

  void leave() {
    over_ = true;
    role_->goodbye();
    output_.finish();
  }

  void end(const Fault& reason) {
    over_ = true;
    if (role_) role_->disconnected();
    output_.close(reason);
  }

  SessionWorld& world_;
  SessionOutput& output_;
  const Post post_;
  std::optional<Rights> rights_;
  const Authenticate authenticate_;
  std::shared_ptr<RoleConversation> role_;
  ServerTime last_valid_;
  std::size_t malformed_ = 0;
  bool over_ = false;
};

}  // namespace

std::shared_ptr<Conversation> begin_conversation(SessionWorld& world, SessionOutput& output, Post post,
                                                 std::optional<Rights> rights, Authenticate authenticate) {
  return std::make_shared<ClientConversation>(world, output, std::move(post), std::move(rights), std::move(authenticate));
}

Duration time_left(const SessionWorld& world, std::optional<UnixTime> expires_at) {
  return expires_at ? std::max(Duration{1}, Duration(*expires_at - world.clock.wall_now())) : Duration{0};
}

Welcome welcome_from(const SessionWorld& world, const Building* building, std::optional<UnixTime> expires_at) {
  Welcome welcome;
  welcome.session = welcome.tracked = "-";  // only the track role has a session to resume
  welcome.token_expires_in = time_left(world, expires_at);
  welcome.epoch = world.sessions.epoch();
  welcome.server_wall_time = world.clock.wall_now();
  welcome.keep_alive = world.settings.keep_alive;
  welcome.sample_ring = world.settings.sample_ring;
  if (building) {
    const BuildingRecord& record = building->record();
    welcome.building = record.id;
    welcome.building_name = record.name;
    welcome.georeference = record.georeference;
    welcome.magnetic_field = record.magnetic_field;
    welcome.pipeline = record.pipeline;
    welcome.radio_map_version = building->map_version();
    for (const Floor& floor : record.floors) {
      if (welcome.floors.size() < Limits::kFloorsPerMessage) welcome.floors.push_back({floor.ordinal, floor.label});
    }
    std::ranges::sort(welcome.floors, {}, &FloorName::floor);
  }
  return welcome;
}

}  // namespace wayfuse
