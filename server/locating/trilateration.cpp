#include "server/locating/trilateration.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wayfuse {
namespace {
constexpr double kTeachesFromM = 2.0;    // log10(d) nears 0 at 1 m: a decimetre there would turn the exponent over
constexpr double kLeastRangeSigmaM = 0.3;
}  // namespace

Trilateration::Trilateration(std::shared_ptr<const RadioMap> map, const TrilaterationSettings& settings)
    : map_(std::move(map)), settings_(settings), laws_(fit_path_loss(*map_)) {
  for (const MapPoint& point : map_->points()) {
    const BuildingPoint at = point.place.point;
    Box& box = surveyed_.try_emplace(point.place.floor, Box{at.x_m, at.y_m, at.x_m, at.y_m}).first->second;
    box = {std::min(box.least_x_m, at.x_m), std::min(box.least_y_m, at.y_m), std::max(box.most_x_m, at.x_m), std::max(box.most_y_m, at.y_m)};
  }
}

std::unique_ptr<Locator> Trilateration::make() const { return std::make_unique<TrilaterationLocator>(*this); }

TrilaterationLocator::TrilaterationLocator(const Trilateration& model) : model_(model) {
  for (const auto& law : model.laws()) exponents_.push_back(law ? law->exponent : 0.0);
}

std::optional<Fix> TrilaterationLocator::locate(const RssScan& scan) {
  model_.map().know(scan, scan_);
  std::erase_if(scan_.levels, [&](const auto& level) { return !model_.laws()[level.transmitter]; });
  known_ = static_cast<int>(scan_.levels.size());
  ranges_.clear();
  if (scan_.levels.empty()) return std::nullopt;
  vote_for_floors(scan_.levels, model_.laws(), floors_);
  const FloorOrdinal floor = floors_.front().floor;
  measure(scan, floor);
  const auto point = solve();
  if (!point || !within_reach(*point, floor)) return std::nullopt;
  double squared_m2 = 0.0;
  for (const TransmitterRange& range : ranges_) {
    const double error_m = distance_m(*point, range.transmitter) - range.distance_m;
    squared_m2 += error_m * error_m;
  }
  const double sigma_m = std::max(1.0, std::sqrt(squared_m2 / static_cast<double>(ranges_.size())));
  return Fix{{*point, floor}, sigma_m, known_};
}

// Least squares throws a point kilometres away where levels contradict each other; nobody is there.
bool TrilaterationLocator::within_reach(BuildingPoint point, FloorOrdinal floor) const {
  const auto box = model_.surveyed().find(floor);
  if (box == model_.surveyed().end()) return false;
  const auto& [least_x_m, least_y_m, most_x_m, most_y_m] = box->second;
  const double beyond_m = model_.settings().beyond_m;
  return point.x_m >= least_x_m - beyond_m && point.x_m <= most_x_m + beyond_m && point.y_m >= least_y_m - beyond_m &&
         point.y_m <= most_y_m + beyond_m;
}

void TrilaterationLocator::measure(const RssScan& scan, FloorOrdinal floor) {
  std::ranges::sort(scan_.levels, [](const auto& a, const auto& b) {
    return a.rss_dbm != b.rss_dbm ? a.rss_dbm > b.rss_dbm : a.transmitter < b.transmitter;
  });
  for (const auto& level : scan_.levels) {
    const PathLoss& law = *model_.laws()[level.transmitter];
    if (law.transmitter.floor != floor || ranges_.size() == static_cast<std::size_t>(model_.settings().strongest)) continue;
    const double exponent = exponents_[level.transmitter];
    TransmitterRange range{law.transmitter.point, law.distance_m(static_cast<double>(level.rss_dbm), exponent), 0.0};
    range.sigma_m = std::max(kLeastRangeSigmaM, range.distance_m * std::numbers::ln10 / (10.0 * exponent) * law.sigma_db);
    const Bssid bssid = model_.map().transmitters()[level.transmitter];
    for (const ScanReading& reading : scan.readings) {
      if (reading.bssid != bssid || !reading.range_m || !std::isfinite(*reading.range_m) || *reading.range_m < 0.0) continue;
      range.distance_m = *reading.range_m;
      range.sigma_m = std::max(kLeastRangeSigmaM, reading.range_sigma_m.value_or(2.0));
    }
    ranges_.push_back(range);
  }
}

std::optional<BuildingPoint> TrilaterationLocator::solve() const {
  if (ranges_.size() < 3) return std::nullopt;
  // H X = b with rows 2 (a_i - a_1) and b_i = d_1^2 - d_i^2 + |a_i|^2 - |a_1|^2, about a_1 as origin; X = (H'H)^-1 H'b.
  const TransmitterRange& first = ranges_.front();
  double xx = 0.0, xy = 0.0, yy = 0.0, bx = 0.0, by = 0.0;
  for (const TransmitterRange& range : std::span(ranges_).subspan(1)) {
    const double hx = 2.0 * (range.transmitter.x_m - first.transmitter.x_m);
    const double hy = 2.0 * (range.transmitter.y_m - first.transmitter.y_m);
    const double b = first.distance_m * first.distance_m - range.distance_m * range.distance_m + 0.25 * (hx * hx + hy * hy);
    xx += hx * hx;
    xy += hx * hy;
    yy += hy * hy;
    bx += hx * b;
    by += hy * b;
  }
  const double determinant = xx * yy - xy * xy;
  if (!(determinant > 1e-6 * xx * yy)) return std::nullopt;  // all on one line
  const BuildingPoint point{first.transmitter.x_m + (yy * bx - xy * by) / determinant,
                            first.transmitter.y_m + (xx * by - xy * bx) / determinant};
  if (!std::isfinite(point.x_m) || !std::isfinite(point.y_m)) return std::nullopt;
  return point;
}

void TrilaterationLocator::learn(const RssScan& scan, const Place& fused) {
  if (!model_.settings().online) return;
  for (const ScanReading& reading : scan.readings) {
    if (!usable(reading)) continue;
    const auto index = model_.map().index_of(reading.bssid);
    if (!index || !model_.laws()[*index]) continue;
    const PathLoss& law = *model_.laws()[*index];
    const double d_m = distance_m(fused.point, law.transmitter.point);
    if (law.transmitter.floor != fused.floor || !(d_m > kTeachesFromM)) continue;
    const double exponent = std::clamp((law.at_1m_dbm - reading.rss_dbm) / (10.0 * std::log10(d_m)), kLeastExponent, kMostExponent);
    if (std::abs(exponent - exponents_[*index]) > model_.settings().threshold) exponents_[*index] = exponent;
  }
}

// An exponent that was learnt stays with its transmitter; one that is still the survey's follows the newer survey.
void TrilaterationLocator::inherit(const Locator& older) {
  const auto* other = dynamic_cast<const TrilaterationLocator*>(&older);
  if (!other) return;
  for (std::size_t i = 0; i < exponents_.size(); ++i) {
    const auto index = other->model_.map().index_of(model_.map().transmitters()[i]);
    if (!index || !model_.laws()[i] || !other->model_.laws()[*index]) continue;
    if (other->exponents_[*index] != other->model_.laws()[*index]->exponent) exponents_[i] = other->exponents_[*index];
  }
}

}  // namespace wayfuse
