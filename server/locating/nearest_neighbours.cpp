#include "server/locating/nearest_neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wayfuse {
namespace {

constexpr double kLeastDistance = 1e-3;  // dB: an exact match outweighs the others, it does not divide by zero

struct Neighbour {
  double distance;                 // powered first, rooted when chosen
  std::uint32_t point;
  double weight;
  // The order is total, so that ties never depend on the order of the survey's memory.
  bool operator<(const Neighbour& other) const {
    return distance != other.distance ? distance < other.distance : point < other.point;
  }
};

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
    distances_.resize(map.points().size());
    model_.distance().powered(scan_, distances_);
    choose([](const MapPoint&) { return true; });
    vote();
    const FloorOrdinal floor = floors_.front().floor;
    if (floors_.front().probability < 1.0) choose([&](const MapPoint& point) { return point.place.floor == floor; });
    return mean(floor);
  }

 private:
  // The k nearest points that `may` stand for, with their weights.
  void choose(const auto& may) {
    const auto points = model_.distance().map().points();
    const auto k = static_cast<std::size_t>(model_.settings().k);
    chosen_.clear();
    for (std::uint32_t j = 0; j < points.size(); ++j) {
      if (!may(points[j])) continue;
      const Neighbour neighbour{distances_[j], j, 1.0};
      if (chosen_.size() == k) {
        if (!(neighbour < chosen_.front())) continue;
        std::ranges::pop_heap(chosen_, std::less<>{});
        chosen_.pop_back();
      }
      chosen_.push_back(neighbour);
      std::ranges::push_heap(chosen_, std::less<>{});
    }
    double sum = 0.0;
    for (Neighbour& neighbour : chosen_) {
      neighbour.distance = model_.distance().root(neighbour.distance);
      if (model_.settings().weighted) neighbour.weight = 1.0 / std::max(neighbour.distance, kLeastDistance);
      sum += neighbour.weight;
    }
    for (Neighbour& neighbour : chosen_) neighbour.weight /= sum;
  }

  void vote() {
    const RadioMap& map = model_.distance().map();
    floors_.clear();
    for (const FloorOrdinal floor : map.floors()) {
      double share = 0.0;
      for (const Neighbour& neighbour : chosen_) {
        if (map.points()[neighbour.point].place.floor == floor) share += neighbour.weight;
      }
      if (share > 0.0) floors_.push_back({floor, share});
    }
    std::ranges::stable_sort(floors_, std::ranges::greater{}, &FloorProbability::probability);
    if (floors_.size() == 1) floors_.front().probability = 1.0;
  }

  Fix mean(FloorOrdinal floor) const {
    const auto points = model_.distance().map().points();
    double x_m = 0.0, y_m = 0.0, scatter_m2 = 0.0;
    for (const Neighbour& neighbour : chosen_) {
      x_m += neighbour.weight * points[neighbour.point].place.point.x_m;
      y_m += neighbour.weight * points[neighbour.point].place.point.y_m;
    }
    for (const Neighbour& neighbour : chosen_) {
      const double d_m = distance_m(points[neighbour.point].place.point, {x_m, y_m});
      scatter_m2 += 0.5 * neighbour.weight * d_m * d_m;
    }
    return {{{x_m, y_m}, floor}, std::max(std::sqrt(scatter_m2), model_.least_sigma_m()), transmitters_known()};
  }

  const NearestNeighbours& model_;  // outlives its locators: the tracker's factory holds both
  KnownScan scan_;
  std::vector<double> distances_;
  std::vector<Neighbour> chosen_;   // a heap while choosing
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
