#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "admin/zone_control.hpp"
#include "db/database_directory.hpp"
#include "server/zones/zone_event_log.hpp"
#include "server/zones/zone_presence.hpp"
#include "server/zones/zone_set.hpp"

namespace wayfuse {

/// What happened in the zones, for the metrics. Counts only grow.
struct ZoneCounters {
  using Count = std::atomic<std::uint64_t>;
  Count entered{0};
  Count left{0};
  Count withdrawn{0};              ///< transitions taken back because the position was corrected
};

/// Watches every tracked phone against every zone of its building and writes what happens into the event log.
///
/// Thread: any. Two mutexes, over the zone sets and over the table of phones, held for a look-up only; each phone has one of
/// its own for the time of its masses, so that phones do not wait for each other.
class ZoneWatch final : public ZoneControl {
 public:
  ZoneWatch(DatabaseDirectory& store, const Clock& clock, std::uint64_t epoch, ZoneRules rules);

  /// A position of a phone. One that is `suspect` changes nothing.
  void moved(const std::string& tracked, const FusedPosition& position);
  /// The session ended: the phone leaves every zone it is in.
  void gone(const std::string& tracked);
  /// Delayed exits and timeouts; to be called about once a second.
  void tick();
  /// Instead of reading the store.
  void put_zones(BuildingId building, std::vector<ZoneRecord> zones);

  const ZoneCounters& counters() const { return counters_; }
  std::size_t occupied() const;    ///< phones in zones, each counted once a zone
  std::size_t zones() const;

  // ---- ZoneControl
  void zones_changed(BuildingId building) override;
  std::vector<ZoneOccupant> occupants(BuildingId building, std::uint64_t zone) const override;
  std::map<std::string, std::vector<std::string>> zones_by_phone(BuildingId building) const override;
  News events_after(std::uint64_t number, BuildingId building, std::size_t most) const override {
    return log_.after(number, building, most);
  }
  std::uint64_t newest_event() const override { return log_.newest(); }
  std::uint64_t event_epoch() const override { return log_.epoch(); }
  std::shared_ptr<void> on_event(std::function<void()> told) override { return log_.on_event(std::move(told)); }

 private:
  struct Stay {
    ZonePresence presence;
    UnixTime since;
    std::string told;              ///< id of the last event told of this phone in this zone
  };
  struct Phone {
    std::mutex mutex;
    BuildingId building;
    std::shared_ptr<const ZoneSet> zones;
    std::optional<PhoneTime> valid_at;
    std::map<std::uint64_t, Stay> stays;
    bool gone = false;
  };
  using Phones = std::map<std::string, std::shared_ptr<Phone>>;

  std::shared_ptr<const ZoneSet> zones_of(BuildingId building) const;
  std::shared_ptr<Phone> phone_of(const std::string& tracked);
  Phones phones() const;
  void look_at(const std::string& tracked, Phone& phone, const PreparedZone& zone, const FusedPosition& position, double walked_m);
  void tell(const std::string& tracked, Phone& phone, const ZoneRecord& zone, Stay& stay, ZonePresence::Change change);
  void leave_all(const std::string& tracked, Phone& phone);

  DatabaseDirectory& store_;
  const Clock& clock_;
  const ZoneRules rules_;
  ZoneCounters counters_;
  ZoneEventLog log_;
  mutable std::mutex zones_mutex_;
  std::map<BuildingId, std::shared_ptr<const ZoneSet>> zones_;
  mutable std::mutex phones_mutex_;
  Phones phones_;
};

}  // namespace wayfuse
