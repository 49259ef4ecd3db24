#pragma once

#include <optional>

#include "sdk/src/simulator/phone_feed.hpp"
#include "sdk/src/simulator/propagation.hpp"
#include "sdk/src/simulator/scanner.hpp"
#include "sdk/src/simulator/sensors.hpp"
#include "sdk/src/simulator/walker.hpp"

namespace wayfuse::simulator {

struct StandInSettings {
  Device device = {};
  CarryingSettings carrying = {};
  ScannerSettings scanner = {};
  PhoneTime start{from_seconds(1000)};   ///< of the walk, on the phone's clock
};

/// What `--carrying` says: one of carrying_names(), `mixed` (every phone its own way), `changing` (another way every 30 s or
/// so). std::invalid_argument lists the words.
CarryingSettings carrying_of(std::string_view word, Random& random);

/// A phone in a walker's hand: its sensor callbacks in the order an operating system would make them.
///
/// Same world, walker, settings and generator: the same events, bit for bit. Thread: confined to its owner.
class StandInPhone final : public PhoneFeed {
 public:
  StandInPhone(const World& world, const Propagation& propagation, const Walker& walker, const StandInSettings& settings,
               Random random);

  std::optional<RecordedEvent> next() override;
  PhoneTime next_time() const override;
  std::optional<Place> truth_at(PhoneTime time) const override { return truth(time).place; }
  const std::string& device_model() const override { return settings_.device.model; }
  Truth truth(PhoneTime time) const { return walker_.at(time - settings_.start); }
  PhoneTime end() const { return settings_.start + walker_.length(); }

 private:
  const Walker& walker_;
  StandInSettings settings_;
  MotionSensors sensors_;
  Scanner scanner_;
  Duration next_marg_{0};
  Duration period_;
};

}  // namespace wayfuse::simulator
