#include "server/net/address_book.hpp"

#include <algorithm>

namespace wayfuse {

std::shared_ptr<void> AddressBook::enter(const std::string& address, ServerTime now) {
  const std::lock_guard lock(mutex_);
  Entry& visitor = entry(address, now);
  if (visitor.connections >= settings_.connections_most || !visitor.arrivals.has(now)) return nullptr;
  visitor.arrivals.spend(1, now);
  ++visitor.connections;
  return {this, [self = shared_from_this(), address](void*) { self->leave(address); }};
}

bool AddressBook::may_authenticate(const std::string& address, ServerTime now) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(address);
  return found == entries_.end() || found->second.refusals.has(now);
}

void AddressBook::refused(const std::string& address, ServerTime now) {
  const std::lock_guard lock(mutex_);
  entry(address, now).refusals.spend(1, now);
}

std::size_t AddressBook::size() const {
  const std::lock_guard lock(mutex_);
  return entries_.size();
}

AddressBook::Entry& AddressBook::entry(const std::string& address, ServerTime now) {
  if (entries_.size() >= tidy_at_) tidy(now);
  const TokenBucket arrivals(settings_.connections_per_second, settings_.connections_burst, now);
  const TokenBucket refusals(settings_.refusals_per_second, settings_.refusals_burst, now);
  return entries_.try_emplace(address, Entry{0, arrivals, refusals}).first->second;
}

void AddressBook::leave(const std::string& address) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(address);
  if (found != entries_.end()) --found->second.connections;
}

// Forgets whoever has left and owes nothing; grows its patience with what cannot be forgotten.
void AddressBook::tidy(ServerTime now) {
  for (auto it = entries_.begin(); it != entries_.end();) {
    Entry& visitor = it->second;
    const bool owes_nothing = visitor.connections == 0 && visitor.arrivals.full(now) && visitor.refusals.full(now);
    it = owes_nothing ? entries_.erase(it) : std::next(it);
  }
  tidy_at_ = std::max<std::size_t>(1024, 2 * entries_.size());
}

}  // namespace wayfuse
