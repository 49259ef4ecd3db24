#include <algorithm>
#include <set>

#include "server/sessions/role.hpp"

namespace wayfuse {
namespace {

/// Shows an observer where phones are: the newest of each, never a backlog. What changes while the observer is slow is seen
/// when it has caught up [SAFETY C12].
///
/// Who watches is written down first: nothing is shown before the line in the audit is durable [SAFETY C19].
class ObserveRole final : public RoleConversation, public std::enable_shared_from_this<ObserveRole> {
 public:
  ObserveRole(RoleSeat seat, BuildingId building)
      : world_(seat.world),
        output_(seat.output),
        post_(std::move(seat.post)),
        key_id_(seat.rights.key_id),
        coarse_(seat.rights.coarse),
        building_(building) {}

  bool receive(ClientMessage& message) override {
    const auto* subscribe = std::get_if<Subscribe>(&message);
    if (!subscribe) return false;
    if (subscribe->positions && coarse_) {
      output_.send(report({FaultCode::kNotAllowed, "positions", "the key sees zones only; ask for positions: false"}));
      return true;
    }
    if (subscribe->zone_events && !world_.zones) {
      output_.send(report({FaultCode::kUnexpectedMessage, "zone_events", "this server watches no zones"}));
      return true;
    }
    AuditRecord line;
    line.at = world_.clock.wall_now();
    line.key_id = key_id_;
    line.building = building_;
    line.action = "observe";
    world_.store.audit(std::move(line), [weak = weak_from_this(), post = post_, wanted = *subscribe](Result<void> written) {
      post([weak, wanted, written = std::move(written)] {
        if (const auto self = weak.lock()) self->begin(wanted, written);
      });
    });
    return true;
  }

  void tick() override {
    if (subscription_ && world_.clock.now() - shown_at_ >= interval_) show();
  }
  Duration tick_interval() const override { return subscription_ ? interval_ : Duration(std::chrono::seconds(1)); }
  bool must_speak() const override { return false; }
  void goodbye() override { connected_ = false; }
  void disconnected() override {
    connected_ = false;
    subscription_.reset();
  }

 private:
  void begin(const Subscribe& wanted, const Result<void>& written) {
    if (!connected_) return;
    if (!written) return output_.send(report(written.fault()));
    subscription_ = wanted;
    interval_ = std::max(wanted.min_interval, world_.settings.least_observation_interval);
    seen_ = 0;
    shown_.clear();
    if (wanted.zone_events) told_through_ = world_.zones->newest_event();
    show();
  }

  void show() {
    shown_at_ = world_.clock.now();
    if (subscription_->zone_events) tell_events();
    if (!subscription_->positions) return;
    while (!output_.congested()) {
      auto changes = world_.board.changes_after(seen_, building_, Limits::kObservedPerMessage);
      const bool more = changes.observed.size() == Limits::kObservedPerMessage;
      seen_ = changes.through;
      Observation observation;
      for (Observed& observed : changes.observed) {
        if (wanted(observed)) observation.tracked.push_back(std::move(observed));
      }
      if (!observation.tracked.empty()) {
        world_.counters.observations++;
        output_.send(observation);
      }
      if (!more) return;
    }
  }

  // Events are not conflated: a slow observer gets the rest later, out of the log. One that falls out of the log is told.
  void tell_events() {
    while (!output_.congested()) {
      const auto news = world_.zones->events_after(told_through_, building_, kEventsAtOnce);
      if (news.missed) {
        output_.send(report({FaultCode::kOverloaded, "zone_events", "some events are forgotten by now: ask for the zones' occupants"}));
      }
      if (news.through == told_through_) return;
      told_through_ = news.through;
      for (const NumberedZoneEvent& event : news.events) {
        if (!wanted(event.event)) continue;
        world_.counters.zone_events++;
        output_.send(event.event);
      }
    }
  }

  bool wanted(const ZoneEvent& event) const {
    const auto& floors = subscription_->floors;
    const auto& names = subscription_->tracked;
    return (names.empty() || std::ranges::find(names, event.tracked) != names.end()) &&
           (floors.empty() || std::ranges::find(floors, event.floor) != floors.end());
  }

  // A phone that left the floors asked for is shown once more, as gone, or its marker would stand there for ever.
  bool wanted(Observed& observed) {
    const auto& floors = subscription_->floors;
    const auto& names = subscription_->tracked;
    if (!names.empty() && std::ranges::find(names, observed.tracked) == names.end()) return false;
    const bool here = floors.empty() || std::ranges::find(floors, observed.position.place.floor) != floors.end();
    const bool known = shown_.contains(observed.tracked);
    if (observed.gone || !here) {
      shown_.erase(observed.tracked);
      observed.gone = true;
      return known;
    }
    shown_.insert(observed.tracked);
    return true;
  }

  SessionWorld& world_;
  SessionOutput& output_;
  const Post post_;
  const std::uint64_t key_id_;
  const bool coarse_;
  const BuildingId building_;
  static constexpr std::size_t kEventsAtOnce = 16;
  bool connected_ = true;
  std::uint64_t told_through_ = 0;
  std::optional<Subscribe> subscription_;
  Duration interval_{0};
  ServerTime shown_at_;
  std::uint64_t seen_ = 0;
  std::set<std::string> shown_;
};

}  // namespace

Result<std::shared_ptr<RoleConversation>> begin_observing(RoleSeat seat, const Hello& hello) {
  const BuildingId building = hello.building.value != 0 ? hello.building : seat.rights.building;
  std::shared_ptr<const Building> snapshot;
  if (building.value != 0) {
    auto found = ready_building(seat.world.buildings, seat.world.store, building);
    if (!found) return found.fault();
    snapshot = *std::move(found);
  }
  seat.output.send(welcome_from(seat.world, snapshot.get(), seat.rights.expires_at));
  return std::shared_ptr<RoleConversation>(std::make_shared<ObserveRole>(std::move(seat), building));
}

}  // namespace wayfuse
