#include "server/net/deadline_wheel.hpp"

namespace wayfuse {
namespace {

std::vector<std::shared_ptr<Ticked>> alive_in(std::vector<std::weak_ptr<Ticked>>& slot) {
  std::vector<std::shared_ptr<Ticked>> alive;
  alive.reserve(slot.size());
  std::erase_if(slot, [&](const std::weak_ptr<Ticked>& weak) {
    auto ticked = weak.lock();
    if (!ticked) return true;
    alive.push_back(std::move(ticked));
    return false;
  });
  return alive;
}

}  // namespace

void DeadlineWheel::add(std::weak_ptr<Ticked> ticked) {
  const std::lock_guard lock(mutex_);
  slots_[next_add_++ % kSlots].push_back(std::move(ticked));
}

void DeadlineWheel::add_often(std::weak_ptr<Ticked> ticked) {
  const std::lock_guard lock(mutex_);
  often_.push_back(std::move(ticked));
}

void DeadlineWheel::turn() {
  std::vector<std::shared_ptr<Ticked>> due;
  std::vector<std::shared_ptr<Ticked>> often;
  {
    const std::lock_guard lock(mutex_);
    due = alive_in(slots_[next_turn_ % kSlots]);
    if (next_turn_ % 2 == 0) often = alive_in(often_);
    ++next_turn_;
  }
  for (const auto& ticked : due) ticked->look_at_deadlines();
  for (const auto& ticked : often) ticked->look_at_deadlines();
}

std::vector<std::shared_ptr<Ticked>> DeadlineWheel::all() const {
  std::vector<std::shared_ptr<Ticked>> alive;
  const std::lock_guard lock(mutex_);
  for (const Slot& slot : slots_) {
    for (const auto& weak : slot) {
      if (auto ticked = weak.lock()) alive.push_back(std::move(ticked));
    }
  }
  return alive;
}

}  // namespace wayfuse
