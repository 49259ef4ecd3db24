#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/pipeline/pipeline_spec.hpp"
#include "wayfuse/proto/fingerprint.hpp"
#include "wayfuse/proto/fix.hpp"
#include "wayfuse/proto/motion.hpp"
#include "wayfuse/proto/random.hpp"

namespace wayfuse {

/// What a tracker must know of a building. Immutable once made; shared by all its sessions.
struct Site {
  BuildingId building;
  std::optional<Georeference> georeference;
  MagneticField magnetic_field;
  std::vector<Floor> floors;
  std::vector<ReferencePoint> survey;
  std::uint64_t radio_map_version = 0;
  /// By pipeline: its trained corrector, as TrackerFactory::learnt() gave it over this very map. What is not here is learnt anew.
  std::map<std::string, std::string> correctors;
};

/// A place the caller knows the phone to be at when tracking begins (a door, a QR code, a measured start).
///
/// `dead-reckoning` gives no position without one; the other pipelines start from it instead of the first fix.
struct KnownStart {
  Place place;
  double sigma_m = 0.5;
  std::optional<Heading> heading;  ///< local frame, of the walker; needed where the phone's heading is arbitrary
};

/// One pipeline prepared for one building: radio map, fields and grids built once, shared by its sessions.
///
/// Immutable and thread-safe; make_tracker() is cheap.
class TrackerFactory {
 public:
  virtual ~TrackerFactory() = default;
  /// Replay is exact: the same generator and the same evidence give the same bits, on every machine.
  virtual std::unique_ptr<class Tracker> make_tracker(Random random, const std::optional<KnownStart>& start = {}) const = 0;
  /// A tracker of this factory's map that goes on where `older`, of the same spec and of another map of the building, stands. The track
  /// and what was learnt about phone and walker stay; what follows from the map is exchanged. Null: they have too little in common.
  virtual std::unique_ptr<class Tracker> take_over(const class Tracker& /*older*/) const { return nullptr; }
  virtual const PipelineSpec& spec() const = 0;
  /// What an operator should know: a part that could not be prepared and is left out, and why.
  virtual std::vector<std::string> remarks() const { return {}; }
  /// What was trained from this building's survey, with its provenance, to be stored in Site::correctors; empty = nothing.
  virtual std::string learnt() const { return {}; }
};

/// One hypothesis of a tracker: somewhere the phone may be, and how much that counts.
struct WeightedPlace {
  BuildingPoint point;
  double weight = 0.0;
};

/// One phone's position over time: takes evidence in time order, answers with positions.
///
/// Motion and scans are in the phone's time; a heading against magnetic or true axes is turned into the building's frame
/// here. Thread: confined to one session. Same evidence and same generator, same bits.
class Tracker {
 public:
  virtual ~Tracker() = default;
  virtual void feed(const MotionReport& motion) = 0;
  virtual void feed(const RssScan& scan) = 0;
  virtual void feed(const GnssFix& fix) = 0;
  /// The best causal estimate for `at`, no earlier than the newest evidence fed; absent before the first fix.
  virtual std::optional<FusedPosition> position(PhoneTime at) const = 0;
  /// Why there is none: kEmptyRadioMap, kNoKnownAccessPoint, or merely nothing heard yet.
  virtual Fault why_no_fix() const = 0;
  /// At most `most` of the hypotheses behind position(), evenly picked in their order, the same ones whenever asked; their weights
  /// sum to 1. Empty where the belief is no cloud, or nothing is believed yet.
  virtual std::vector<WeightedPlace> cloud(std::size_t /*most*/) const { return {}; }
  /// Why that reading of the newest scan fed never reached the locator; empty = it did.
  virtual std::string left_out(const ScanReading& /*reading*/) const { return {}; }
  /// In words, why position(at).integrity is not `ok`; empty where it is.
  virtual std::vector<std::string> doubts(PhoneTime /*at*/) const { return {}; }
  /// An exact copy, generator included: a session rewinds to it when evidence arrives out of order.
  virtual std::unique_ptr<Tracker> clone() const = 0;
  /// The tracker itself, where another one only stands in front of it.
  virtual const Tracker& core() const { return *this; }
};

/// Goes on with `newer` from where `older` stands at `at`: in place of it where that can be (TrackerFactory::take_over); otherwise,
/// as between pipelines of different kinds, it begins with `random` at the position that `older` last gave, if there is one.
std::unique_ptr<Tracker> go_on(const TrackerFactory& newer, const Tracker& older, PhoneTime at, Random random);
/// Whether headings and coordinates mean the same in both.
bool same_axes(const Site& a, const Site& b);

/// Builds the parts a spec names over a site. The only function that sees all parts.
Result<std::shared_ptr<const TrackerFactory>> assemble(const PipelineSpec& spec, std::shared_ptr<const Site> site);

}  // namespace wayfuse
