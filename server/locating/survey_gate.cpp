#include "server/locating/survey_gate.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <unordered_map>

namespace wayfuse {
namespace {

constexpr double kAgree_m = 15.0;            // witnesses against a point stand this near to each other
constexpr std::size_t kFewestRadios = 4;     // a point that heard less cannot be judged
constexpr std::size_t kFewestOfWalk = 3;     // judged points before a walk is judged as a whole
constexpr double kPaceGap_s = 30.0;          // farther apart in time nobody can tell how it was walked
constexpr double kLeastGap_s = 0.2;

struct Level {
  std::uint32_t radio;
  float strength;
};

/// A survey point as the gate sees it.
struct Witness {
  std::size_t point = 0;
  std::uint32_t walk = 0;                    // standing points: one of their own
  Place place;
  std::vector<Level> heard;
  float sum = 0.0f;
  bool believed = true;
};

struct Walk {
  bool named = false;                        // false: a standing point, judged alone
  std::vector<std::size_t> witnesses;
  bool misplaced = false;
};

/// The likest point of a walk.
struct Best {
  float distance = 2.0f;
  Place place;
};

/// What the others say about a point, in Sorensen distance.
struct Verdict {
  float near = 2.0f;                         // of the likest around its place; 2: nobody is near
  float likest = 2.0f;                       // of the likest far off
  float elsewhere = 2.0f;                    // of the second walk there that says the same
  Place heard_at;
  bool judged = false;

  bool alone() const { return near > 1.5f; }
};

class Gate {
 public:
  Gate(std::span<const ReferencePoint> survey, const SurveyGateSettings& settings) : survey_(survey), settings_(settings) {
    hear();
    index();
  }

  std::vector<SurveyDoubt> doubts() {
    check_pace();
    for (std::size_t w = 0; w < witnesses_.size(); ++w) verdicts_.push_back(judge(w));
    find_usual();
    // Who is doubted bears no witness: those it spoke against, and itself, are heard again without it.
    const auto accused = accuse();
    for (const std::size_t w : accused) witnesses_[w].believed = false;
    for (const std::size_t w : accused) verdicts_[w] = judge(w);
    for (const std::size_t w : accused) witnesses_[w].believed = true;
    for (const std::size_t w : accuse()) {
      const Place place = witnesses_[w].place;
      const Verdict& verdict = verdicts_[w];
      const double off_m = place.floor == verdict.heard_at.floor ? distance_m(place.point, verdict.heard_at.point)
                                                                 : std::numeric_limits<double>::infinity();
      add({witnesses_[w].point, walks_[witnesses_[w].walk].misplaced ? SurveyDoubt::Cause::kWalk : SurveyDoubt::Cause::kRadio, verdict.heard_at, off_m,
           excess(verdict)});
    }
    std::ranges::sort(found_, {}, &SurveyDoubt::point);
    return std::move(found_);
  }

 private:
  void add(const SurveyDoubt& doubt) {
    if (std::ranges::find(found_, doubt.point, &SurveyDoubt::point) == found_.end()) found_.push_back(doubt);
  }

  void hear() {
    std::map<std::string, std::uint32_t> walks;
    std::unordered_map<std::uint64_t, std::uint32_t> radios;
    for (std::size_t p = 0; p < survey_.size(); ++p) {
      const ReferencePoint& point = survey_[p];
      if (!std::isfinite(point.place.point.x_m) || !std::isfinite(point.place.point.y_m)) continue;
      Witness witness{p, 0, point.place, {}, 0.0f, true};
      std::map<std::uint32_t, std::pair<double, int>> levels;
      for (const RssScan& scan : point.scans) {
        for (const ScanReading& reading : scan.readings) {
          const double age_s = seconds(reading.age);
          if (!std::isfinite(reading.rss_dbm) || age_s < 0.0 || age_s > settings_.strength.most_age_s) continue;
          const auto radio = radios.try_emplace(RadioNames::key(reading), static_cast<std::uint32_t>(radios.size())).first->second;
          levels[radio].first += reading.rss_dbm;
          levels[radio].second++;
        }
      }
      for (const auto& [radio, level] : levels) {
        const float strength = settings_.strength.of(std::min(0.0, level.first / level.second), 0.0);
        if (strength <= 0.0f) continue;
        witness.heard.push_back({radio, strength});
        witness.sum += strength;
      }
      if (witness.heard.size() < kFewestRadios) continue;
      const auto next = static_cast<std::uint32_t>(walks_.size());
      witness.walk = point.walk.empty() ? next : walks.try_emplace(point.walk, next).first->second;
      if (witness.walk == next) walks_.push_back({!point.walk.empty(), {}, false});
      walks_[witness.walk].witnesses.push_back(witnesses_.size());
      witnesses_.push_back(std::move(witness));
    }
    postings_.resize(radios.size());
  }

