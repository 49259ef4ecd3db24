#pragma once

#include <memory>
#include <optional>
#include <span>

#include "server/locating/locator.hpp"
#include "wayfuse/proto/random.hpp"

namespace wayfuse {

/// Every scan was heard within 3 m of one point.
class Beacon final : public Locator {
 public:
  explicit Beacon(BuildingPoint point) : point_(point) {}
  std::unique_ptr<Locator> clone() const override { return std::make_unique<Beacon>(*this); }
  std::optional<Fix> locate(const RssScan&) override { return Fix{{point_, FloorOrdinal{0}}, 3.0, 10}; }
  int transmitters_known() const override { return 10; }
  int transmitters_unknown() const override { return 0; }
  bool has_likelihood() const override { return true; }
  void add_log_likelihood(std::span<const float> x_m, std::span<const float> y_m, FloorOrdinal, std::span<float> out) const override {
    for (std::size_t i = 0; i < x_m.size(); ++i) {
      const double dx_m = static_cast<double>(x_m[i]) - point_.x_m, dy_m = static_cast<double>(y_m[i]) - point_.y_m;
      out[i] -= static_cast<float>((dx_m * dx_m + dy_m * dy_m) / 18.0);
    }
  }
  bool draw(FloorOrdinal, Random& random, std::span<float> x_m, std::span<float> y_m) override {
    for (std::size_t i = 0; i < x_m.size(); ++i) {
      x_m[i] = static_cast<float>(point_.x_m + 3.0 * random.normal());
      y_m[i] = static_cast<float>(point_.y_m + 3.0 * random.normal());
    }
    return true;
  }

 private:
  BuildingPoint point_;
};

}  // namespace wayfuse
