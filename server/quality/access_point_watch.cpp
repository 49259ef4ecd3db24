#include "server/quality/access_point_watch.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "server/quality/metrics.hpp"

namespace wayfuse {
namespace {

constexpr double kDue = 0.5;               // share of the points around that heard it: then a scan should, too
constexpr double kStrong_dbm = -75.0;
constexpr std::size_t kForOffset = 5;      // differences a scan must have for its median to be the phone's offset
constexpr double kAudible_dbm = -80.0;     // fainter than this a phone hears by luck
constexpr double kOtherPlace_db = 10.0;    // this much fainter than due, where it should be strong, is not being there
constexpr double kStrange_db = 20.0;       // this much louder is being somewhere else
constexpr double kDueEnough = 12.0;
constexpr double kVanishedShare = 0.05;    // heard less often than this share of what was due
constexpr double kMissedShare = 0.4;
constexpr double kBackShare = 0.5;
constexpr double kStrongEnough = 6.0;
constexpr double kStrangeEnough = 5.0;
constexpr double kMoved_m = 15.0;
constexpr double kPower_db = 7.0;
constexpr double kSessionsAgree = 0.8;
constexpr double kReadingsASession = 4.0;
constexpr double kNewScans = 6.0;
constexpr double kNewSpread_m = 20.0;
constexpr double kFadeAt = 60.0;           // due scans; then everything counts half
constexpr std::size_t kSessionsKept = 8;
constexpr std::size_t kStrangersMost = 4096;

using Heard = std::map<Bssid, double>;

/// The median difference to the survey, over what is strong there: of the faint only the lucky readings are heard.
std::optional<double> offset_db_of(const std::vector<SurveyLevels::Expectation>& expected, const Heard& heard) {
  std::vector<double> strong, all;
  for (const auto& each : expected) {
    const auto found = heard.find(each.bssid);
    if (found == heard.end()) continue;
    all.push_back(found->second - each.rss_dbm);
    if (each.rss_dbm >= kStrong_dbm) strong.push_back(all.back());
  }
  if (all.size() < kForOffset) return std::nullopt;
  return percentile(strong.size() >= kForOffset ? std::move(strong) : std::move(all), 0.5);
}

double weight_of(double rss_dbm) { return std::pow(10.0, (rss_dbm + 60.0) / 20.0); }

std::string words(const char* form, double a, double b, double c = 0.0) {
  char text[240];
  std::snprintf(text, sizeof text, form, a, b, c);
  return text;
}

}  // namespace

void AccessPointWatch::Centre::add(BuildingPoint point, double weight) {
  mass += weight;
  x_m += weight * point.x_m;
  y_m += weight * point.y_m;
  square_m2 += weight * (point.x_m * point.x_m + point.y_m * point.y_m);
}
void AccessPointWatch::Centre::fade(double share) { mass *= share, x_m *= share, y_m *= share, square_m2 *= share; }
std::optional<BuildingPoint> AccessPointWatch::Centre::point() const {
  if (mass <= 0.0) return std::nullopt;
  return BuildingPoint{x_m / mass, y_m / mass};
}
double AccessPointWatch::Centre::spread_m() const {
  const auto centre = point();
  if (!centre) return 0.0;
  return std::sqrt(std::max(0.0, square_m2 / mass - centre->x_m * centre->x_m - centre->y_m * centre->y_m));
}

AccessPointWatch::Session& AccessPointWatch::Evidence::of(std::uint64_t session) {
  const auto found = std::ranges::find(sessions, session, &Session::id);
  if (found != sessions.end()) return *found;
  if (sessions.size() == kSessionsKept) sessions.erase(sessions.begin());
  sessions.push_back({.id = session});
  return sessions.back();
}

void AccessPointWatch::Evidence::fade() {
  if (due < kFadeAt) return;
  for (double* sum : {&due, &heard, &due_strong, &heard_strong, &strangely}) *sum *= 0.5;
  heard_at.fade(0.5);
  due_at.fade(0.5);
}

void AccessPointWatch::hear(std::uint64_t session, const RssScan& scan, const FusedPosition& position, UnixTime at) {
  if (position.integrity != Integrity::kOk || position.radius68_m > kGoodRadius_m) return;
  const auto expected = survey_->expect(position.place);
  if (expected.empty()) return;
  Heard heard, stale;
  for (const ScanReading& reading : scan.readings) {
    if (std::isfinite(reading.rss_dbm)) (seconds(reading.age) <= kFresh_s ? heard : stale).try_emplace(reading.bssid, reading.rss_dbm);
  }
  const auto offset = offset_db_of(expected, heard);
  if (!offset) return;  // hardly anything fits: this scan says nothing about single access points
  const double offset_db = *offset;
  // What this phone would hardly hear there, or heard a while ago, is no evidence, whether it hears it now or not.
  const auto is_due = [&](const SurveyLevels::Expectation& each) {
    return each.share >= kDue && each.rss_dbm + offset_db >= kAudible_dbm && (heard.contains(each.bssid) || !stale.contains(each.bssid));
  };
  // Phones hand out partial scans: each access point is due as much as the others were heard.
  double due = 0.0, whole = 0.0;
  for (const auto& each : expected) {
    if (!is_due(each)) continue;
    due += each.share;
    whole += heard.contains(each.bssid) ? each.share : 0.0;
  }
  const double completeness = due > 0.0 ? whole / due : 0.0;

  const std::lock_guard lock(mutex_);
  ++scans_;
  for (const auto& each : expected) {
    if (!is_due(each)) continue;
    const auto found = heard.find(each.bssid);
    Evidence& evidence = evidence_[each.bssid];
    Session& of = evidence.of(session);
    const double louder_db = found != heard.end() ? found->second - offset_db - each.rss_dbm : -INFINITY;
    evidence.due += each.share * completeness, of.due += each.share * completeness;
    if (found != heard.end()) evidence.heard += each.share, of.heard += each.share;
    if (each.rss_dbm >= kStrong_dbm) {
      evidence.due_strong += each.share * completeness;
      if (louder_db > -kOtherPlace_db) evidence.heard_strong += each.share;
    }
    if (found != heard.end()) of.residual_db += louder_db, of.residuals += 1.0;
    if (each.rss_dbm >= kStrong_dbm) evidence.due_at.add(position.place.point, weight_of(each.rss_dbm));
    evidence.fade();
  }
  for (const auto& [bssid, rss_dbm] : heard) {
    // Strangers are many, and a hostile phone can make up any number of them.
    if (evidence_.size() > survey_->transmitters().size() + kStrangersMost && !evidence_.contains(bssid)) continue;
    Evidence& evidence = evidence_[bssid];
    evidence.last_heard = at;
    evidence.of(session).scans += 1.0;
    if (rss_dbm - offset_db < kStrong_dbm) continue;
    evidence.heard_at.add(position.place.point, weight_of(rss_dbm - offset_db));
    evidence.floors[position.place.floor.value] += 1.0;
    const auto known = std::ranges::find(expected, bssid, &SurveyLevels::Expectation::bssid);
    if (known == expected.end() || rss_dbm - offset_db > known->rss_dbm + kStrange_db) evidence.strangely += 1.0;
  }
}

std::vector<AccessPointRecord> AccessPointWatch::verdicts(const std::vector<AccessPointRecord>& before, UnixTime now) const {
  const std::lock_guard lock(mutex_);
  std::vector<AccessPointRecord> found;
  for (const auto& [bssid, evidence] : evidence_) {
    const auto place = std::ranges::lower_bound(before, bssid, {}, &AccessPointRecord::bssid);
    const AccessPointRecord* earlier = place != before.end() && place->bssid == bssid ? &*place : nullptr;
    AccessPointRecord verdict = judge(bssid, evidence, earlier, now);
    // A stranger that passes by is nobody's business.
    if (earlier || survey_->knows(bssid) || verdict.state == AccessPointState::kNew) found.push_back(std::move(verdict));
  }
  return found;
}

std::size_t AccessPointWatch::scans() const {
  const std::lock_guard lock(mutex_);
  return scans_;
}

AccessPointRecord AccessPointWatch::judge(Bssid bssid, const Evidence& evidence, const AccessPointRecord* before, UnixTime now) const {
  AccessPointRecord verdict;
  if (before) verdict = *before;
  verdict.bssid = bssid;
  verdict.last_heard_at = evidence.last_heard;
  verdict.heard_sessions = static_cast<std::uint64_t>(std::ranges::count_if(evidence.sessions, [](const Session& session) { return session.scans > 0.0; }));
  verdict.decided_at = now;
  if (survey_->knows(bssid)) {
    judge_known(evidence, before, verdict);
  } else {
    judge_new(evidence, verdict);
  }
  return verdict;
}

void AccessPointWatch::judge_known(const Evidence& evidence, const AccessPointRecord* before, AccessPointRecord& verdict) const {
  const auto due_sessions = static_cast<std::size_t>(std::ranges::count_if(evidence.sessions, [](const Session& session) { return session.due >= 2.0; }));
  std::vector<double> offsets_db;
  for (const Session& session : evidence.sessions) {
    if (session.residuals >= kReadingsASession) offsets_db.push_back(session.residual_db / session.residuals);
  }
  const double share = evidence.due > 0.0 ? evidence.heard / evidence.due : 1.0;
  const auto heard_at = evidence.heard_at.point(), due_at = evidence.due_at.point();
  if (!offsets_db.empty()) verdict.change_db = percentile(offsets_db, 0.5);
  if (heard_at && due_at) verdict.distance_m = distance_m(*heard_at, *due_at);

  const bool many = evidence.due >= kDueEnough && due_sessions >= kSessions;
  const double strong_share = evidence.due_strong > 0.0 ? evidence.heard_strong / evidence.due_strong : 1.0;
  const bool missed = many && (evidence.due_strong >= kStrongEnough ? strong_share : share) <= kMissedShare;
  const bool elsewhere = evidence.strangely >= kStrangeEnough && verdict.heard_sessions >= kSessions && heard_at &&
                         (!due_at || *verdict.distance_m >= kMoved_m);
  if (missed && elsewhere) {
    verdict.state = AccessPointState::kMoved;
    verdict.reason = words("heard well %.0f times where the survey has nothing of it, %.0f m from where it was due; as strong as due there in %.0f %% of the scans",
                           evidence.strangely, verdict.distance_m.value_or(0.0), 100.0 * strong_share);
    return;
  }
  if (many && share <= kVanishedShare) {
    verdict.state = AccessPointState::kVanished;
    verdict.reason = words("due in %.0f scans of %.0f sessions, heard in %.1f", evidence.due, static_cast<double>(due_sessions), evidence.heard);
    return;
  }
  const auto louder = static_cast<double>(std::ranges::count_if(offsets_db, [](double offset) { return offset > 0.0; }));
  const auto sessions = static_cast<double>(offsets_db.size());
  const bool agree = offsets_db.size() >= kSessions && (louder >= kSessionsAgree * sessions || louder <= (1.0 - kSessionsAgree) * sessions);
  if (agree && std::abs(*verdict.change_db) >= kPower_db) {
    verdict.state = AccessPointState::kPowerChanged;
    verdict.reason = words("%.1f dB from the survey in the median of %.0f sessions, the phones' own offsets taken out", *verdict.change_db, sessions);
    return;
  }
  // What was put aside comes back on evidence of its own, not for want of evidence.
  const bool settled = !before || before->state == AccessPointState::kOk || (evidence.due >= kDueEnough && due_sessions >= kSessions && share >= kBackShare);
  if (!settled) return;
  verdict.state = AccessPointState::kOk;
  verdict.reason = evidence.due >= 1.0 ? words("due in %.0f scans, heard in %.0f", evidence.due, evidence.heard) : "";
}

void AccessPointWatch::judge_new(const Evidence& evidence, AccessPointRecord& verdict) const {
  double scans = 0.0;
  for (const Session& session : evidence.sessions) scans += session.scans;
  const bool stays = evidence.heard_at.mass > 0.0 && evidence.heard_at.spread_m() <= kNewSpread_m && evidence.floors.size() <= 2;
  if (verdict.heard_sessions < kSessions || scans < kNewScans || evidence.strangely < kStrangeEnough || !stays) return;
  verdict.state = AccessPointState::kNew;
  verdict.reason = words("the survey does not know it; heard in %.0f scans of %.0f sessions, always within about %.0f m", scans,
                         static_cast<double>(verdict.heard_sessions), 2.0 * evidence.heard_at.spread_m());
}

}  // namespace wayfuse
