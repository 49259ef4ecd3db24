#pragma once

#include <memory>
#include <vector>

#include "server/locating/catalogue.hpp"

namespace wayfuse {

struct ProbabilisticSettings {
  bool histogram = false;          ///< the readings heard at the point's place, smoothed; otherwise a Gaussian
  double sigma_db = 6.0;           ///< prior spread of a level at a point; the histogram's smoothing
  double prior_scans = 4.0;        ///< scans the prior counts for, against the point's own spread
  double surprise = -7.0;          ///< log density of a level the point never heard, per dB
  double temper = 0.3;             ///< power of the likelihood: readings of a scan are not independent
};

/// Probabilistic fingerprinting (Horus, Youssef and Agrawala 2005): log p(scan | point) = sum over transmitters of the log density of
/// the level heard, of surprise for a level the point never heard, and of silence for one it used to hear, by its own rate.
///
/// The fix is the mean over the floor's points under the tempered posterior, its sigma their spread. Sparse and exact: an
/// inverted index touches only points that hear something in common.
class Probabilistic final : public LocatorModel {
 public:
  Probabilistic(const LocatingSite& site, const ProbabilisticSettings& settings);
  std::unique_ptr<Locator> make() const override;

  const ProbabilisticSettings& settings() const { return settings_; }
  const RadioMap& map() const { return *map_; }
  double least_sigma_m() const { return least_sigma_m_; }
  /// log p(scan | point), one entry a point.
  void log_likelihood(const KnownScan& scan, std::span<double> out) const;

 private:
  struct Heard {
    std::uint32_t point;
    float mean_dbm;
    float sigma_db;
    float log_silent;              ///< log probability that the point does not hear it
    std::uint32_t first_sample;    ///< into samples_dbm_, histogram only
    std::uint32_t samples;
  };
  double log_density(const Heard& heard, double rss_dbm) const;
  void keep_samples(std::span<const ReferencePoint> survey);

  std::shared_ptr<const RadioMap> map_;
  ProbabilisticSettings settings_;
  double least_sigma_m_;
  std::vector<double> silent_;              // a point: log probability of hearing nothing
  std::vector<std::uint32_t> first_heard_;  // a transmitter, and one past the end
  std::vector<Heard> heard_;
  std::vector<float> samples_dbm_;
};

}  // namespace wayfuse