  void index() {
    for (std::uint32_t w = 0; w < witnesses_.size(); ++w) {
      for (const Level& level : witnesses_[w].heard) postings_[level.radio].push_back({w, level.strength});
    }
    common_.resize(witnesses_.size());
    far_.resize(walks_.size());
  }

  Verdict judge(std::size_t at) {
    const Witness& self = witnesses_[at];
    if (witnesses_.size() < 2) return {};
    std::ranges::fill(common_, 0.0f);
    for (const Level& level : self.heard) {
      for (const Level& posting : postings_[level.radio]) common_[posting.radio] += std::min(level.strength, posting.strength);
    }
    std::ranges::fill(far_, Best{});           // the best of each other walk
    float nearest = 2.0f;
    for (std::uint32_t w = 0; w < witnesses_.size(); ++w) {
      const Witness& other = witnesses_[w];
      if (other.walk == self.walk || !other.believed) continue;
      const float distance = 1.0f - 2.0f * common_[w] / (self.sum + other.sum);
      const bool here = other.place.floor == self.place.floor;
      const double metres = here ? distance_m(other.place.point, self.place.point) : settings_.far_m;
      if (here && metres <= settings_.near_m) nearest = std::min(nearest, distance);
      if (metres < settings_.far_m || common_[w] == 0.0f) continue;
      Best& best = far_[other.walk];
      if (distance < best.distance) best = {distance, other.place};
    }
    const Best* first = &*std::ranges::min_element(far_, {}, &Best::distance);
    if (first->distance > 1.0f) return {};
    // A second walk must say the same: one alone may itself be out of place.
    float second = 2.0f;
    for (const Best& best : far_) {
      const bool agrees = &best != first && best.place.floor == first->place.floor &&
                          distance_m(best.place.point, first->place.point) <= kAgree_m;
      if (agrees) second = std::min(second, best.distance);
    }
    return {nearest, first->distance, second, first->place, true};
  }

  // How well points fit around their own places, of those that fit nowhere better: misplaced ones have no say in it.
  void find_usual() {
    std::vector<float> distances;
    for (const Verdict& verdict : verdicts_) {
      if (verdict.judged && !verdict.alone() && verdict.near <= verdict.likest) distances.push_back(verdict.near);
    }
    if (distances.empty()) return;
    const auto at = distances.begin() + static_cast<std::ptrdiff_t>(settings_.alike * static_cast<double>(distances.size() - 1));
    std::ranges::nth_element(distances, at);
    usual_ = std::max(*at, static_cast<float>(settings_.twin));
  }

  /// By how much a point fits worse around its place than elsewhere; negative: nothing speaks against it.
  double excess(const Verdict& verdict) const {
    const auto elsewhere = static_cast<double>(verdict.elsewhere);
    if (!verdict.judged || verdict.likest > usual_) return -1.0;
    if (verdict.alone()) return elsewhere <= settings_.twin ? settings_.margin : -1.0;
    return static_cast<double>(verdict.near) - elsewhere;
  }

  bool out_of_place(const Walk& walk) const {
    std::vector<double> excesses;
    for (const std::size_t w : walk.witnesses) {
      if (verdicts_[w].judged) excesses.push_back(excess(verdicts_[w]));
    }
    if (!walk.named || excesses.size() < kFewestOfWalk) return false;
    const auto middle = excesses.begin() + static_cast<std::ptrdiff_t>(excesses.size() / 2);
    std::ranges::nth_element(excesses, middle);
    return *middle > settings_.walk_margin;
  }

  std::vector<std::size_t> accuse() {
    for (Walk& walk : walks_) walk.misplaced = out_of_place(walk);
    std::vector<std::size_t> accused;
    for (std::size_t w = 0; w < witnesses_.size(); ++w) {
      const bool alone = excess(verdicts_[w]) >= settings_.margin;
      if (alone || walks_[witnesses_[w].walk].misplaced) accused.push_back(w);
    }
    return accused;
  }

