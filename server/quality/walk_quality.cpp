#include "server/quality/walk_quality.hpp"

#include <algorithm>
#include <limits>

namespace wayfuse {
namespace {

PhoneTime time_of_evidence(const SampleBody& body) {
  return std::visit([](const auto& sample) { return sample.time; }, body);
}

// At equal times motion comes before scans before satellites: a scan is weighed where the walker stands.
bool earlier(const SampleBody& a, const SampleBody& b) {
  const PhoneTime at = time_of_evidence(a), bt = time_of_evidence(b);
  return at != bt ? at < bt : a.index() < b.index();
}

}  // namespace

RecordedTrack track_of(std::span<const SurveyWalk> parts) {
  RecordedTrack track;
  for (const SurveyWalk& part : parts) {
    track.evidence.insert(track.evidence.end(), part.motion.begin(), part.motion.end());
    track.evidence.insert(track.evidence.end(), part.scans.begin(), part.scans.end());
    track.marks.insert(track.marks.end(), part.marks.begin(), part.marks.end());
  }
  std::ranges::stable_sort(track.evidence, earlier);
  std::ranges::stable_sort(track.marks, {}, &WayPoint::time);
  return track;
}

std::optional<Place> truth_at(std::span<const WayPoint> marks, PhoneTime time) {
  if (marks.empty() || time < marks.front().time || time > marks.back().time) return std::nullopt;
  const auto after = std::ranges::lower_bound(marks, time, {}, &WayPoint::time);
  if (after->time == time) return after->place;
  const WayPoint& before = *(after - 1);
  if (before.place.floor != after->place.floor) return std::nullopt;
  const double share = seconds(time - before.time) / seconds(after->time - before.time);
  const BuildingPoint a = before.place.point, b = after->place.point;
  return Place{{a.x_m + share * (b.x_m - a.x_m), a.y_m + share * (b.y_m - a.y_m)}, before.place.floor};
}

std::vector<TrackAnswer> replay(const TrackerFactory& pipeline, const RecordedTrack& track, std::span<const PhoneTime> times,
                                Random random, const std::optional<KnownStart>& start) {
  const std::unique_ptr<Tracker> tracker = pipeline.make_tracker(random, start);
  std::vector<TrackAnswer> answers;
  auto next = track.evidence.begin();
  for (const PhoneTime time : times) {
    for (; next != track.evidence.end() && time_of_evidence(*next) <= time; ++next) {
      std::visit([&](const auto& sample) { tracker->feed(sample); }, *next);
    }
    answers.push_back({time, tracker->position(time)});
  }
  return answers;
}

void QualityGauge::add(const Place& truth, const std::optional<FusedPosition>& answer) {
  ++asked_;
  if (!answer) return;
  const double error_m = distance_m(answer->place.point, truth.point);
  errors_m_.push_back(error_m);
  radii_m_.push_back(answer->radius68_m);
  right_floor_ += answer->place.floor == truth.floor;
  inside68_ += error_m <= answer->radius68_m;
  inside95_ += error_m <= answer->radius95_m;
}

TrackQuality QualityGauge::read() const {
  const auto share = [&](std::size_t count) {
    return errors_m_.empty() ? std::numeric_limits<double>::quiet_NaN()
                             : static_cast<double>(count) / static_cast<double>(errors_m_.size());
  };
  return {asked_,           summarise(errors_m_), share(right_floor_),
          share(inside68_), share(inside95_),     rank_correlation(radii_m_, errors_m_)};
}

QualityGauge gauge_walk(const TrackerFactory& pipeline, const RecordedTrack& track, Random random) {
  std::vector<PhoneTime> times;
  for (const SampleBody& body : track.evidence) {
    if (std::holds_alternative<RssScan>(body)) times.push_back(time_of_evidence(body));
  }
  for (const WayPoint& mark : track.marks) times.push_back(mark.time);
  std::ranges::sort(times);
  const auto repeated = std::ranges::unique(times);
  times.erase(repeated.begin(), repeated.end());
  QualityGauge gauge;
  for (const TrackAnswer& answer : replay(pipeline, track, times, random)) {
    if (const auto truth = truth_at(track.marks, answer.time)) gauge.add(*truth, answer.position);
  }
  return gauge;
}

TrackQuality check_walk(const TrackerFactory& pipeline, const RecordedTrack& track, Random random) {
  return gauge_walk(pipeline, track, random).read();
}

}  // namespace wayfuse
