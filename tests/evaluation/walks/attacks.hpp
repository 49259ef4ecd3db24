#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/buildings/doubtful_point.hpp"
#include "sdk/src/recording/import/recorded_walk.hpp"
#include "tests/evaluation/walks/walk_score.hpp"
#include "wayfuse/proto/message.hpp"

namespace wayfuse {

/// Scored walks to which somebody does something, from `began` on.
struct AttackedWalks {
  std::string attack;                             ///< `fakes`, `replay`, `kidnap`
  std::string kind;                               ///< `unknown`, `elsewhere`, `floor`; `frozen`, `live`; `start`, `mid`
  int fakes = 0;
  double scan_every_s = 0.0;                      ///< to throttled phones; 0 = scans as they came
  std::vector<ScoredWalk> walks;
  std::vector<std::vector<Instant>> instants;     ///< of a kidnapped phone: from the kidnapping on
  std::vector<std::optional<PhoneTime>> began;    ///< the first false scan arrives, or the phone is elsewhere; absent: never
};

/// Where a rogue transmitter's address comes from.
enum class FakeKind : std::uint8_t {
  kUnknown,    ///< nobody's
  kElsewhere,  ///< copied where it is loud on the same floor, at least 40 m from the whole walk
  kFloor,      ///< copied where it is loud on another floor
};
std::string_view name_of(FakeKind kind);

struct FakeSettings {
  int fakes = 1;
  FakeKind kind = FakeKind::kElsewhere;
  double from_s = 8.0;        ///< since the walk's first way point; nothing is false before
  double level_dbm = -35.0;   ///< at the phone, give or take 2 dB: the rogue transmitter walks along or is powerful
};

/// Every scan from `from_s` on also hears `fakes` rogue transmitters, loud and fresh; a copy drowns its original.
/// Copied addresses are those of different radios that the survey heard above -60 dBm.
AttackedWalks with_fakes(const ScoredData& data, std::span<const RecordedWalk> survey, const FakeSettings& settings);

/// From `from_s` on the radio hears what another scored walk heard at least 40 m away or on another floor: one scan for ever
/// (`frozen`), or its scans one after the other (`live`, a relay).
AttackedWalks with_replay(const ScoredData& data, bool live, double from_s);

/// A phone is tracked on one walk, is dead for two seconds and goes on elsewhere: after 20 s at the beginning of another walk
/// (`start`), or half-way at the other's middle (`mid`). The other walk begins at least 30 m away or on another floor.
AttackedWalks kidnapped(const ScoredData& data, bool mid);
/// The same from where they were carried to on, in their order: phones switched on there, which know of no earlier walk.
std::vector<ScoredWalk> switched_on(const AttackedWalks& kidnapped);

/// Where phones are at the last instant within 15 s of being carried off, or switched on.
struct FoundBack {
  std::size_t walks = 0;          ///< that last so long
  double p95_m = 0.0;             ///< of the error, over them
  double within10 = 0.0;          ///< share nearer than 10 m
};

/// What came of an attack on one pipeline, the same instants with and without it.
struct AttackRow {
  std::string pipeline, attack, kind;
  int fakes = 0;
  double scan_every_s = 0.0;
  std::size_t walks = 0;          ///< attacked, with 5 s or more after the first false scan
  std::size_t instants = 0;       ///< from the attack on
  double flagged = 0.0;           ///< share of the walks that were `suspect` at an instant within 5 s
  double p75_m = 0.0, p95_m = 0.0;
  double clean_p75_m = 0.0, clean_p95_m = 0.0;  ///< unattacked; kidnapped: switched on there
  /// Of kidnapped phones, and of those switched on there; by Scope.
  std::array<FoundBack, 2> carried{}, switched_on{};
};
/// `data` and `clean`: the same walks unattacked, found by their ids, and how `run`'s pipeline did on them; of kidnapped phones, those
/// switched on where they were carried to.
AttackRow score_attack(const AttackedWalks& attacked, const PipelineRun& run, const ScoredData& data, const PipelineRun& clean);

/// How often honest walks raise an alarm.
struct AlarmRow {
  std::string pipeline;
  double scan_every_s = 0.0;      ///< of throttled phones; 0 = scans as they came
  double hours = 0.0;             ///< walked
  std::size_t alarms = 0;         ///< times an answer became `suspect`
  double suspect = 0.0;           ///< share of the answers
  double degraded = 0.0;
};
AlarmRow count_alarms(const ScoredData& data, const PipelineRun& run);

/// Surveyors who err: a share of all points, or of all walks, is uploaded with a wrong place.
///
/// A point takes the place of any other point of the survey at least 20 m away or on another floor; a walk is moved as a whole
/// by 30 m into any direction. Deterministic.
class SurveyPoison {
 public:
  SurveyPoison(std::span<const RecordedWalk> survey, double points, double walks, std::uint64_t seed);
  void operator()(std::vector<SurveyBatch>& batches);
  /// Where a point was uploaded to, so far.
  const std::vector<ReferencePoint>& moved() const { return moved_; }
  /// How many of these doubts are about misplaced points.
  std::size_t among(std::span<const DoubtfulPoint> doubts) const;

 private:
  std::vector<Place> places_;
  double points_;
  double walks_;
  std::uint64_t seed_;
  std::vector<ReferencePoint> moved_;              // without their scans
};

/// A poisoned map beside the clean one.
struct PoisonRow {
  std::string pipeline;
  double points = 0.0, walks = 0.0;  ///< shares asked for
  bool gate = true;
  std::size_t misplaced = 0;         ///< points that were
  std::size_t doubted = 0;           ///< points the gate took out
  std::size_t doubted_rightly = 0;   ///< of the misplaced
  double p75_m = 0.0, p95_m = 0.0, mean_m = 0.0;  ///< ALL
};

}  // namespace wayfuse
