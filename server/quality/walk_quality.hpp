#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "server/pipeline/tracker.hpp"
#include "server/quality/metrics.hpp"
#include "wayfuse/proto/message.hpp"

namespace wayfuse {

/// A walk whose truth is known, as a server stores it: what the phone reported, and where the walker marked to be.
struct RecordedTrack {
  std::vector<SampleBody> evidence;  ///< ascending in time
  std::vector<WayPoint> marks;       ///< ascending in time
};

/// Of all parts of a survey walk, in their order.
RecordedTrack track_of(std::span<const SurveyWalk> parts);

/// Where the walker was: on the straight line between the marks around `time`. Absent outside them and between two floors.
std::optional<Place> truth_at(std::span<const WayPoint> marks, PhoneTime time);

/// One question put to a pipeline on its way along a track.
struct TrackAnswer {
  PhoneTime time;
  std::optional<FusedPosition> position;
};

/// Feeds a fresh tracker and asks it at every given time, after all evidence up to then. `times` ascend. Causal: evidence after
/// a question never changes its answer.
std::vector<TrackAnswer> replay(const TrackerFactory& pipeline, const RecordedTrack& track, std::span<const PhoneTime> times,
                                Random random, const std::optional<KnownStart>& start = {});

/// How good the answers on one or more tracks were, and how honest their circles.
struct TrackQuality {
  std::size_t asked = 0;
  ErrorSummary error_m;    ///< horizontal, where truth is known and an answer was there
  double floor_hit = 0.0;  ///< share of the answers
  double in68 = 0.0;       ///< share of the answers whose 68 % circle holds the truth
  double in95 = 0.0;
  std::optional<double> radius_rank_correlation;  ///< of the 68 % radius with the error
};

/// Gathers answers and sums them up.
class QualityGauge {
 public:
  void add(const Place& truth, const std::optional<FusedPosition>& answer);
  TrackQuality read() const;
  /// Of the answers, in the order they came.
  std::span<const double> errors_m() const { return errors_m_; }

 private:
  std::size_t asked_ = 0;
  std::size_t right_floor_ = 0;
  std::size_t inside68_ = 0;
  std::size_t inside95_ = 0;
  std::vector<double> errors_m_;
  std::vector<double> radii_m_;
};

/// The same, with every single error.
QualityGauge gauge_walk(const TrackerFactory& pipeline, const RecordedTrack& track, Random random);
/// The server's own check: a stored walk under one pipeline, asked at every scan's arrival and every mark.
TrackQuality check_walk(const TrackerFactory& pipeline, const RecordedTrack& track, Random random);

}  // namespace wayfuse
