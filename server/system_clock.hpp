#pragma once

#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// The machine's clocks. Thread: any.
class SystemClock final : public Clock {
 public:
  ServerTime now() const override {
    return ServerTime(std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now().time_since_epoch()));
  }
  UnixTime wall_now() const override {
    return UnixTime(std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch()));
  }
};

}  // namespace wayfuse
