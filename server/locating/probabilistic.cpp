#include "server/locating/probabilistic.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "server/locating/nearest_neighbours.hpp"

namespace wayfuse {
namespace {

class ProbabilisticLocator final : public Locator {
 public:
  explicit ProbabilisticLocator(const Probabilistic& model) : model_(model) {}
  std::unique_ptr<Locator> clone() const override { return std::make_unique<ProbabilisticLocator>(*this); }
  int transmitters_known() const override { return static_cast<int>(scan_.levels.size()); }
  int transmitters_unknown() const override { return scan_.unknown; }
  std::span<const FloorProbability> floors() const override { return floors_; }

  std::optional<Fix> locate(const RssScan& scan) override {
    const auto points = model_.map().points();
    model_.map().know(scan, scan_);
    if (scan_.levels.empty()) return std::nullopt;
    weights_.resize(points.size());
    model_.log_likelihood(scan_, weights_);
    const double best = std::ranges::max(weights_);
    double sum = 0.0;
    for (double& weight : weights_) {
      weight = std::exp(model_.settings().temper * (weight - best));
      sum += weight;
    }
    for (double& weight : weights_) weight /= sum;
    vote();
    return mean(floors_.front());
  }

 private:
  void vote() {
    floors_.clear();
    for (const FloorOrdinal floor : model_.map().floors()) {
      double share = 0.0;
      for (std::size_t j = 0; j < weights_.size(); ++j) {
        if (model_.map().points()[j].place.floor == floor) share += weights_[j];
      }
      floors_.push_back({floor, share});
    }
    most_probable_first(floors_);
  }

  Fix mean(const FloorProbability& floor) const {
    const auto points = model_.map().points();
    double x_m = 0.0, y_m = 0.0, squared_m2 = 0.0;
    const auto each = [&](const auto& visit) {
      for (std::size_t j = 0; j < points.size(); ++j) {
        if (points[j].place.floor == floor.floor) visit(weights_[j] / floor.probability, points[j].place.point);
      }
    };
    each([&](double weight, BuildingPoint point) {
      x_m += weight * point.x_m;
      y_m += weight * point.y_m;
    });
    each([&](double weight, BuildingPoint point) {
      const double d_m = distance_m(point, {x_m, y_m});
      squared_m2 += 0.5 * weight * d_m * d_m;
    });
    return {{{x_m, y_m}, floor.floor}, std::max(std::sqrt(squared_m2), model_.least_sigma_m()), transmitters_known()};
  }

  const Probabilistic& model_;
  KnownScan scan_;
  std::vector<double> weights_;
  std::vector<FloorProbability> floors_;
};

}  // namespace

Probabilistic::Probabilistic(const LocatingSite& site, const ProbabilisticSettings& settings)
    : map_(site.map), settings_(settings), least_sigma_m_(std::max(0.5, half_spacing_m(*map_))),
      first_heard_(map_->transmitters().size() + 1) {
  for (const MapLevel& level : map_->levels()) ++first_heard_[level.transmitter + 1];
  for (std::size_t i = 1; i < first_heard_.size(); ++i) first_heard_[i] += first_heard_[i - 1];
  heard_.resize(map_->levels().size());
  auto next = first_heard_;
  for (std::uint32_t j = 0; j < map_->points().size(); ++j) {
    const MapPoint& point = map_->points()[j];
    double silence = 0.0;
    for (const MapLevel& level : map_->levels(point)) {
      const double own = std::max(0.0, static_cast<double>(level.heard) - 1.0);
      const double variance = (settings.prior_scans * settings.sigma_db * settings.sigma_db +
                               own * static_cast<double>(level.spread_db) * static_cast<double>(level.spread_db)) /
                              (settings.prior_scans + own);
      const double rate = (level.heard + 0.5) / (point.scans + 1.0);
      const auto log_silent = static_cast<float>(std::log(1.0 - std::min(rate, 0.98)));
      heard_[next[level.transmitter]++] = {j, level.mean_dbm, static_cast<float>(std::sqrt(variance)), log_silent, 0, 0};
      silence += static_cast<double>(log_silent);
    }
    silent_.push_back(silence);
  }
  if (settings.histogram) keep_samples(site.survey);
}

void Probabilistic::keep_samples(std::span<const ReferencePoint> survey) {
  // The map has an order of its own: readings go by the place they were heard at, whoever stood there.
  using At = std::tuple<std::int32_t, double, double>;
  const auto at = [](const Place& place) { return At{place.floor.value, place.point.x_m, place.point.y_m}; };
  std::map<At, std::uint32_t> places;
  for (const MapPoint& point : map_->points()) places.try_emplace(at(point.place), static_cast<std::uint32_t>(places.size()));
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<float>> readings;  // (transmitter, place)
  for (const ReferencePoint& point : survey) {
    const auto place = places.find(at(point.place));
    if (place == places.end()) continue;
    for (const RssScan& scan : point.scans) {
      for (const ScanReading& reading : scan.readings) {
        const auto transmitter = map_->index_of(reading.bssid);
        if (usable(reading) && transmitter) readings[{*transmitter, place->second}].push_back(static_cast<float>(reading.rss_dbm));
      }
    }
  }
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> first;  // points at one place share their samples
  for (const auto& [key, own] : readings) {
    first[key] = static_cast<std::uint32_t>(samples_dbm_.size());
    samples_dbm_.insert(samples_dbm_.end(), own.begin(), own.end());
  }
  for (std::uint32_t transmitter = 0; transmitter + 1 < first_heard_.size(); ++transmitter) {
    for (std::uint32_t k = first_heard_[transmitter]; k < first_heard_[transmitter + 1]; ++k) {
      const std::pair key{transmitter, places.at(at(map_->points()[heard_[k].point].place))};
      heard_[k].first_sample = first.at(key);
      heard_[k].samples = static_cast<std::uint32_t>(readings.at(key).size());
    }
  }
}

double Probabilistic::log_density(const Heard& heard, double rss_dbm) const {
  const auto gaussian = [](double error_db, double sigma_db) {
    return std::exp(-0.5 * error_db * error_db / (sigma_db * sigma_db)) / (sigma_db * std::sqrt(2.0 * std::numbers::pi));
  };
  double density = 0.0;
  if (settings_.histogram) {
    for (std::uint32_t i = 0; i < heard.samples; ++i) {
      density += gaussian(rss_dbm - static_cast<double>(samples_dbm_[heard.first_sample + i]), settings_.sigma_db);
    }
    density /= heard.samples;
  } else {
    density = gaussian(rss_dbm - static_cast<double>(heard.mean_dbm), static_cast<double>(heard.sigma_db));
  }
  return std::log(density + std::exp(settings_.surprise));  // never below surprise: one reading cannot rule a point out
}

void Probabilistic::log_likelihood(const KnownScan& scan, std::span<double> out) const {
  const double surprise = settings_.surprise * static_cast<double>(scan.levels.size());
  for (std::size_t j = 0; j < out.size(); ++j) out[j] = silent_[j] + surprise;
  for (const auto& level : scan.levels) {
    for (std::uint32_t k = first_heard_[level.transmitter]; k < first_heard_[level.transmitter + 1]; ++k) {
      out[heard_[k].point] += log_density(heard_[k], static_cast<double>(level.rss_dbm)) - settings_.surprise -
                              static_cast<double>(heard_[k].log_silent);
    }
  }
}

std::unique_ptr<Locator> Probabilistic::make() const { return std::make_unique<ProbabilisticLocator>(*this); }

}  // namespace wayfuse
