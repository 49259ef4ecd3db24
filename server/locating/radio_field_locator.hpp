#pragma once

#include <memory>
#include <vector>

#include "server/locating/radio_field.hpp"

namespace wayfuse {

/// One session's view of a RadioField: the newest scan matched against it.
///
/// Cost of a scan: the postings of the radios heard, then the lattice nodes around the particles. Between scans (after rest())
/// it holds no more than a few hundred bytes. Thread: confined to one session.
class RadioFieldLocator final : public Locator {
 public:
  explicit RadioFieldLocator(std::shared_ptr<const RadioField> field);
  RadioFieldLocator(const RadioFieldLocator& other);
  ~RadioFieldLocator() override;
  std::unique_ptr<Locator> clone() const override { return std::make_unique<RadioFieldLocator>(*this); }

  std::optional<Fix> locate(const RssScan& scan) override;
  std::span<const FloorProbability> floors() const override { return floors_; }
  int transmitters_known() const override { return known_; }
  int transmitters_unknown() const override { return unknown_; }
  bool has_likelihood() const override { return true; }
  void add_log_likelihood(std::span<const float> x_m, std::span<const float> y_m, FloorOrdinal floor,
                          std::span<float> log_likelihood) const override;
  bool draw(FloorOrdinal floor, Random& random, std::span<float> x_m, std::span<float> y_m) override;
  Duration heard_before() const override { return heard_before_; }
  double mismatch() const override { return mismatch_; }
  int implausible(FloorOrdinal floor, BuildingPoint point) const override;
  int out_of_place(FloorOrdinal floor, BuildingPoint point) const override;
  std::optional<double> misfit(FloorOrdinal floor, BuildingPoint point) const override;
  void rest() override;
  void learn(const RssScan& scan, const Place& fused) override;
  void inherit(const Locator& older) override;

 private:
  static constexpr double kOffsetSigma_db = 4.0;   // between phone models
  bool listen(const RssScan& scan);
  void leave_out_misplaced();
  int apart_from_each_other() const;
  int far_from_home(BuildingPoint point) const;
  bool settled(const std::optional<std::uint32_t>& radio) const;
  void vote();
  const RadioField::Storey* storey(FloorOrdinal floor) const;
  float node(const RadioField::Storey& storey, int column, int row) const;
  float resemblance(std::uint32_t fingerprint) const;

  std::shared_ptr<const RadioField> field_;
  std::unique_ptr<RadioField::Scratch> scratch_;   // from locate() to rest()
  int misplaced_ = 0;                              // of the strong: what the rest of the scan denies
  float sum_ = 0.0f;
  float norm_ = 0.0f;
  mutable std::vector<std::uint8_t> exposed_;      // a storey, for the newest scan
  std::vector<float> best_;                        // a storey: mean of its smallest distances
  std::vector<FloorProbability> floors_;
  int known_ = 0;
  int unknown_ = 0;
  Duration heard_before_{0};
  double mismatch_ = 1.0;
  double offset_db_ = 0.0;                         ///< how much louder than the survey's this phone hears, as it turns out
  double offset_variance_db2_ = kOffsetSigma_db * kOffsetSigma_db;
  double level_db_ = 0.0;                          ///< above -100 dBm, mean of the newest scan by strength
};

}  // namespace wayfuse
