#include "sdk/src/simulator/scanner.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wayfuse::simulator {
namespace {

constexpr std::size_t kThrottleScans = 4;
constexpr Duration kThrottleWindow = std::chrono::minutes(2);
constexpr double kHearingWidth_db = 1.0;   // of the soft edge of the receiver's sensitivity
constexpr Duration kMillisecond = std::chrono::milliseconds(1);
constexpr double kStampOff = 0.1;         // of stamps by a millisecond, either way
constexpr double kWeakest_dbm = -98.0;     // no phone tells of less

// A beacon must fall into the short stay on its channel and survive the others there: strong ones win. The share heard again
// in the next list, by level, of real walks: 0.46 at -78, 0.55 at -68, 0.79 at -58, 0.91 at -48 dBm.
double reception(double rss_dbm) {
  const double above_db = rss_dbm + 70.0;
  return std::clamp(0.60 + (above_db > 0 ? 0.016 : 0.006) * above_db, 0.45, 0.92);
}

// Before the walk its walker came the way they will go.
Truth came_from(Truth truth) {
  truth.heading = truth.heading.turned_by(std::numbers::pi);
  return truth;
}

Duration whole_ms(Duration time) { return std::chrono::round<std::chrono::milliseconds>(time); }

}  // namespace

Scanner::Scanner(const World& world, const Propagation& propagation, const Walker& walker, Device device,
                 ScannerSettings settings, Random random)
    : world_(world), propagation_(propagation), walker_(walker), device_(std::move(device)), settings_(settings), random_(random),
      next_(settings.interval) {
  for (std::size_t i = 0; i < world.transmitters.size(); ++i) slow_db_.push_back(settings.slow_fading_db * random_.normal());
  for (Duration at = -settings_.cache_life; at < Duration{0}; at += settings_.interval) sweep(at);
  if (!settings_.throttled) return;
  const std::size_t spent = random_.below(kThrottleScans + 1);   // of the scans the platform allows, before the walk
  sweeps_.clear();
  for (std::size_t i = 0; i < spent; ++i) sweeps_.push_back(from_seconds(-seconds(kThrottleWindow) * random_.uniform()));
  std::ranges::sort(sweeps_);
}

// Channels are swept in order of frequency: each transmitter is heard at its own moment, where the walker was then.
void Scanner::sweep(Duration end) {
  std::vector<Heard> heard;
  const Duration begin = end - settings_.sweep;
  const double since_s = sweeps_.empty() ? 0.0 : seconds(end - sweeps_.back());
  const double stays = std::exp(-since_s / settings_.slow_fading_s);
  for (std::size_t i = 0; i < world_.transmitters.size(); ++i) {
    const Transmitter& transmitter = world_.transmitters[i];
    const double order = transmitter.frequency_mhz < 3000 ? 0.3 * (transmitter.frequency_mhz - 2412) / 60.0
                                                          : 0.35 + 0.65 * (transmitter.frequency_mhz - 5180) / 645.0;
    const Duration at = whole_ms(begin + from_seconds(seconds(end - begin) * std::clamp(order, 0.0, 1.0)));
    const Truth truth = at < Duration{0} ? came_from(walker_.at(-at)) : walker_.at(at);
    slow_db_[i] = stays * slow_db_[i] + std::sqrt(1 - stays * stays) * settings_.slow_fading_db * random_.normal();
    const double level_dbm = device_.told_dbm(propagation_.level_dbm(i, truth.place, truth.heading) + slow_db_[i] +
                                              settings_.fading_db * random_.normal());
    for (const Bssid bssid : transmitter.bssids) {
      const double rss_dbm = std::round(level_dbm + device_.rss_noise_db * random_.normal());
      const double edge = 1.0 / (1.0 + std::exp(-(rss_dbm - device_.sensitivity_dbm) / kHearingWidth_db));
      if (random_.uniform() < edge * reception(rss_dbm) && rss_dbm >= kWeakest_dbm) {
        heard.push_back({bssid, transmitter.frequency_mhz, std::min(rss_dbm, -20.0), at});
      }
    }
  }
  std::ranges::sort(heard, {}, &Heard::bssid);
  for (const Heard& old : cache_) {
    if (end - old.at >= settings_.cache_life) continue;
    const auto again = std::ranges::lower_bound(heard, old.bssid, {}, &Heard::bssid);
    if (again == heard.end() || again->bssid != old.bssid) heard.insert(again, old);
  }
  cache_ = std::move(heard);
  sweeps_.push_back(end);
}

RssScan Scanner::deliver(PhoneTime start) {
  const Duration now = next_;
  std::erase_if(sweeps_, [&](Duration at) { return now - at > kThrottleWindow; });
  const bool throttled = settings_.throttled && sweeps_.size() >= kThrottleScans;
  if (!throttled) sweep(now - from_seconds(0.4 + 0.4 * random_.uniform()));
  RssScan scan;
  scan.time = start + now;
  for (const Heard& heard : cache_) {
    // Phones count back from now in milliseconds: the stamp of one reading wanders by one.
    const double wanders = random_.uniform();
    const Duration off = wanders < kStampOff ? kMillisecond : wanders < 2 * kStampOff ? -kMillisecond : Duration{0};
    scan.readings.push_back({heard.bssid, heard.rss_dbm, std::max(Duration{0}, now - heard.at + off), heard.frequency_mhz, std::nullopt, std::nullopt});
  }
  next_ = whole_ms(now + from_seconds(seconds(settings_.interval) * (0.95 + 0.2 * random_.uniform())));
  return scan;
}

}  // namespace wayfuse::simulator
