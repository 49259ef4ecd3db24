#include "server/zones/zone_watch.hpp"

#include <algorithm>

namespace wayfuse {
namespace {

constexpr Duration kLongestStep = std::chrono::seconds(5);  // a speed says nothing about a longer pause

double walked_m(const FusedPosition& position, const std::optional<PhoneTime>& before) {
  if (!before || position.valid_at <= *before) return 0.0;
  return position.speed_mps * seconds(std::min(position.valid_at - *before, kLongestStep));
}

}  // namespace

ZoneWatch::ZoneWatch(DatabaseDirectory& store, const Clock& clock, std::uint64_t epoch, ZoneRules rules)
    : store_(store), clock_(clock), rules_(rules), log_(epoch) {}

void ZoneWatch::zones_changed(BuildingId building) {
  store_.with_building(building, [this, building](Result<BuildingDatabase*> database) {
    if (!database) return put_zones(building, {});
    // A store that cannot be read now leaves what was known in force.
    if (auto zones = (*database)->zones()) put_zones(building, *std::move(zones));
  });
}

void ZoneWatch::put_zones(BuildingId building, std::vector<ZoneRecord> zones) {
  auto fresh = zones.empty() ? nullptr : std::make_shared<const ZoneSet>(std::move(zones));
  const std::lock_guard lock(zones_mutex_);
  zones_[building].swap(fresh);
}

std::shared_ptr<const ZoneSet> ZoneWatch::zones_of(BuildingId building) const {
  const std::lock_guard lock(zones_mutex_);
  const auto found = zones_.find(building);
  return found != zones_.end() ? found->second : nullptr;
}

std::shared_ptr<ZoneWatch::Phone> ZoneWatch::phone_of(const std::string& tracked) {
  const std::lock_guard lock(phones_mutex_);
  auto& phone = phones_[tracked];
  if (!phone) phone = std::make_shared<Phone>();
  return phone;
}

ZoneWatch::Phones ZoneWatch::phones() const {
  const std::lock_guard lock(phones_mutex_);
  return phones_;
}

void ZoneWatch::moved(const std::string& tracked, const FusedPosition& position) {
  const auto zones = zones_of(position.building);
  if (position.integrity == Integrity::kSuspect) return;
  const auto phone = phone_of(tracked);
  const std::lock_guard lock(phone->mutex);
  if (phone->gone) return;
  if (phone->building != position.building) leave_all(tracked, *phone);
  phone->building = position.building;
  const double walked = walked_m(position, phone->valid_at);
  phone->valid_at = position.valid_at;
  if (phone->zones != zones) {  // stays of zones that are no more are forgotten without a word
    std::erase_if(phone->stays, [&](const auto& stay) { return !zones || !zones->find(stay.first); });
    phone->zones = zones;
  }
  if (!zones) return;
  for (const auto& [floor, on_floor] : zones->floors()) {
    for (const PreparedZone& zone : on_floor) look_at(tracked, *phone, zone, position, walked);
  }
}

void ZoneWatch::look_at(const std::string& tracked, Phone& phone, const PreparedZone& zone, const FusedPosition& position,
                        double walked) {
  const ZoneMass mass = mass_in(zone, position);
  auto stay = phone.stays.find(zone.record.id);
  if (stay == phone.stays.end()) {
    if (mass.region < rules_.enter) return;  // most zones, most of the time
    stay = phone.stays.try_emplace(zone.record.id).first;
  }
  const ZonePresence::Evidence evidence{clock_.now(), mass.region, mass.tolerated, walked, position.place, position.radius95_m};
  tell(tracked, phone, zone.record, stay->second, stay->second.presence.take(evidence, zone.record, rules_));
  if (stay->second.presence.idle()) phone.stays.erase(stay);
}

void ZoneWatch::tell(const std::string& tracked, Phone& phone, const ZoneRecord& zone, Stay& stay, ZonePresence::Change change) {
  using Change = ZonePresence::Change;
  if (change == Change::kNone) return;
  ZoneEvent event;
  event.tracked = tracked;
  event.zone = std::to_string(zone.id);
  event.zone_name = zone.name;
  event.at = clock_.wall_now();
  event.floor = zone.floor;
  event.probability = stay.presence.mass();
  const bool entered = change == Change::kEntered || change == Change::kExitWithdrawn;
  event.transition = entered ? ZoneTransition::kEntered : ZoneTransition::kLeft;
  if (change == Change::kEntryWithdrawn || change == Change::kExitWithdrawn) {
    event.retracts = stay.told;
    counters_.withdrawn++;
  }
  (entered ? counters_.entered : counters_.left)++;
  if (change == Change::kEntered) stay.since = event.at;
  stay.told = log_.append(phone.building, std::move(event));
}

void ZoneWatch::leave_all(const std::string& tracked, Phone& phone) {
  for (auto& [id, stay] : phone.stays) {
    const PreparedZone* zone = phone.zones ? phone.zones->find(id) : nullptr;
    if (zone && stay.presence.inside()) tell(tracked, phone, zone->record, stay, ZonePresence::Change::kLeft);
  }
  phone.stays.clear();
}

void ZoneWatch::gone(const std::string& tracked) {
  std::shared_ptr<Phone> phone;
  {
    const std::lock_guard lock(phones_mutex_);
    const auto found = phones_.find(tracked);
    if (found == phones_.end()) return;
    phone = std::move(found->second);
    phones_.erase(found);
  }
  const std::lock_guard lock(phone->mutex);
  phone->gone = true;
  leave_all(tracked, *phone);
}

void ZoneWatch::tick() {
  for (const auto& [tracked, phone] : phones()) {
    const std::lock_guard lock(phone->mutex);
    if (phone->gone || !phone->zones) continue;
    for (auto stay = phone->stays.begin(); stay != phone->stays.end();) {
      const PreparedZone* zone = phone->zones->find(stay->first);
      if (zone) tell(tracked, *phone, zone->record, stay->second, stay->second.presence.tick(clock_.now(), zone->record, rules_));
      stay = stay->second.presence.idle() ? phone->stays.erase(stay) : std::next(stay);
    }
  }
}

std::vector<ZoneOccupant> ZoneWatch::occupants(BuildingId building, std::uint64_t zone) const {
  std::vector<ZoneOccupant> found;
  for (const auto& [tracked, phone] : phones()) {
    const std::lock_guard lock(phone->mutex);
    const auto stay = phone->stays.find(zone);
    if (phone->building != building || stay == phone->stays.end() || !stay->second.presence.inside()) continue;
    found.push_back({tracked, stay->second.since, stay->second.presence.mass()});
  }
  return found;
}

std::map<std::string, std::vector<std::string>> ZoneWatch::zones_by_phone(BuildingId building) const {
  std::map<std::string, std::vector<std::string>> found;
  for (const auto& [tracked, phone] : phones()) {
    const std::lock_guard lock(phone->mutex);
    if (building.value != 0 && phone->building != building) continue;
    for (const auto& [id, stay] : phone->stays) {
      const PreparedZone* zone = phone->zones ? phone->zones->find(id) : nullptr;
      if (zone && stay.presence.inside()) found[tracked].push_back(zone->record.name);
    }
  }
  return found;
}

std::size_t ZoneWatch::occupied() const {
  std::size_t count = 0;
  for (const auto& [tracked, phone] : phones()) {
    const std::lock_guard lock(phone->mutex);
    count += static_cast<std::size_t>(std::ranges::count_if(phone->stays, [](const auto& stay) { return stay.second.presence.inside(); }));
  }
  return count;
}

std::size_t ZoneWatch::zones() const {
  std::size_t count = 0;
  const std::lock_guard lock(zones_mutex_);
  for (const auto& [building, set] : zones_) {
    if (!set) continue;
    for (const auto& [floor, on_floor] : set->floors()) count += on_floor.size();
  }
  return count;
}

}  // namespace wayfuse
