#pragma once

#include <memory>
#include <vector>

#include "server/locating/catalogue.hpp"
#include "server/locating/level_blocks.hpp"

namespace wayfuse {

struct SimilaritySettings {
  int k = 24;                   ///< neighbours averaged, 1..64
  double floor_dbm = -105.0;    ///< level that counts as nothing
  double power = 1.8;           ///< of the level above the floor: larger heeds the strong transmitters more
  double cosine = 0.35;         ///< share of the cosine distance, the rest is Sorensen's, 0..1
  double offset_most_db = 8.0;  ///< how much louder or quieter than the survey's a phone may hear, 0..20
  double sharpness = 20.0;      ///< likelihood falls by e for every 1 / sharpness of distance
};

/// Neighbours by similarity: what both heard, and how much of it, instead of differences in decibel.
///
/// A level becomes u = ((rss - floor) / -floor)^power, so that a transmitter not heard is 0 and a weak one nearly so: one that
/// is missing from a scan hardly counts, whereas Euclid charges it in full. Distances to every fingerprint: Sorensen's 1 - 2
/// sum min(u, v) / (sum u + sum v), and 1 - cosine, mixed; the least of them over a few level offsets of the whole scan, since
/// phones differ by several decibel. A fingerprint's likelihood is exp(-sharpness d): the floor is the
/// one with the greatest mean of it over the fingerprints that share a transmitter with the scan (every floor is as likely
/// before, however densely it was surveyed), the point is the mean of the k nearest of that floor, weighted by it.
/// Representation and distance after Torres-Sospedra et al. 2015, "Comprehensive analysis of distance and similarity measures
/// for Wi-Fi fingerprinting indoor positioning systems". Cost: O(points + readings in common), no allocation once grown.
class Similarity final : public LocatorModel {
 public:
  Similarity(std::shared_ptr<const RadioMap> map, const SimilaritySettings& settings);
  std::unique_ptr<Locator> make() const override;

  /// How much of a level is above the floor, 0..1.
  float loudness(double rss_dbm) const;
  /// Mixed distances, 0..1, from a scan to every point, the least over the offsets.
  struct Sums {                     ///< memory that is kept from scan to scan
    std::vector<float> overlaps, products, sorensen, cosine;
  };
  void distances(const KnownScan& scan, std::vector<float>& out, Sums& sums) const;

  const RadioMap& map() const { return *map_; }
  const SimilaritySettings& settings() const { return settings_; }
  double least_sigma_m() const { return least_sigma_m_; }

 private:
  void lower_distances(const KnownScan& scan, double offset_db, std::vector<float>& out, Sums& sums) const;

  std::shared_ptr<const RadioMap> map_;
  SimilaritySettings settings_;
  double least_sigma_m_ = 1.0;
  LevelBlocks blocks_;              // loudness
  std::vector<float> total_;        // a point: sum of its loudness; then up to a whole block
  std::vector<float> norm_;         // a point: root of the sum of squares
};

}  // namespace wayfuse
