#pragma once

#include <deque>
#include <list>
#include <mutex>

#include "admin/zone_control.hpp"

namespace wayfuse {

/// The newest zone events, in order: what WebSocket observers, server-sent events and webhooks read from, each with a mark of
/// its own. It is the only queue there is, and bounded: who falls behind it is told that events are missing.
///
/// In memory only [SAFETY C19]. Thread: any; one mutex, not held while calling out.
class ZoneEventLog {
 public:
  static constexpr std::size_t kKept = 8192;

  explicit ZoneEventLog(std::uint64_t epoch) : epoch_(epoch) {}

  /// Numbers the event, names it, keeps it, tells the listeners. Answers its id.
  std::string append(BuildingId building, ZoneEvent event);
  ZoneControl::News after(std::uint64_t number, BuildingId building, std::size_t most) const;
  std::uint64_t newest() const;
  std::uint64_t epoch() const { return epoch_; }
  std::shared_ptr<void> on_event(std::function<void()> told);

 private:
  struct Listeners {
    std::mutex mutex;
    std::list<std::function<void()>> told;
  };
  const std::uint64_t epoch_;
  mutable std::mutex mutex_;
  std::deque<NumberedZoneEvent> events_;
  std::uint64_t newest_ = 0;
  const std::shared_ptr<Listeners> listeners_ = std::make_shared<Listeners>();
};

}  // namespace wayfuse
