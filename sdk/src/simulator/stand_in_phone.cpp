#include "sdk/src/simulator/stand_in_phone.hpp"

#include <algorithm>
#include <stdexcept>

namespace wayfuse::simulator {

CarryingSettings carrying_of(std::string_view word, Random& random) {
  if (word == "mixed" || word == "changing") {
    const auto mode = static_cast<Carrying>(random.below(kCarryingModes));
    return {mode, word == "changing" ? std::chrono::seconds(30) : Duration{0}};
  }
  const auto& names = carrying_names();
  const auto at = std::ranges::find(names, word);
  if (at != names.end()) return {static_cast<Carrying>(at - names.begin())};
  std::string known;
  for (const std::string& name : names) known += name + ", ";
  throw std::invalid_argument("carrying: no way '" + std::string(word) + "'; there are " + known + "mixed, changing");
}

StandInPhone::StandInPhone(const World& world, const Propagation& propagation, const Walker& walker,
                           const StandInSettings& settings, Random random)
    : walker_(walker),
      settings_(settings),
      sensors_(world, walker, settings.device, settings.carrying, random.split()),
      scanner_(world, propagation, walker, settings.device, settings.scanner, random.split()),
      period_(from_seconds(1.0 / settings.device.rate_hz)) {}

PhoneTime StandInPhone::next_time() const { return settings_.start + std::min(next_marg_, scanner_.next_delivery()); }

std::optional<RecordedEvent> StandInPhone::next() {
  if (next_time() >= end()) return std::nullopt;
  if (scanner_.next_delivery() <= next_marg_) return scanner_.deliver(settings_.start);
  const Duration at = next_marg_;
  next_marg_ += period_;
  return sensors_.sample(at, settings_.start + at);
}

}  // namespace wayfuse::simulator
