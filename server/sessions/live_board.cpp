#include "server/sessions/live_board.hpp"

namespace wayfuse {

void LiveBoard::put(const SessionSummary& summary) {
  const std::lock_guard lock(mutex_);
  Entry& entry = entries_[summary.tracked];
  const std::optional<FusedPosition> position = summary.position ? summary.position : entry.summary.position;
  entry.summary = summary;
  entry.summary.position = position;
  entry.gone_at.reset();
}

void LiveBoard::moved(const std::string& tracked, const FusedPosition& position, std::uint64_t applied_through, UnixTime at) {
  {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find(tracked);
    if (found == entries_.end() || found->second.gone_at) return;
    Entry& entry = found->second;
    entry.summary.position = position;
    entry.summary.building = position.building;
    entry.summary.applied_through = applied_through;
    entry.received_at = at;
    touch(entry);
  }
  if (watcher_) watcher_->moved(tracked, position);
}

void LiveBoard::set_connected(const std::string& tracked, bool connected) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(tracked);
  if (found != entries_.end()) found->second.summary.connected = connected;
}

void LiveBoard::gone(const std::string& tracked, UnixTime at) {
  {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find(tracked);
    if (found == entries_.end() || found->second.gone_at) return;
    found->second.gone_at = at;
    found->second.summary.connected = false;
    if (found->second.summary.position) touch(found->second);
  }
  if (watcher_) watcher_->gone(tracked);
}

void LiveBoard::sweep(UnixTime before) {
  const std::lock_guard lock(mutex_);
  std::erase_if(entries_, [&](const auto& item) {
    const Entry& entry = item.second;
    const bool old = entry.gone_at && *entry.gone_at < before;
    if (old) by_revision_.erase(entry.revision);
    return old;
  });
}

LiveBoard::Changes LiveBoard::changes_after(std::uint64_t after, BuildingId building, std::size_t most) const {
  Changes changes{{}, after};
  const std::lock_guard lock(mutex_);
  for (auto it = by_revision_.upper_bound(after); it != by_revision_.end() && changes.observed.size() < most; ++it) {
    const Entry& entry = *it->second;
    changes.through = it->first;
    if (building.value != 0 && entry.summary.building != building) continue;
    changes.observed.push_back({entry.summary.tracked, *entry.summary.position, entry.received_at, entry.gone_at.has_value()});
  }
  return changes;
}

std::vector<SessionSummary> LiveBoard::sessions(BuildingId building) const {
  std::vector<SessionSummary> summaries;
  const std::lock_guard lock(mutex_);
  for (const auto& [name, entry] : entries_) {
    if (!entry.gone_at && (building.value == 0 || entry.summary.building == building)) summaries.push_back(entry.summary);
  }
  return summaries;
}

std::size_t LiveBoard::size() const {
  const std::lock_guard lock(mutex_);
  return entries_.size();
}

void LiveBoard::touch(Entry& entry) {
  by_revision_.erase(entry.revision);
  entry.revision = ++revision_;
  by_revision_[entry.revision] = &entry;
}

}  // namespace wayfuse