  // A point that its neighbours in time could not have walked to, while they fit each other.
  void check_pace() {
    struct Mark {
      double time_s;
      std::size_t point;
    };
    std::map<std::string, std::vector<Mark>> walks;
    for (std::size_t p = 0; p < survey_.size(); ++p) {
      const ReferencePoint& point = survey_[p];
      if (point.walk.empty() || point.scans.empty() || !std::isfinite(point.place.point.x_m) || !std::isfinite(point.place.point.y_m)) continue;
      const RssScan& scan = point.scans.front();
      Duration oldest{0};
      for (const ScanReading& reading : scan.readings) oldest = std::max(oldest, reading.age);
      walks[point.walk].push_back({seconds((scan.time - oldest / 2).time_since_epoch()), p});  // a surveyor places a scan by its middle
    }
    const auto place = [&](const Mark& mark) { return survey_[mark.point].place; };
    const auto too_fast = [&](const Mark& a, const Mark& b) {
      const double gap_s = b.time_s - a.time_s;
      if (gap_s > kPaceGap_s) return false;
      if (place(a).floor != place(b).floor) return true;
      return distance_m(place(a).point, place(b).point) > settings_.fastest_mps * std::max(gap_s, kLeastGap_s) + settings_.near_m;
    };
    for (auto& [_, marks] : walks) {
      std::ranges::stable_sort(marks, {}, &Mark::time_s);
      for (std::size_t i = 1; i + 1 < marks.size(); ++i) {
        const Mark &a = marks[i - 1], &b = marks[i], &c = marks[i + 1];
        if (!too_fast(a, b) || !too_fast(b, c) || too_fast(a, c)) continue;
        const BuildingPoint between{(place(a).point.x_m + place(c).point.x_m) / 2, (place(a).point.y_m + place(c).point.y_m) / 2};
        const bool here = place(a).floor == place(b).floor;
        add({b.point, SurveyDoubt::Cause::kPace, {between, place(a).floor},
             here ? distance_m(between, place(b).point) : std::numeric_limits<double>::infinity(), 0.0});
        for (Witness& witness : witnesses_) {
          if (witness.point == b.point) witness.believed = false;
        }
      }
    }
  }

  std::span<const ReferencePoint> survey_;
  SurveyGateSettings settings_;
  std::vector<Witness> witnesses_;
  std::vector<std::vector<Level>> postings_;   // a radio; `radio` of a posting is the witness
  std::vector<float> common_;
  std::vector<Verdict> verdicts_;
  float usual_ = 2.0f;                         // distance of a point to the likest around its place
  std::vector<Walk> walks_;
  std::vector<Best> far_;                      // scratch, a walk
  std::vector<SurveyDoubt> found_;
};

}  // namespace

std::vector<SurveyDoubt> doubtful_points(std::span<const ReferencePoint> survey, const SurveyGateSettings& settings) {
  return Gate(survey, settings).doubts();
}

std::string to_string(SurveyDoubt::Cause cause) {
  switch (cause) {
    case SurveyDoubt::Cause::kRadio: return "radio";
    case SurveyDoubt::Cause::kWalk: return "walk";
    case SurveyDoubt::Cause::kPace: return "pace";
  }
  return "";
}

std::string to_string(const SurveyDoubt& doubt) {
  char where[96];
  if (std::isfinite(doubt.off_m)) {
    std::snprintf(where, sizeof where, "%.0f m away at (%.1f, %.1f)", doubt.off_m, doubt.heard_at.point.x_m, doubt.heard_at.point.y_m);
  } else {
    std::snprintf(where, sizeof where, "on floor %d at (%.1f, %.1f)", doubt.heard_at.floor.value, doubt.heard_at.point.x_m,
                  doubt.heard_at.point.y_m);
  }
  const std::string point = "point " + std::to_string(doubt.point) + ": ";
  switch (doubt.cause) {
    case SurveyDoubt::Cause::kRadio: return point + "what it heard is heard " + where + " and not around its place";
    case SurveyDoubt::Cause::kWalk: return point + "its whole walk heard what is heard elsewhere; it itself " + where;
    case SurveyDoubt::Cause::kPace: return point + "nobody could have walked there: before and after the surveyor was " + where;
  }
  return point;
}

}  // namespace wayfuse
