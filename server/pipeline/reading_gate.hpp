#pragma once

#include <map>
#include <optional>
#include <string>

#include "wayfuse/proto/scan.hpp"

namespace wayfuse {

struct ReadingGateSettings {
  bool all = false;                ///< every reading, at the scan's arrival
  double max_age_s = 4.0;
  double delay_s = 0.0;
  bool drop_repeats = true;
};

/// Keeps the readings of a scan that tell something new.
///
/// Operating systems hand out caches: the same reading comes again with a greater age. A reading counts when it was heard
/// after the newest one of its transmitter, is younger than `max_age_s` and was not heard before the walk began. What is
/// left belongs to one moment: the mean of the times at which they were heard. Thread: confined to one session.
class ReadingGate {
 public:
  struct Fresh {
    PhoneTime heard;               ///< mean over the readings kept, delay included; never after the scan's arrival
    PhoneTime newest;              ///< of the newest reading
  };
  explicit ReadingGate(const ReadingGateSettings& settings) : settings_(settings) {}

  /// Readings heard before this are of another place.
  void begin(PhoneTime time);
  /// Fills `kept` with the fresh readings, ages as they came; absent when none is left.
  std::optional<Fresh> take(const RssScan& scan, RssScan& kept);
  /// Why a reading heard then was not kept, of the newest scan.
  std::string why_not(const ScanReading& reading, PhoneTime heard) const;

 private:
  bool fresh(const ScanReading& reading, PhoneTime heard) const;
  void forget(PhoneTime now);

  ReadingGateSettings settings_;
  std::optional<PhoneTime> began_;
  std::map<Bssid, PhoneTime> last_heard_;
};

}  // namespace wayfuse
