#include "sdk/src/simulator/scanner.hpp"

#include <algorithm>
#include <cmath>

namespace wayfuse::simulator {
namespace {

constexpr std::size_t kThrottleScans = 4;
constexpr Duration kThrottleWindow = std::chrono::minutes(2);
constexpr double kHearingWidth_db = 2.5;   // of the soft edge of the receiver's sensitivity

}  // namespace

Scanner::Scanner(const World& world, const Propagation& propagation, const Walker& walker, Device device,
                 ScannerSettings settings, Random random)
    : world_(world), propagation_(propagation), walker_(walker), device_(std::move(device)), settings_(settings), random_(random),
      next_(settings.interval) {}

// Channels are swept in order of frequency: each transmitter is heard at its own moment, where the walker was then.
void Scanner::sweep(Duration end) {
  std::vector<Heard> heard;
  const Duration begin = std::max(Duration{0}, end - settings_.sweep);
  for (std::size_t i = 0; i < world_.transmitters.size(); ++i) {
    const Transmitter& transmitter = world_.transmitters[i];
    const double order = transmitter.frequency_mhz < 3000 ? 0.3 * (transmitter.frequency_mhz - 2412) / 60.0
                                                          : 0.35 + 0.65 * (transmitter.frequency_mhz - 5180) / 645.0;
    const Duration at = begin + from_seconds(seconds(end - begin) * std::clamp(order, 0.0, 1.0));
    const Truth truth = walker_.at(at);
    const double level_dbm = propagation_.level_dbm(i, truth.place, truth.heading) + device_.rss_offset_db +
                             settings_.fading_db * random_.normal();
    for (const Bssid bssid : transmitter.bssids) {
      const double rss_dbm = std::round(level_dbm + device_.rss_noise_db * random_.normal());
      const double chance = 1.0 / (1.0 + std::exp(-(rss_dbm - device_.sensitivity_dbm) / kHearingWidth_db));
      if (random_.uniform() < chance && rss_dbm > -110) {
        heard.push_back({bssid, transmitter.frequency_mhz, std::min(rss_dbm, -20.0), at});
      }
    }
  }
  for (const Heard& old : cache_) {
    const bool again = std::ranges::any_of(heard, [&](const Heard& h) { return h.bssid == old.bssid; });
    if (!again && end - old.at < settings_.stale_most && random_.uniform() < settings_.stale_share) heard.push_back(old);
  }
  cache_ = std::move(heard);
  sweeps_.push_back(end);
}

RssScan Scanner::deliver(PhoneTime start) {
  const Duration now = next_;
  std::erase_if(sweeps_, [&](Duration at) { return now - at > kThrottleWindow; });
  const bool throttled = settings_.throttled && sweeps_.size() >= kThrottleScans;
  const bool first = cache_.empty();
  if (!throttled && (first || random_.uniform() >= settings_.repeat_share)) {
    sweep(now - from_seconds(0.2 + 0.5 * random_.uniform()));
  }
  RssScan scan;
  scan.time = start + now;
  for (const Heard& heard : cache_) {
    scan.readings.push_back({heard.bssid, heard.rss_dbm, now - heard.at, heard.frequency_mhz, std::nullopt, std::nullopt});
  }
  next_ = now + settings_.interval;
  return scan;
}

}  // namespace wayfuse::simulator
