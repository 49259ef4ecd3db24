#pragma once

#include <optional>
#include <span>
#include <vector>

#include "server/locating/radio_map.hpp"
#include "wayfuse/proto/fix.hpp"

namespace wayfuse {

/// One transmitter as the log-distance law sees it: P(d) = at_1m_dbm - 10 exponent log10(d / 1 m) [P3 eq. 1].
struct PathLoss {
  Place transmitter;               ///< horizontal; the height difference is part of the law's constants
  double at_1m_dbm = -40.0;
  double exponent = 2.0;
  double sigma_db = 6.0;           ///< of the survey about the law
  int points = 0;                  ///< fingerprints it was fitted to

  double level_dbm(double distance_m) const;
  /// [P3 eq. 2], with another exponent than the survey's where one was learnt.
  double distance_m(double rss_dbm, double with_exponent) const;
  double distance_m(double rss_dbm) const { return distance_m(rss_dbm, exponent); }
};

/// Place, level and exponent of every transmitter, by least squares over the fingerprints that heard it on the floor where it is
/// loudest. Absent for one heard at fewer than 4 places there, or only along a line too short to place it.
std::vector<std::optional<PathLoss>> fit_path_loss(const RadioMap& map);

/// What the transmitters of a scan say about the floor: each speaks for its own, e times louder for every 6 dB that it is heard louder.
/// Probabilities, descending. `levels` holds at least one, and no transmitter without a law.
void vote_for_floors(std::span<const KnownScan::Level> levels, std::span<const std::optional<PathLoss>> laws, std::vector<FloorProbability>& votes);

inline constexpr double kLeastExponent = 1.0;
inline constexpr double kMostExponent = 6.0;

}  // namespace wayfuse
