#include "wayfuse/sdk/surveyor.hpp"

#include <algorithm>
#include <utility>

#include "sdk/src/client/point_batches.hpp"
#include "wayfuse/proto/codec.hpp"

namespace wayfuse {
namespace {

constexpr std::size_t kBatchBytes = 60 * 1024;  // of points, as JSON; the rest of a frame is for key and wrapping

Fault misused(const char* cause) {
  return {FaultCode::kUnexpectedMessage, "walk", cause};
}

/// Cuts a recorded walk into parts, each within the limits of a message.
class WalkCutter {
 public:
  explicit WalkCutter(SurveyWalk head) : head_(std::move(head)), part_(head_) { head_bytes_ = bytes_of(head_); }

  void add(const WayPoint& mark) { keep(mark, part_.marks, &SurveyWalk::marks, Limits::kMarksPerWalkPart); }
  void add(const MotionReport& report) { keep(report, part_.motion, &SurveyWalk::motion, Limits::kMotionPerWalkPart); }
  void add(const RssScan& scan) { keep(scan, part_.scans, &SurveyWalk::scans, Limits::kScansPerWalkPart); }

  std::vector<SurveyWalk> finish() {
    part_.last = true;
    parts_.push_back(std::move(part_));
    return std::move(parts_);
  }

 private:
  static std::size_t bytes_of(const SurveyWalk& walk) { return encode(ClientMessage(walk), Encoding::kJson).size(); }

  template <typename Item>
  void keep(const Item& item, std::vector<Item>& list, std::vector<Item> SurveyWalk::*field, std::size_t most) {
    SurveyWalk alone = head_;
    (alone.*field).push_back(item);
    const std::size_t bytes = bytes_of(alone) - head_bytes_ + 1;  // and a comma
    if (list.size() == most || bytes_ + bytes > kBatchBytes) {
      parts_.push_back(std::move(part_));
      part_ = head_;
      part_.part = static_cast<std::uint32_t>(parts_.size());
      bytes_ = 0;
    }
    list.push_back(item);
    bytes_ += bytes;
  }

  SurveyWalk head_;
  SurveyWalk part_;
  std::size_t head_bytes_ = 0;
  std::size_t bytes_ = 0;
  std::vector<SurveyWalk> parts_;
};

}  // namespace

/// Where the walker was, and how well that is known.
struct Surveyor::Spot {
  Place place;
  double sigma_m = 0.0;
};

Surveyor::Surveyor(std::string device_model, Random random) : device_model_(std::move(device_model)), random_(random) {}

Result<void> Surveyor::add_point(Place place, double sigma_m, std::vector<RssScan> scans, UnixTime at) {
  std::size_t left_out = 0;
  for (RssScan& scan : scans) left_out += keep_youngest(scan, Limits::kReadingsPerScan);
  ReferencePoint point{place, sigma_m, device_model_, {}, at, std::move(scans)};
  if (auto checked = check(point, "point"); !checked) return checked;
  left_out_ += left_out;
  wayfuse::add_point(std::move(point), points_);
  return {};
}

Result<void> Surveyor::begin_walk(std::string name) {
  if (walking_) return misused("the walk before has not ended");
  if (name.empty()) return Fault{FaultCode::kMissingField, "walk", "a walk needs a name"};
  walking_ = true;
  walk_ = std::move(name);
  marks_.clear();
  scans_.clear();
  motion_.clear();
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
  RssScan kept = scan;
  const std::size_t left_out = keep_youngest(kept, Limits::kReadingsPerScan);
  if (auto checked = check(kept, "scan"); !checked) return checked;
  left_out_ += left_out;
  scans_.emplace_back(std::move(kept), at);
  return {};
}

Result<void> Surveyor::end_walk() {
  if (!walking_) return misused("no walk has begun");
  if (marks_.size() < 2) return misused("a walk needs two marks at least");
  walking_ = false;
  splitter_ = {};
  for (const auto& [scan, at] : scans_) place_scan(scan, at);
  scans_.clear();
  return {};
}

Result<void> Surveyor::motion(const MotionReport& report) {
  if (!walking_) return misused("no walk has begun");
  if (auto checked = check(report, "motion"); !checked) return checked;
  motion_.push_back(report);
  return {};
}

Result<std::vector<SurveyWalk>> Surveyor::end_recorded_walk(PhoneTime phone, UnixTime wall) {
  if (!walking_) return misused("no walk has begun");
  if (marks_.size() < 2) return misused("a walk needs two marks at least");
  walking_ = false;
  WalkCutter cutter({{}, walk_, 0, false, device_model_, wall, phone, {}, {}, {}});
  std::stable_sort(motion_.begin(), motion_.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
  std::stable_sort(scans_.begin(), scans_.end(), [](const auto& a, const auto& b) { return a.first.time < b.first.time; });
  auto mark = marks_.begin();
  auto report = motion_.begin();
  auto scan = scans_.begin();
  // In the order of time, so that every part is a piece of the walk.
  while (mark != marks_.end() || report != motion_.end() || scan != scans_.end()) {
    const PhoneTime next_mark = mark != marks_.end() ? mark->time : PhoneTime::max();
    const PhoneTime next_report = report != motion_.end() ? report->time : PhoneTime::max();
    const PhoneTime next_scan = scan != scans_.end() ? scan->first.time : PhoneTime::max();
    if (next_mark <= next_report && next_mark <= next_scan) {
      cutter.add(WayPoint{mark->time, mark->place, mark->sigma_m});
      ++mark;
    } else if (next_report <= next_scan) {
      cutter.add(*report++);
    } else {
      cutter.add((scan++)->first);
    }
  }
  scans_.clear();
  motion_.clear();
  std::vector<SurveyWalk> parts = cutter.finish();
  for (SurveyWalk& part : parts) part.idempotency_key = new_key();
  return parts;
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

// One point for every group of readings heard together.
void Surveyor::place_scan(const RssScan& scan, UnixTime at) {
  for (HeardTogether& heard : splitter_.split(scan)) {
    const auto spot = where(heard.middle);
    if (!spot) {
      left_out_ += heard.scan.readings.size();
      continue;
    }
    const UnixTime heard_at = at - (scan.time - heard.scan.time);
    wayfuse::add_point({spot->place, spot->sigma_m, device_model_, walk_, heard_at, {std::move(heard.scan)}}, points_);
  }
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
  for (auto& points : in_messages(std::exchange(points_, {}))) batches.push_back({new_key(), std::move(points)});
  return batches;
}

}  // namespace wayfuse
