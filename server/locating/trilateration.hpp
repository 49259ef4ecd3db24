#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "server/locating/catalogue.hpp"
#include "server/locating/path_loss.hpp"

namespace wayfuse {

struct TrilaterationSettings {
  int strongest = 8;               ///< transmitters used, 3..32
  double threshold = 0.05;         ///< T of [P3 algorithm 2]: an exponent is replaced when it is off by more
  bool online = true;              ///< learn the exponents from the fused position; false = the survey's
  double beyond_m = 1e5;           ///< a solution farther outside the surveyed box of its floor is no fix
};

/// Path loss and trilateration: distances from levels, linearised least squares [P3 eqs. 1-6].
///
/// Transmitters' places, levels and first exponents are fitted to the survey (path_loss.hpp). The equation subtracted from the others
/// is the strongest transmitter's. `learn()` is [P3 algorithm 2]: from the fused position each transmitter's exponent
/// (P(d0) - P(d)) / (10 log10 d) replaces the one in use when they differ by more than T (eq. 12); places nearer than 2 m teach
/// nothing. Fewer than three usable transmitters, three on a line, or a solution far outside everything surveyed: no fix. A measured time-of-flight range stands in
/// for the level's. The exponents belong to the session.
class Trilateration final : public LocatorModel {
 public:
  Trilateration(std::shared_ptr<const RadioMap> map, const TrilaterationSettings& settings);
  std::unique_ptr<Locator> make() const override;

  const TrilaterationSettings& settings() const { return settings_; }
  const RadioMap& map() const { return *map_; }
  const std::vector<std::optional<PathLoss>>& laws() const { return laws_; }
  /// Around everything surveyed on a floor.
  struct Box {
    double least_x_m, least_y_m, most_x_m, most_y_m;
  };
  const std::map<FloorOrdinal, Box>& surveyed() const { return surveyed_; }

 private:
  std::shared_ptr<const RadioMap> map_;
  TrilaterationSettings settings_;
  std::vector<std::optional<PathLoss>> laws_;
  std::map<FloorOrdinal, Box> surveyed_;
};

/// A session's locator; the exponents in use are readable for reports.
class TrilaterationLocator final : public Locator {
 public:
  explicit TrilaterationLocator(const Trilateration& model);
  std::unique_ptr<Locator> clone() const override { return std::make_unique<TrilaterationLocator>(*this); }
  std::optional<Fix> locate(const RssScan& scan) override;
  std::span<const FloorProbability> floors() const override { return floors_; }
  int transmitters_known() const override { return known_; }
  int transmitters_unknown() const override { return scan_.unknown; }
  std::span<const TransmitterRange> ranges() const override { return ranges_; }
  void learn(const RssScan& scan, const Place& fused) override;
  void inherit(const Locator& older) override;

  std::span<const double> exponents() const { return exponents_; }

 private:
  void measure(const RssScan& scan, FloorOrdinal floor);
  std::optional<BuildingPoint> solve() const;
  bool within_reach(BuildingPoint point, FloorOrdinal floor) const;

  const Trilateration& model_;
  std::vector<double> exponents_;  // a transmitter of the map
  KnownScan scan_;
  int known_ = 0;
  std::vector<FloorProbability> floors_;
  std::vector<TransmitterRange> ranges_;   // strongest first
};

}  // namespace wayfuse
