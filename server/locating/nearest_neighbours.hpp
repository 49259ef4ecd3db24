#pragma once

#include <memory>
#include <vector>

#include "server/locating/catalogue.hpp"
#include "server/locating/rss_distance.hpp"

namespace wayfuse {

struct NearestNeighboursSettings {
  int k = 4;                       ///< neighbours, 1..64
  bool weighted = true;            ///< weights 1 / D [P1 eq. 3]; otherwise the plain mean [P2]
  RssDistanceSettings distance;
};

/// K nearest fingerprints in signal space: NN (RADAR), KNN [P2] and WKNN [P1 eqs. 1-3], one formula.
///
/// The floor is the one most of the K nearest stand on, by weight; the point is then taken from the K nearest of that floor,
/// so that a neighbour from another storey never pulls it through a ceiling. The fix's sigma is the neighbours' own scatter, and at
/// least half the distance between neighbouring points of the map. Cost: O(points + readings in common).
class NearestNeighbours final : public LocatorModel {
 public:
  NearestNeighbours(std::shared_ptr<const RadioMap> map, const NearestNeighboursSettings& settings);
  std::unique_ptr<Locator> make() const override;

  const NearestNeighboursSettings& settings() const { return settings_; }
  const RssDistance& distance() const { return distance_; }
  double least_sigma_m() const { return least_sigma_m_; }

 private:
  NearestNeighboursSettings settings_;
  RssDistance distance_;
  double least_sigma_m_ = 1.0;
};

/// Half the median distance from a point of the map to its nearest neighbour on the same floor; 1 m where there is none.
double half_spacing_m(const RadioMap& map);

}  // namespace wayfuse
