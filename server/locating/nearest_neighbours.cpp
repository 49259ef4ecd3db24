#include "server/locating/nearest_neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wayfuse {
namespace {

constexpr double kLeastDistance = 1e-3;  // dB: an exact match outweighs the others, it does not divide by zero

class NearestNeighboursLocator final : public Locator {
 public:
  explicit NearestNeighboursLocator(const NearestNeighbours& model) : model_(model) {}
  std::unique_ptr<Locator> clone() const override { return std::make_unique<NearestNeighboursLocator>(*this); }
  int transmitters_known() const override { return static_cast<int>(scan_.levels.size()); }
  int transmitters_unknown() const override { return scan_.unknown; }
  std::span<const FloorProbability> floors() const override { return floors_; }

  std::optional<Fix> locate(const RssScan& scan) override {
    const RadioMap& map = model_.distance().map();
    map.know(scan, scan_);
    if (scan_.levels.empty()) return std::nullopt;
    model_.distance().approximate(scan_, distances_);
    choose(0, static_cast<std::uint32_t>(map.points().size()));
    vote();
    const FloorOrdinal floor = floors_.front().floor;
    if (floors_.front().probability < 1.0) {
      const auto on_floor = map.points_on(floor);
      choose(on_floor.begin, on_floor.end);
    }
    return mean(floor);
  }

 private:
  struct Chosen {
    std::uint32_t point;
    double weight;
  };

  // The k nearest of the points begin .. end - 1, with their weights.
  void choose(std::uint32_t begin, std::uint32_t end) {
    model_.distance().nearest(scan_, distances_, static_cast<std::size_t>(model_.settings().k), begin, end, nearest_);
    chosen_.clear();
    double sum = 0.0;
    for (const RssDistance::Neighbour& neighbour : nearest_) {
      const double distance = std::max(model_.distance().root(neighbour.powered), kLeastDistance);
      chosen_.push_back({neighbour.point, model_.settings().weighted ? 1.0 / distance : 1.0});
      sum += chosen_.back().weight;
    }
    for (Chosen& neighbour : chosen_) neighbour.weight /= sum;
  }

  void vote() {
    const RadioMap& map = model_.distance().map();
    floors_.clear();
    for (const FloorOrdinal floor : map.floors()) {
      double share = 0.0;
      for (const Chosen& neighbour : chosen_) {
        if (map.points()[neighbour.point].place.floor == floor) share += neighbour.weight;
      }
      if (share > 0.0) floors_.push_back({floor, share});
    }
    most_probable_first(floors_);
    if (floors_.size() == 1) floors_.front().probability = 1.0;
  }

  Fix mean(FloorOrdinal floor) const {
    const auto points = model_.distance().map().points();
    double x_m = 0.0, y_m = 0.0, scatter_m2 = 0.0;
    for (const Chosen& neighbour : chosen_) {
      x_m += neighbour.weight * points[neighbour.point].place.point.x_m;
      y_m += neighbour.weight * points[neighbour.point].place.point.y_m;
    }
    for (const Chosen& neighbour : chosen_) {
      const double d_m = distance_m(points[neighbour.point].place.point, {x_m, y_m});
      scatter_m2 += 0.5 * neighbour.weight * d_m * d_m;
    }
    return {{{x_m, y_m}, floor}, std::max(std::sqrt(scatter_m2), model_.least_sigma_m()), transmitters_known()};
  }

  const NearestNeighbours& model_;  // outlives its locators: the tracker's factory holds both
  KnownScan scan_;
  RssDistance::Approximate distances_;
  std::vector<RssDistance::Neighbour> nearest_;
  std::vector<Chosen> chosen_;
  std::vector<FloorProbability> floors_;
};

}  // namespace

double half_spacing_m(const RadioMap& map) {
  std::vector<double> nearest;
  const auto points = map.points();
  const std::size_t stride = 1 + points.size() / 500;  // a median needs no more
  for (std::size_t i = 0; i < points.size(); i += stride) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (i == j || points[i].place.floor != points[j].place.floor) continue;
      const double d_m = distance_m(points[i].place.point, points[j].place.point);
      if (d_m > 0.0) least = std::min(least, d_m);
    }
    if (std::isfinite(least)) nearest.push_back(least);
  }
  if (nearest.empty()) return 1.0;
  std::ranges::nth_element(nearest, nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2));
  return 0.5 * nearest[nearest.size() / 2];
}

NearestNeighbours::NearestNeighbours(std::shared_ptr<const RadioMap> map, const NearestNeighboursSettings& settings)
    : settings_(settings), distance_(map, settings.distance), least_sigma_m_(std::max(0.5, half_spacing_m(*map))) {}

std::unique_ptr<Locator> NearestNeighbours::make() const { return std::make_unique<NearestNeighboursLocator>(*this); }

}  // namespace wayfuse
