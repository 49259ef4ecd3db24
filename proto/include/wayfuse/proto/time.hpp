#pragma once

#include <chrono>
#include <cstdint>

namespace wayfuse {

/// Every duration inside wayfuse, in whole microseconds.
using Duration = std::chrono::microseconds;

/// The phone's monotonic clock. Its zero is arbitrary and differs from phone to phone; it never steps.
struct PhoneClock {
  using rep = std::int64_t;
  using period = std::micro;
  using duration = Duration;
  using time_point = std::chrono::time_point<PhoneClock>;
  static constexpr bool is_steady = true;
};
/// The server's monotonic clock, for deadlines, ages and lateness. Never written to disk.
struct ServerClock {
  using rep = std::int64_t;
  using period = std::micro;
  using duration = Duration;
  using time_point = std::chrono::time_point<ServerClock>;
  static constexpr bool is_steady = true;
};
/// Wall-clock time since 1970-01-01 UTC. For stamps people read and for expiry of keys; never for deadlines.
struct UnixClock {
  using rep = std::int64_t;
  using period = std::micro;
  using duration = Duration;
  using time_point = std::chrono::time_point<UnixClock>;
  static constexpr bool is_steady = false;
};

using PhoneTime = PhoneClock::time_point;
using ServerTime = ServerClock::time_point;
using UnixTime = UnixClock::time_point;

/// A duration as seconds, for formulas.
constexpr double seconds(Duration duration) { return static_cast<double>(duration.count()) * 1e-6; }

/// Seconds as a duration, rounded to the nearest microsecond.
constexpr Duration from_seconds(double value_s) {
  return Duration{static_cast<std::int64_t>(value_s * 1e6 + (value_s < 0 ? -0.5 : 0.5))};
}

/// Where the server's time comes from. The world injects the real clocks, a simulation its virtual ones.
class Clock {
 public:
  virtual ~Clock() = default;
  virtual ServerTime now() const = 0;
  virtual UnixTime wall_now() const = 0;
};

}  // namespace wayfuse
