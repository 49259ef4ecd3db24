#include "wayfuse/sdk/surveyor.hpp"

#include <algorithm>

#include "wayfuse/proto/codec.hpp"

namespace wayfuse {
namespace {

// Readings heard within this share one place, and so one fingerprint: a radio takes up to 1.8 s to go through its channels,
// and a fingerprint cut into its channels matches nothing. A walker is within a metre of the middle.
constexpr Duration kTogether = std::chrono::seconds(2);
constexpr Duration kSameReading =
    std::chrono::milliseconds(10);              // phones hand the same reading out again, its age rounded anew
constexpr std::size_t kBatchBytes = 60 * 1024;  // of points, as JSON; the rest of a frame is for key and wrapping

Fault misused(const char* cause) {
  return {FaultCode::kUnexpectedMessage, "walk", cause};
}

std::size_t json_bytes(const ReferencePoint& point) {
  return encode(ClientMessage(SurveyBatch{"k", {point}}), Encoding::kJson).size();
}

}  // namespace

/// Where the walker was, and how well that is known.
struct Surveyor::Spot {
  Place place;
  double sigma_m = 0.0;
};

Surveyor::Surveyor(std::string device_model, Random random) : device_model_(std::move(device_model)), random_(random) {}

Result<void> Surveyor::add_point(Place place, double sigma_m, std::vector<RssScan> scans, UnixTime at) {
  ReferencePoint point{place, sigma_m, device_model_, {}, at, std::move(scans)};
  if (auto checked = check(point, "point"); !checked) return checked;
  keep(std::move(point));
  return {};
}

Result<void> Surveyor::begin_walk(std::string name) {
  if (walking_) return misused("the walk before has not ended");
  if (name.empty()) return Fault{FaultCode::kMissingField, "walk", "a walk needs a name"};
  walking_ = true;
  walk_ = std::move(name);
  marks_.clear();
  scans_.clear();
  return {};
}

Result<void> Surveyor::mark(PhoneTime time, Place place, double sigma_m) {
  if (!walking_) return misused("no walk has begun");
  if (!marks_.empty() && time <= marks_.back().time)
    return Fault{FaultCode::kOutOfRange, "mark.time", "not after the mark before"};
  const ReferencePoint probe{place, sigma_m, device_model_, walk_, UnixTime{}, {RssScan{time, {ScanReading{}}}}};
  if (auto checked = check(probe, "mark"); !checked) return checked;
  marks_.push_back({time, place, sigma_m});
  return {};
}

Result<void> Surveyor::scan(const RssScan& scan, UnixTime at) {
  if (!walking_) return misused("no walk has begun");
  if (auto checked = check(scan, "scan"); !checked) return checked;
  scans_.emplace_back(scan, at);
  return {};
}

Result<void> Surveyor::end_walk() {
  if (!walking_) return misused("no walk has begun");
  if (marks_.size() < 2) return misused("a walk needs two marks at least");
  walking_ = false;
  heard_.clear();
  for (const auto& [scan, at] : scans_) place_scan(scan, at);
  scans_.clear();
  return {};
}

std::optional<Surveyor::Spot> Surveyor::where(PhoneTime time) const {
  if (time < marks_.front().time || time > marks_.back().time) return std::nullopt;
  const auto next = std::upper_bound(marks_.begin() + 1, marks_.end() - 1, time,
                                     [](PhoneTime sought, const Mark& mark) { return sought < mark.time; });
  const Mark& b = *next;
  const Mark& a = *(next - 1);
  if (a.place.floor != b.place.floor) return std::nullopt;
  const double part = seconds(time - a.time) / seconds(b.time - a.time);
  const BuildingPoint point{a.place.point.x_m + part * (b.place.point.x_m - a.place.point.x_m),
                            a.place.point.y_m + part * (b.place.point.y_m - a.place.point.y_m)};
  return Spot{{point, a.place.floor}, std::max(a.sigma_m, b.sigma_m)};
}

// One point for every group of readings heard together; inside it the scan's time is when the newest of them was heard.
void Surveyor::place_scan(const RssScan& scan, UnixTime at) {
  std::vector<ScanReading> readings;
  for (const ScanReading& reading : scan.readings) {
    const PhoneTime heard = scan.time - reading.age;
    const auto [last, first_time] = heard_.try_emplace(reading.bssid, heard);
    if (!first_time && heard <= last->second + kSameReading) continue;
    last->second = heard;
    readings.push_back(reading);
  }
  std::stable_sort(readings.begin(), readings.end(), [](const auto& a, const auto& b) { return a.age < b.age; });
  for (std::size_t begin = 0, end; begin < readings.size(); begin = end) {
    const Duration newest = readings[begin].age;
    for (end = begin; end < readings.size() && readings[end].age - newest <= kTogether;) ++end;
    const Duration middle = (newest + readings[end - 1].age) / 2;
    const auto spot = where(scan.time - middle);
    if (!spot) {
      left_out_ += end - begin;
      continue;
    }
    RssScan heard{scan.time - newest,
                  {readings.begin() + static_cast<std::ptrdiff_t>(begin), readings.begin() + static_cast<std::ptrdiff_t>(end)}};
    for (ScanReading& reading : heard.readings) reading.age -= newest;
    keep({spot->place, spot->sigma_m, device_model_, walk_, at - newest, {std::move(heard)}});
  }
}

// What no message could carry is halved: first by scans, then by readings. The place stays the same, nothing is dropped.
void Surveyor::keep(ReferencePoint point) {
  const std::size_t bytes = json_bytes(point);
  const bool many_scans = point.scans.size() > 1;
  if (bytes <= kBatchBytes || (!many_scans && point.scans.front().readings.size() < 2)) {
    points_.emplace_back(std::move(point), bytes);
    return;
  }
  ReferencePoint rest = point;
  if (many_scans) {
    const auto half = static_cast<std::ptrdiff_t>(point.scans.size() / 2);
    rest.scans.erase(rest.scans.begin(), rest.scans.begin() + half);
    point.scans.erase(point.scans.begin() + half, point.scans.end());
  } else {
    auto& left = point.scans.front().readings;
    auto& right = rest.scans.front().readings;
    const auto half = static_cast<std::ptrdiff_t>(left.size() / 2);
    right.erase(right.begin(), right.begin() + half);
    left.erase(left.begin() + half, left.end());
  }
  keep(std::move(point));
  keep(std::move(rest));
}

std::string Surveyor::new_key() {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string key;
  for (int word = 0; word < 2; ++word) {
    std::uint64_t bits = random_.bits();
    for (int digit = 0; digit < 16; ++digit, bits >>= 4) key += kDigits[bits & 15];
  }
  return key;
}

std::vector<SurveyBatch> Surveyor::take_batches() {
  std::vector<SurveyBatch> batches;
  std::size_t bytes = 0;
  for (auto& [point, size] : points_) {
    if (batches.empty() || bytes + size > kBatchBytes || batches.back().points.size() == Limits::kPointsPerBatch) {
      batches.push_back({new_key(), {}});
      bytes = 0;
    }
    batches.back().points.push_back(std::move(point));
    bytes += size;
  }
  points_.clear();
  return batches;
}

}  // namespace wayfuse
