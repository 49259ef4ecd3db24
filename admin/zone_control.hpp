#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "wayfuse/proto/message.hpp"
#include "wayfuse/proto/place.hpp"

namespace wayfuse {

/// A zone event with its place in the order of this server's events.
struct NumberedZoneEvent {
  std::uint64_t number = 0;
  BuildingId building;
  ZoneEvent event;
};

/// A phone that is in a zone now.
struct ZoneOccupant {
  std::string tracked;
  UnixTime since;
  double probability = 0.0;        ///< mass of its newest position inside
};

/// The window on the zones of a running server: who is where, and what happened lately. Everything is in memory only [C19].
///
/// Thread: any.
class ZoneControl {
 public:
  virtual ~ZoneControl() = default;
  /// A building's zones were changed in the store, or the building is gone: they are read anew.
  virtual void zones_changed(BuildingId building) = 0;
  /// Ascending by name.
  virtual std::vector<ZoneOccupant> occupants(BuildingId building, std::uint64_t zone) const = 0;
  /// Names of the zones each phone is in; phones in none are left out. Building 0 = all.
  virtual std::map<std::string, std::vector<std::string>> zones_by_phone(BuildingId building) const = 0;

  struct News {
    std::vector<NumberedZoneEvent> events;   ///< ascending
    std::uint64_t through = 0;               ///< ask for what came after this next time
    bool missed = false;                     ///< some that came after `number` are forgotten by now
  };
  /// Events of a building (0 = all) that came after event `number`, at most `most`.
  virtual News events_after(std::uint64_t number, BuildingId building, std::size_t most) const = 0;
  /// The number of the newest event of all; 0 = none yet.
  virtual std::uint64_t newest_event() const = 0;
  /// Tells this server's numbers from an earlier one's; an event's id is `<epoch>-<number>`.
  virtual std::uint64_t event_epoch() const = 0;
  /// Calls `told` after each event, on the thread that found it, until the answer is destroyed. It must be quick.
  virtual std::shared_ptr<void> on_event(std::function<void()> told) = 0;
};

}  // namespace wayfuse
