#include "server/locating/catalogue.hpp"

#include <array>

#include "server/locating/nearest_neighbours.hpp"

namespace wayfuse {
namespace {

const SettingDescription kNeighbours{"k", 4, 1, 64, "neighbours averaged; more are smoother and blur corners", "[P1 eq. 2]", true};
const SettingDescription kExponent{"exponent", 2, 0.5, 8, "Minkowski's a: 1 Manhattan, 2 Euclidean; larger heeds the worst transmitter",
                                   "[P2]"};
const SettingDescription kFloor{"floor_dbm", -100, -120, -60,
                                "level assumed for a transmitter heard on one side only; lower punishes a missing one harder",
                                "[P1 eq. 1]"};

template <bool kWeighted>
std::shared_ptr<const LocatorModel> neighbours(const LocatingSite& site, const PartSettings& s) {
  return std::make_shared<NearestNeighbours>(
      site.map, NearestNeighboursSettings{s.count("k"), kWeighted, {s["exponent"], s["floor_dbm"]}});
}

std::shared_ptr<const LocatorModel> nearest(const LocatingSite& site, const PartSettings& s) {
  return std::make_shared<NearestNeighbours>(site.map, NearestNeighboursSettings{1, false, {s["exponent"], s["floor_dbm"]}});
}

}  // namespace

std::span<const LocatorRow> locator_catalogue() {
  static const std::array rows = {
      LocatorRow{{"locator", "none", "scans say nothing about the place", {}}, nullptr, false},
      LocatorRow{{"locator", "nn", "the nearest fingerprint in signal space (RADAR)", {kExponent, kFloor}}, nearest},
      LocatorRow{{"locator", "knn", "plain mean of the K nearest fingerprints [P2]", {kNeighbours, kExponent, kFloor}},
                 neighbours<false>},
      LocatorRow{{"locator", "wknn", "mean of the K nearest fingerprints weighted by 1 / D [P1 eqs. 1-3]",
                  {kNeighbours, kExponent, kFloor}},
                 neighbours<true>},
  };
  return rows;
}

}  // namespace wayfuse
