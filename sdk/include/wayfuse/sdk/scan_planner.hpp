#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string_view>

#include "wayfuse/proto/message.hpp"

namespace wayfuse {

/// What an application may do about Wi-Fi scans.
enum class ScanPlatform : std::uint8_t {
  kUnlimited,          ///< a laptop, a robot, Android with throttling switched off by its developer options
  kAndroidForeground,  ///< 4 scans in 2 minutes
  kAndroidBackground,  ///< 1 scan in 30 minutes, for all background applications together
  kIos,                ///< none: iOS has no scan interface for applications
};

struct ScanAdvice {
  bool possible = true;            ///< false = this platform never scans: run on motion and what fixes there are
  std::optional<PhoneTime> at;     ///< when to ask the system next; absent = none needed for now
  std::string_view why;            ///< for people, a literal
};

/// When the application should ask its system for a Wi-Fi scan: often enough to help, never beyond what the platform allows,
/// fewer at rest. The platform would not refuse loudly: it hands out old results.
///
/// Thread: confined to its owner.
class ScanPlanner {
 public:
  explicit ScanPlanner(ScanPlatform platform) : platform_(platform) {}

  /// The application asked for a scan, whoever's idea it was.
  void started(PhoneTime now);
  void moved(bool at_rest, PhoneTime now);
  void hinted(const ScanHint& hint) { hint_ = hint; }
  /// A connection begins: the last server's wishes are void.
  void forget_hint() { hint_.reset(); }
  ScanAdvice advise(PhoneTime now) const;

 private:
  ScanPlatform platform_;
  std::deque<PhoneTime> starts_;   // the newest few
  std::optional<ScanHint> hint_;
  std::optional<PhoneTime> resting_since_;
};

}  // namespace wayfuse
