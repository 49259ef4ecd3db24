#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "wayfuse/proto/fix.hpp"
#include "wayfuse/proto/random.hpp"
#include "wayfuse/proto/scan.hpp"

namespace wayfuse {

/// A distance from a transmitter whose place is known or estimated.
struct TransmitterRange {
  BuildingPoint transmitter;
  double distance_m = 0.0;         ///< horizontal
  double sigma_m = 0.0;
};

/// Descending by probability; equals keep their order. There are few floors: nothing is allocated.
inline void most_probable_first(std::span<FloorProbability> floors) {
  for (std::size_t i = 1; i < floors.size(); ++i) {
    for (std::size_t k = i; k > 0 && floors[k - 1].probability < floors[k].probability; --k) std::swap(floors[k - 1], floors[k]);
  }
}

/// What one scan says about the phone's place. Made for one radio map, immutable and shared; the object itself holds the
/// newest scan's answer and is confined to one session.
///
/// Every locator answers with a fix. One that knows more says so through the optional calls, which speak of the scan given
/// to the newest locate().
class Locator {
 public:
  virtual ~Locator() = default;
  virtual std::unique_ptr<Locator> clone() const = 0;
  /// Absent when the scan holds no transmitter the map knows: that is normal, not a fault.
  virtual std::optional<Fix> locate(const RssScan& scan) = 0;

  /// Floor votes, descending, summing to 1; empty before the first answer. A locator that never votes speaks for its fix's floor.
  virtual std::span<const FloorProbability> floors() const { return {}; }
  /// Known and unknown transmitters in the newest scan.
  virtual int transmitters_known() const = 0;
  virtual int transmitters_unknown() const = 0;

  /// Horizontal distances, where the locator works with them (`ranges` measurement).
  virtual std::span<const TransmitterRange> ranges() const { return {}; }

  /// Whether add_log_likelihood() answers (`field` measurement); the locator's row says the same.
  virtual bool has_likelihood() const { return false; }
  /// Adds log p(scan | point) on `floor`, up to a constant of the scan, to `log_likelihood`. All spans have the same length.
  virtual void add_log_likelihood(std::span<const float> /*x_m*/, std::span<const float> /*y_m*/, FloorOrdinal /*floor*/,
                                  std::span<float> /*log_likelihood*/) const {}

  /// Draws places from p(place | scan) on `floor`, evenly: the k-th of n from its k-th n-th, in an order of the locator's own. False when
  /// the locator cannot, and nothing is written.
  virtual bool draw(FloorOrdinal /*floor*/, Random& /*random*/, std::span<float> /*x_m*/, std::span<float> /*y_m*/) { return false; }
  /// How long before its arrival the newest scan's readings were heard, as the locator weighs them; below zero, they speak for where the
  /// phone is a moment later.
  virtual Duration heard_before() const { return Duration{0}; }
  /// How much worse the newest scan fits its best fingerprints than the survey's own scans fit another walk's: 1 = as usual,
  /// more where nobody surveyed, or where somebody plays tricks.
  virtual double mismatch() const { return 1.0; }
  /// Strong readings of the newest scan that nobody heard, or hardly, when surveying around `point` [SAFETY C26].
  virtual int implausible(FloorOrdinal /*floor*/, BuildingPoint /*point*/) const { return 0; }
  /// Of those, what honest radios do not explain: the rest of the scan denies them, or nobody ever surveyed them, or the scan fits
  /// `point` and they do not; 0 where the scan fits nothing surveyed [SAFETY C26].
  virtual int out_of_place(FloorOrdinal /*floor*/, BuildingPoint /*point*/) const { return 0; }
  /// How much worse the newest scan fits around `point` than elsewhere in the building, as a distance in signal space; below 0 = it
  /// fits here best. Absent: the locator cannot tell, or too little was heard.
  virtual std::optional<double> misfit(FloorOrdinal /*floor*/, BuildingPoint /*point*/) const { return std::nullopt; }
  /// Nobody asks about the newest scan any more: its memory may go back.
  virtual void rest() {}

  /// Where the tracker believes the newest scan was heard: lets a locator learn online ([P3 algorithm 2]).
  virtual void learn(const RssScan& /*scan*/, const Place& /*fused*/) {}
  /// What `older`, of the same kind and of another map of the building, learnt about the phone goes on here.
  virtual void inherit(const Locator& /*older*/) {}
};

}  // namespace wayfuse
