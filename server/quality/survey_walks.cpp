#include "server/quality/survey_walks.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace wayfuse {
namespace {

constexpr double kCompassRad = 8.0 * std::numbers::pi / 180.0;
constexpr double kStride = 0.04;
constexpr double kReportS = 0.5;
constexpr double kLongestGapS = 15.0;    // between two points of a walk: across more nobody knows the way
constexpr double kStill_m = 0.05;
constexpr double kStandingScanS = 3.0;

// A point's readings were heard around its place: half way between the newest and the oldest.
PhoneTime time_at(const RssScan& scan) {
  Duration oldest{0};
  for (const ScanReading& reading : scan.readings) oldest = std::max(oldest, reading.age);
  return scan.time - oldest / 2;
}

/// The steps of a walker from mark to mark, with one compass error and one stride error a walk.
class Steps {
 public:
  Steps(const Site& site, std::uint64_t seed) : site_(site) {
    Random random(seed);
    compass_rad_ = kCompassRad * random.normal();
    stride_ = 1.0 + kStride * random.normal();
  }

  void add(const WayPoint& from, const WayPoint& to, std::vector<SampleBody>& evidence) const {
    const double gap_s = seconds(to.time - from.time);
    if (gap_s <= 0.0 || gap_s > kLongestGapS || from.place.floor != to.place.floor) return;
    const int reports = std::max(1, static_cast<int>(std::ceil(gap_s / kReportS)));
    const double dx = to.place.point.x_m - from.place.point.x_m, dy = to.place.point.y_m - from.place.point.y_m;
    const double each_m = std::hypot(dx, dy) / reports;
    const Duration interval = (to.time - from.time) / reports;
    for (int i = 1; i <= reports; ++i) {
      MotionReport report;
      report.time = from.time + interval * i;
      report.interval = interval;
      report.heading = true_heading(Heading::from_vector(dx, dy)).turned_by(compass_rad_);
      report.heading_sigma_rad = kCompassRad;
      report.reference = HeadingReference::kTrue;
      report.at_rest = each_m < kStill_m;
      if (!report.at_rest) {
        report.steps = 1;
        report.step_length_m = std::min(3.0, each_m * stride_);
        report.distance_sigma_m = 0.1 * each_m;
      }
      evidence.emplace_back(report);
    }
  }

 private:
  Heading true_heading(Heading building) const { return site_.georeference ? site_.georeference->to_true(building) : building; }

  const Site& site_;
  double compass_rad_ = 0.0;
  double stride_ = 1.0;
};

void order(RecordedTrack& track) {
  const auto time = [](const SampleBody& body) { return std::visit([](const auto& sample) { return sample.time; }, body); };
  std::ranges::stable_sort(track.evidence, [&](const SampleBody& a, const SampleBody& b) {
    return time(a) != time(b) ? time(a) < time(b) : a.index() < b.index();
  });
}

void lay_walk(const Site& site, SurveyedTrack& walk) {
  for (const std::size_t index : walk.points) {
    const ReferencePoint& point = site.survey[index];
    for (const RssScan& scan : point.scans) {
      walk.track.marks.push_back({time_at(scan), point.place, point.sigma_m});
      walk.track.evidence.emplace_back(scan);
    }
  }
  std::ranges::stable_sort(walk.track.marks, {}, &WayPoint::time);
  const auto repeated = std::ranges::unique(walk.track.marks, {}, &WayPoint::time);
  walk.track.marks.erase(repeated.begin(), repeated.end());
  const Steps steps(site, walk.points.front());
  for (std::size_t i = 1; i < walk.track.marks.size(); ++i) steps.add(walk.track.marks[i - 1], walk.track.marks[i], walk.track.evidence);
  order(walk.track);
  for (const WayPoint& mark : walk.track.marks) walk.ask_at.push_back(mark.time);
}

// A phone held still there: its scans one after the other, asked at the end.
void lay_standing(const Site& site, SurveyedTrack& standing) {
  const ReferencePoint& point = site.survey[standing.points.front()];
  PhoneTime time{};
  for (RssScan scan : point.scans) {
    scan.time = time;
    standing.track.evidence.emplace_back(std::move(scan));
    time += from_seconds(kStandingScanS);
  }
  standing.track.marks = {{PhoneTime{}, point.place, point.sigma_m}, {time, point.place, point.sigma_m}};
  standing.ask_at = {time};
}

}  // namespace

std::vector<SurveyedTrack> tracks_of_survey(const Site& site) {
  std::map<std::string, std::vector<std::size_t>> walks;
  std::vector<SurveyedTrack> tracks;
  for (std::size_t i = 0; i < site.survey.size(); ++i) {
    if (!site.survey[i].walk.empty()) {
      walks[site.survey[i].walk].push_back(i);
      continue;
    }
    SurveyedTrack standing{{}, {i}, {}, {}};
    lay_standing(site, standing);
    tracks.push_back(std::move(standing));
  }
  for (auto& [name, points] : walks) {
    SurveyedTrack walk{name, std::move(points), {}, {}};
    lay_walk(site, walk);
    tracks.push_back(std::move(walk));
  }
  return tracks;
}

}  // namespace wayfuse
