#include "server/zones/zone_event_log.hpp"

#include <algorithm>

namespace wayfuse {

std::string ZoneEventLog::append(BuildingId building, ZoneEvent event) {
  std::string id;
  {
    const std::lock_guard lock(mutex_);
    event.id = id = std::to_string(epoch_) + "-" + std::to_string(++newest_);
    events_.push_back({newest_, building, std::move(event)});
    if (events_.size() > kKept) events_.pop_front();
  }
  // Listeners only wake somebody up; they are called under their own mutex so that none is called after its end.
  const std::lock_guard lock(listeners_->mutex);
  for (const auto& told : listeners_->told) told();
  return id;
}

ZoneControl::News ZoneEventLog::after(std::uint64_t number, BuildingId building, std::size_t most) const {
  ZoneControl::News news;
  const std::lock_guard lock(mutex_);
  news.through = std::min(number, newest_);
  if (events_.empty()) return news;
  news.missed = number + 1 < events_.front().number;
  auto at = std::ranges::upper_bound(events_, number, {}, &NumberedZoneEvent::number);
  for (; at != events_.end() && news.events.size() < most; ++at) {
    news.through = at->number;
    if (building.value == 0 || at->building == building) news.events.push_back(*at);
  }
  return news;
}

std::uint64_t ZoneEventLog::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

std::shared_ptr<void> ZoneEventLog::on_event(std::function<void()> told) {
  const std::lock_guard lock(listeners_->mutex);
  const auto place = listeners_->told.insert(listeners_->told.end(), std::move(told));
  return {nullptr, [listeners = listeners_, place](void*) {
            const std::lock_guard again(listeners->mutex);
            listeners->told.erase(place);
          }};
}

}  // namespace wayfuse
