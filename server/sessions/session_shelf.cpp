#include "server/sessions/session_shelf.hpp"

#include <algorithm>
#include <optional>

namespace wayfuse {

SessionShelf::SessionShelf(std::uint64_t epoch, SessionNames names, SessionShelfSettings settings)
    : epoch_(epoch), names_(std::move(names)), settings_(settings) {}

std::shared_ptr<TrackingSession> SessionShelf::begin(SessionRequest request, const BuildingShelf& buildings, ServerTime now) {
  const std::lock_guard lock(mutex_);
  if (sessions_.size() >= settings_.most) {
    auto oldest = sessions_.end();
    std::optional<ServerTime> oldest_since;
    for (auto it = sessions_.begin(); it != sessions_.end(); ++it) {
      const auto since = it->second->disconnected_since();
      if (since && (!oldest_since || *since < *oldest_since)) oldest = it, oldest_since = since;
    }
    if (oldest == sessions_.end()) return nullptr;
    evicted_.push_back(oldest->second->tracked());
    sessions_.erase(oldest);
  }
  std::string secret = names_.secret();  // one after the other: the order of arguments is the compiler's choice
  std::string tracked = names_.tracked();
  const std::uint64_t seed = names_.seed();
  auto session = std::make_shared<TrackingSession>(std::move(request), std::move(secret), std::move(tracked), seed, buildings, now);
  sessions_[session->name()] = session;
  return session;
}

std::shared_ptr<TrackingSession> SessionShelf::find(const std::string& name, std::uint64_t key_id) const {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(name);
  return found != sessions_.end() && found->second->key_id() == key_id ? found->second : nullptr;
}

std::shared_ptr<TrackingSession> SessionShelf::find_tracked(const std::string& tracked) const {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find_if(sessions_, [&](const auto& item) { return item.second->tracked() == tracked; });
  return found != sessions_.end() ? found->second : nullptr;
}

void SessionShelf::end(const std::string& name) {
  const std::lock_guard lock(mutex_);
  sessions_.erase(name);
}

std::vector<std::string> SessionShelf::sweep(ServerTime now) {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> expired = std::move(evicted_);
  evicted_.clear();
  std::erase_if(sessions_, [&](const auto& item) {
    const auto since = item.second->disconnected_since();
    const bool old = since && now - *since > settings_.resumable;
    if (old) expired.push_back(item.second->tracked());
    return old;
  });
  return expired;
}

std::size_t SessionShelf::size() const {
  const std::lock_guard lock(mutex_);
  return sessions_.size();
}

}  // namespace wayfuse
