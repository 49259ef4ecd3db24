#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <vector>

#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// Something with deadlines: looked at about once a second, or oftener when it asks.
class Ticked {
 public:
  virtual ~Ticked() = default;
  /// Called on the wheel's thread; brings itself to its own strand.
  virtual void look_at_deadlines() = 0;
  /// The server drains: say so, and be gone `within` from now. Called on any thread.
  virtual void drain(Duration within, Duration leave_after) = 0;
  /// Not even now: close the socket. Called on any thread.
  virtual void cut() = 0;
};

/// One timer for all connections, instead of one each [SAFETY, Asio pitfalls]: a tenth of them every tenth of a second.
///
/// Holds no connection alive. Thread: any; one mutex, not held while calling out.
class DeadlineWheel {
 public:
  static constexpr std::size_t kSlots = 10;
  static constexpr Duration kSlot = std::chrono::milliseconds(100);

  void add(std::weak_ptr<Ticked> ticked);
  /// Looks at it every fifth of a second as well.
  void add_often(std::weak_ptr<Ticked> ticked);
  /// The next slot's turn; to be called every kSlot.
  void turn();
  /// All that are alive.
  std::vector<std::shared_ptr<Ticked>> all() const;

 private:
  using Slot = std::vector<std::weak_ptr<Ticked>>;
  mutable std::mutex mutex_;
  std::array<Slot, kSlots> slots_;
  Slot often_;
  std::size_t next_add_ = 0;
  std::size_t next_turn_ = 0;
};

}  // namespace wayfuse
