#pragma once

#include <optional>
#include <vector>

#include "sdk/src/simulator/device.hpp"
#include "sdk/src/simulator/propagation.hpp"
#include "sdk/src/simulator/walker.hpp"
#include "wayfuse/proto/scan.hpp"

namespace wayfuse::simulator {

/// The usual values come from 443 real walks; `test_sdk_simulator` compares what comes out with them again.
struct ScannerSettings {
  Duration interval = std::chrono::milliseconds(1900);  ///< between deliveries to the application, within -5 and +15 %
  Duration sweep = std::chrono::milliseconds(1500);     ///< time a real scan takes over all channels
  Duration cache_life = std::chrono::seconds(30);       ///< what was not heard again for so long leaves the list
  double fading_db = 1.5;          ///< 1 sigma between sweeps, by motion
  double slow_fading_db = 5.0;     ///< 1 sigma of what stays for a while: people in the way, a hand
  double slow_fading_s = 25.0;     ///< its correlation time
  bool throttled = false;          ///< four real scans in two minutes; the rest repeats old readings with their old times
};

/// A phone's Wi-Fi: sweeps the channels while the walker walks and hands out its cache, ages and all.
///
/// The phone was on before the walk began: the first list already holds what was heard on the way to its start.
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
  std::vector<double> slow_db_;   // one a transmitter
  std::vector<Heard> cache_;   // ascending by address
};

}  // namespace wayfuse::simulator
