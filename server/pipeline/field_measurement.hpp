#pragma once

#include <vector>

#include "server/locating/locator.hpp"
#include "server/tracking/measurement_model.hpp"

namespace wayfuse {

/// Memory a field measurement needs, kept by the session so that a scan allocates nothing.
struct FieldScratch {
  std::vector<float> x_m;
  std::vector<float> y_m;
  std::vector<float> log_likelihood;
};

/// A locator's likelihood of its newest scan, looked up where each particle was when the scan was heard.
///
/// A particle weighs log(exp(weight (l - best)) + outlier): one wrong scan cannot kill it. Particles that carry a heading error or a
/// stride of their own went `carried` turned and stretched by it. Particles only: there is no Gaussian form.
class FieldMeasurement final : public MeasurementModel {
 public:
  FieldMeasurement(const Locator& locator, FloorOrdinal floor, BuildingPoint carried, double weight, double outlier,
                   FieldScratch& scratch)
      : locator_(locator), floor_(floor), carried_(carried), weight_(weight), outlier_(outlier), scratch_(scratch) {}
  void weigh(const ParticleCloud& cloud, std::span<float> log_weight) const override;

 private:
  const Locator& locator_;
  FloorOrdinal floor_;
  BuildingPoint carried_;
  double weight_;
  double outlier_;
  FieldScratch& scratch_;
};

}  // namespace wayfuse
