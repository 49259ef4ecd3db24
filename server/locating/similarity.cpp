#include "server/locating/similarity.hpp"

#include <algorithm>
#include <cmath>

#include "server/locating/nearest_neighbours.hpp"

namespace wayfuse {
namespace {

constexpr float kNothingInCommon = 1.0f;
constexpr double kOffsetStep_db = 4.0;  // between offsets tried; half of it costs a neighbour next to nothing

class SimilarityLocator final : public Locator {
 public:
  explicit SimilarityLocator(const Similarity& model) : model_(model) {}
  std::unique_ptr<Locator> clone() const override { return std::make_unique<SimilarityLocator>(*this); }
  int transmitters_known() const override { return static_cast<int>(scan_.levels.size()); }
  int transmitters_unknown() const override { return scan_.unknown; }
  std::span<const FloorProbability> floors() const override { return floors_; }

  std::optional<Fix> locate(const RssScan& scan) override {
    model_.map().know(scan, scan_);
    floors_.clear();
    if (scan_.levels.empty()) return std::nullopt;
    model_.distances(scan_, distances_, sums_);
    vote();
    if (floors_.empty()) return std::nullopt;  // what is known was too faint to count
    return mean(floors_.front().floor);
  }

 private:
  // The `most` nearest points of a floor to the front of nearest_, in order.
  void choose(FloorOrdinal floor, std::size_t most) {
    const auto points = model_.map().points();
    nearest_.clear();
    for (std::uint32_t j = 0; j < points.size(); ++j) {
      if (points[j].place.floor == floor) nearest_.push_back(j);
    }
    most = std::min(most, nearest_.size());
    const auto nearer = [&](std::uint32_t a, std::uint32_t b) {
      return distances_[a] != distances_[b] ? distances_[a] < distances_[b] : a < b;
    };
    std::partial_sort(nearest_.begin(), nearest_.begin() + static_cast<std::ptrdiff_t>(most), nearest_.end(), nearer);
    nearest_.resize(most);
  }

  void vote() {
    const auto points = model_.map().points();
    const float least = *std::ranges::min_element(distances_);
    double total = 0.0;
    for (const FloorOrdinal floor : model_.map().floors()) {
      double sum = 0.0;
      std::size_t count = 0;
      for (std::size_t j = 0; j < points.size(); ++j) {
        if (points[j].place.floor != floor || distances_[j] >= kNothingInCommon) continue;
        ++count;
        sum += std::exp(-model_.settings().sharpness * (distances_[j] - least));
      }
      if (count == 0) continue;
      floors_.push_back({floor, sum / static_cast<double>(count)});
      total += floors_.back().probability;
    }
    for (FloorProbability& vote : floors_) vote.probability /= total;
    most_probable_first(floors_);
  }

  Fix mean(FloorOrdinal floor) {
    const auto points = model_.map().points();
    choose(floor, static_cast<std::size_t>(model_.settings().k));
    double total = 0.0, x_m = 0.0, y_m = 0.0;
    const auto weight = [&](std::uint32_t j) {
      return std::exp(-model_.settings().sharpness * (distances_[j] - distances_[nearest_.front()]));
    };
    for (const std::uint32_t j : nearest_) {
      const double w = weight(j);
      total += w;
      x_m += w * points[j].place.point.x_m;
      y_m += w * points[j].place.point.y_m;
    }
    const BuildingPoint middle{x_m / total, y_m / total};
    double scatter_m2 = 0.0;
    for (const std::uint32_t j : nearest_) {
      const double d_m = distance_m(points[j].place.point, middle);
      scatter_m2 += 0.5 * weight(j) / total * d_m * d_m;
    }
    return {{middle, floor}, std::max(std::sqrt(scatter_m2), model_.least_sigma_m()), transmitters_known()};
  }

  const Similarity& model_;  // outlives its locators: the tracker's factory holds both
  KnownScan scan_;
  std::vector<float> distances_;
  Similarity::Sums sums_;
  std::vector<std::uint32_t> nearest_;
  std::vector<FloorProbability> floors_;
};

}  // namespace

Similarity::Similarity(std::shared_ptr<const RadioMap> map, const SimilaritySettings& settings)
    : map_(std::move(map)), settings_(settings), least_sigma_m_(half_spacing_m(*map_)) {
  std::vector<LevelBlocks::Level> levels;
  const auto points = map_->points();
  for (std::uint32_t j = 0; j < points.size(); ++j) {
    float total = 0.0f, squares = 0.0f;
    for (const MapLevel& level : map_->levels(points[j])) {
      const float v = loudness(level.mean_dbm);
      levels.push_back({j, level.transmitter, v});
      total += v;
      squares += v * v;
    }
    total_.push_back(total);
    norm_.push_back(std::sqrt(squares));
  }
  blocks_ = LevelBlocks(points.size(), map_->transmitters().size(), levels);
  total_.resize(blocks_.padded());
  norm_.resize(blocks_.padded());
}

std::unique_ptr<Locator> Similarity::make() const {
  return std::make_unique<SimilarityLocator>(*this);
}

float Similarity::loudness(double rss_dbm) const {
  const double above = std::clamp((rss_dbm - settings_.floor_dbm) / -settings_.floor_dbm, 0.0, 1.0);
  return static_cast<float>(std::pow(above, settings_.power));
}

void Similarity::distances(const KnownScan& scan, std::vector<float>& out, Sums& sums) const {
  out.assign(map_->points().size(), kNothingInCommon);
  for (auto* column : {&sums.overlaps, &sums.products, &sums.sorensen, &sums.cosine}) column->resize(blocks_.padded());
  const int steps = static_cast<int>(std::floor(settings_.offset_most_db / kOffsetStep_db));
  for (int step = -steps; step <= steps; ++step) lower_distances(scan, step * kOffsetStep_db, out, sums);
}

void Similarity::lower_distances(const KnownScan& scan, double offset_db, std::vector<float>& out, Sums& sums) const {
  std::ranges::fill(sums.overlaps, 0.0f);
  std::ranges::fill(sums.products, 0.0f);
  float total = 0.0f, squares = 0.0f;
  for (const KnownScan::Level& level : scan.levels) {
    const float u = loudness(level.rss_dbm + offset_db);
    if (u <= 0.0f) continue;
    total += u;
    squares += u * u;
    blocks_.add_overlaps_and_products(level.transmitter, u, sums.overlaps, sums.products);
  }
  similarity_distances(total, total_, sums.overlaps, sums.sorensen, std::sqrt(squares), norm_, sums.products, sums.cosine);
  const auto mix = static_cast<float>(settings_.cosine);
  for (std::size_t j = 0; j < out.size(); ++j) {
    if (sums.overlaps[j] > 0.0f) out[j] = std::min(out[j], (1.0f - mix) * sums.sorensen[j] + mix * sums.cosine[j]);
  }
}

}  // namespace wayfuse
