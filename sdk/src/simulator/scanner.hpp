#pragma once

#include <optional>
#include <vector>

#include "sdk/src/simulator/propagation.hpp"
#include "sdk/src/simulator/sensors.hpp"
#include "wayfuse/proto/scan.hpp"

namespace wayfuse::simulator {

struct ScannerSettings {
  Duration interval = std::chrono::seconds(3);    ///< between deliveries to the application
  Duration sweep = std::chrono::milliseconds(2200);   ///< time a real scan takes over all channels
  double repeat_share = 0.35;      ///< of deliveries that are the previous list once more
  double stale_share = 0.25;       ///< of entries not heard this time that stay in the list
  Duration stale_most = std::chrono::seconds(20);
  bool throttled = false;          ///< four real scans in two minutes; the rest repeats
  double fading_db = 2.5;          ///< 1 sigma between sweeps, by people and motion
};

/// A phone's Wi-Fi: sweeps the channels while the walker walks and hands out its cache, ages and all.
class Scanner {
 public:
  Scanner(const World& world, const Propagation& propagation, const Walker& walker, Device device, ScannerSettings settings,
          Random random);

  /// When the next list is delivered, since the start of the walk.
  Duration next_delivery() const { return next_; }
  /// Hands out the list of next_delivery() and plans the next one. `start` is the walk's start on the phone's clock.
  RssScan deliver(PhoneTime start);

 private:
  struct Heard {
    Bssid bssid;
    std::uint16_t frequency_mhz;
    double rss_dbm;
    Duration at;
  };
  void sweep(Duration end);

  const World& world_;
  const Propagation& propagation_;
  const Walker& walker_;
  Device device_;
  ScannerSettings settings_;
  Random random_;
  Duration next_;
  std::vector<Duration> sweeps_;
  std::vector<Heard> cache_;
};

}  // namespace wayfuse::simulator
