#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "db/access_point_record.hpp"
#include "server/buildings/survey_levels.hpp"
#include "wayfuse/proto/fix.hpp"

namespace wayfuse {

/// Holds what phones hear against what the survey says they should hear where they are, and tells which access points
/// vanished, moved, changed power or are new.
///
/// No position is kept: of a scan only sums remain, an access point. A phone speaks where its position is good (ok, 68 % within
/// 8 m) and readings are fresh (4 s). A phone's own offset is the median of its scan's differences and is taken out. A verdict
/// needs three sessions, so that no phone decides alone; old evidence fades as new comes, by half every 30 scans in which the
/// access point was due. Thread: any; one mutex.
class AccessPointWatch {
 public:
  static constexpr double kFresh_s = 4.0;
  static constexpr double kGoodRadius_m = 8.0;
  static constexpr std::size_t kSessions = 3;     ///< that must agree

  explicit AccessPointWatch(std::shared_ptr<const SurveyLevels> survey) : survey_(std::move(survey)) {}

  /// `session`: any number that tells one session from another.
  void hear(std::uint64_t session, const RssScan& scan, const FusedPosition& position, UnixTime at);
  /// Of all access points there is evidence about, ascending; `before` are the verdicts in force, ascending.
  std::vector<AccessPointRecord> verdicts(const std::vector<AccessPointRecord>& before, UnixTime now) const;
  std::size_t scans() const;

 private:
  /// Weighted places: where, and how widely.
  struct Centre {
    double mass = 0.0, x_m = 0.0, y_m = 0.0, square_m2 = 0.0;
    void add(BuildingPoint point, double weight);
    void fade(double share);
    std::optional<BuildingPoint> point() const;
    double spread_m() const;
  };
  struct Session {
    std::uint64_t id = 0;
    double due = 0.0;            ///< scans in which it was to be heard, by share
    double heard = 0.0;          ///< of those
    double scans = 0.0;          ///< that heard it at all
    double residual_db = 0.0;    ///< sum over `residuals`
    double residuals = 0.0;
  };
  struct Evidence {
    std::vector<Session> sessions;   // newest last
    double due = 0.0;
    double heard = 0.0;              // when due
    double due_strong = 0.0;         // the same where it should be strong
    double heard_strong = 0.0;
    double strangely = 0.0;          // heard well where the survey heard nothing of it
    Centre heard_at;                 // of strong readings
    Centre due_at;                   // where strong readings were due, on the same scans
    std::map<std::int32_t, double> floors;
    std::optional<UnixTime> last_heard;
    Session& of(std::uint64_t session);
    void fade();
  };
  AccessPointRecord judge(Bssid bssid, const Evidence& evidence, const AccessPointRecord* before, UnixTime now) const;
  void judge_known(const Evidence& evidence, const AccessPointRecord* before, AccessPointRecord& verdict) const;
  void judge_new(const Evidence& evidence, AccessPointRecord& verdict) const;

  std::shared_ptr<const SurveyLevels> survey_;
  mutable std::mutex mutex_;
  std::map<Bssid, Evidence> evidence_;
  std::size_t scans_ = 0;
};

}  // namespace wayfuse
