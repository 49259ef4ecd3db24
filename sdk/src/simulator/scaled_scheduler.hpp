#pragma once

#include <utility>

#include "wayfuse/sdk/link.hpp"

namespace wayfuse::simulator {

/// Lets the phones' clocks run `speed` times as fast as the scheduler below: a stand-in walk in less than real time.
class ScaledScheduler final : public Scheduler {
 public:
  ScaledScheduler(Scheduler& below, double speed) : below_(below), speed_(speed), start_(below.now()) {}

  PhoneTime now() const override { return start_ + from_seconds(seconds(below_.now() - start_) * speed_); }
  std::uint64_t after(Duration delay, std::function<void()> task) override {
    return below_.after(from_seconds(seconds(delay) / speed_), std::move(task));
  }
  void cancel(std::uint64_t timer) override { below_.cancel(timer); }

 private:
  Scheduler& below_;
  double speed_;
  PhoneTime start_;
};

}  // namespace wayfuse::simulator
