#include "tests/evaluation/walks/walk_score.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

namespace wayfuse {
namespace {

// What one walk's answers come to in a scope.
struct WalkAnswers {
  std::vector<double> errors_m;
  std::vector<double> radii_m;
  std::size_t asked = 0;
  std::size_t right_floor = 0;
  std::size_t inside68 = 0;
  std::size_t inside95 = 0;
};

bool in_scope(const Instant& instant, Scope scope) {
  return scope == Scope::kAll || instant.covered;
}

WalkAnswers gather(std::span<const Instant> instants, const Answers& answers, Scope scope) {
  WalkAnswers walk;
  for (std::size_t i = 0; i < instants.size(); ++i) {
    if (!in_scope(instants[i], scope)) continue;
    ++walk.asked;
    if (!answers[i]) continue;
    const double error_m = distance_m(answers[i]->place.point, instants[i].truth.point);
    walk.errors_m.push_back(error_m);
    walk.radii_m.push_back(answers[i]->radius68_m);
    walk.right_floor += answers[i]->place.floor == instants[i].truth.floor;
    walk.inside68 += error_m <= answers[i]->radius68_m;
    walk.inside95 += error_m <= answers[i]->radius95_m;
  }
  return walk;
}

std::vector<WalkAnswers> gather_all(const ScoredData& data, const PipelineRun& run, Scope scope, const Floor* floor) {
  std::vector<WalkAnswers> walks;
  for (std::size_t w = 0; w < data.walks.size(); ++w) {
    if (floor && data.walks[w].walk.floor != floor->ordinal) continue;
    walks.push_back(gather(data.instants[w], run.walks[w], scope));
  }
  return walks;
}

double share(std::span<const WalkAnswers> walks, std::size_t WalkAnswers::*count) {
  std::size_t counted = 0;
  std::size_t all = 0;
  for (const WalkAnswers& walk : walks) {
    counted += walk.*count;
    all += walk.errors_m.size();
  }
  return all == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(counted) / static_cast<double>(all);
}

Interval share_interval(std::span<const WalkAnswers> walks, std::size_t WalkAnswers::*count, const Random& random) {
  std::vector<GroupSum> groups;
  for (const WalkAnswers& walk : walks) groups.push_back({static_cast<double>(walk.*count), walk.errors_m.size()});
  return bootstrap_mean(groups, random);
}

Interval median_interval(std::span<const WalkAnswers> walks, const Random& random) {
  const auto median = [&](std::span<const std::size_t> drawn) {
    std::vector<double> errors;
    for (const std::size_t w : drawn) errors.insert(errors.end(), walks[w].errors_m.begin(), walks[w].errors_m.end());
    if (errors.empty()) return std::numeric_limits<double>::quiet_NaN();
    const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    return *middle;
  };
  return bootstrap_interval(walks.size(), median, random, 300);
}

}  // namespace

std::string_view name_of(Scope scope) {
  return scope == Scope::kAll ? "ALL" : "COV";
}

std::vector<Instant> instants_of(const RecordedWalk& walk, const SurveyCover& cover) {
  std::vector<PhoneTime> times;
  for (const RssScan& scan : walk.scans) times.push_back(scan.time);
  for (const TruePoint& point : walk.way_points) times.push_back(point.time);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  std::vector<Instant> instants;
  for (const PhoneTime time : times) {
    const auto truth = walk.truth_at(time);
    if (!truth) continue;
    const Place place{*truth, walk.floor};
    instants.push_back({time, place, cover.covers(place), seconds(time - walk.way_points.front().time)});
  }
  return instants;
}

ScoreRow score(const ScoredData& data, const PipelineRun& run, Scope scope, const Floor* floor, std::uint64_t seed) {
  const std::vector<WalkAnswers> walks = gather_all(data, run, scope, floor);
  const Random random(seed);
  ScoreRow row;
  row.pipeline = run.pipeline;
  row.path = run.path;
  row.scope = scope;
  if (floor) row.floor = floor->label;
  row.walks = walks.size();
  std::vector<double> errors;
  std::vector<double> radii;
  std::vector<GroupSum> sums;
  for (const WalkAnswers& walk : walks) {
    row.asked += walk.asked;
    errors.insert(errors.end(), walk.errors_m.begin(), walk.errors_m.end());
    radii.insert(radii.end(), walk.radii_m.begin(), walk.radii_m.end());
    sums.push_back({std::accumulate(walk.errors_m.begin(), walk.errors_m.end(), 0.0), walk.errors_m.size()});
  }
  row.radius_rank_corr = rank_correlation(radii, errors);
  row.error = summarise(errors);
  row.mean_interval = bootstrap_mean(sums, random);
  row.median_interval = median_interval(walks, random);
  row.floor_hit = share(walks, &WalkAnswers::right_floor);
  row.floor_hit_interval = share_interval(walks, &WalkAnswers::right_floor, random);
  row.in68 = share(walks, &WalkAnswers::inside68);
  row.in68_interval = share_interval(walks, &WalkAnswers::inside68, random);
  row.in95 = share(walks, &WalkAnswers::inside95);
  row.in95_interval = share_interval(walks, &WalkAnswers::inside95, random);
  std::vector<double> first;
  for (std::size_t w = 0; w < data.walks.size(); ++w) {
    if (floor && data.walks[w].walk.floor != floor->ordinal) continue;
    // A walk without any fix counts as infinitely late: it may not flatter the median.
    first.push_back(run.first_fix_s[w].value_or(std::numeric_limits<double>::infinity()));
  }
  row.ttff_s = percentile(first, 0.5);
  return row;
}

std::vector<GroupSum> error_sums(const ScoredData& data, const PipelineRun& run, Scope scope) {
  std::vector<GroupSum> sums;
  for (const WalkAnswers& walk : gather_all(data, run, scope, nullptr)) {
    sums.push_back({std::accumulate(walk.errors_m.begin(), walk.errors_m.end(), 0.0), walk.errors_m.size()});
  }
  return sums;
}

std::vector<double> errors_in(const ScoredData& data, const PipelineRun& run, Scope scope) {
  std::vector<double> errors;
  for (const WalkAnswers& walk : gather_all(data, run, scope, nullptr)) {
    errors.insert(errors.end(), walk.errors_m.begin(), walk.errors_m.end());
  }
  return errors;
}

std::vector<TimeBin> score_by_time(const ScoredData& data, const PipelineRun& run, Scope scope, std::uint64_t seed) {
  constexpr std::array<double, 6> kEdges_s = {0.0, 10.0, 30.0, 60.0, 120.0, 1e9};
  std::vector<TimeBin> bins;
  for (std::size_t b = 0; b + 1 < kEdges_s.size(); ++b) {
    std::vector<GroupSum> sums(data.walks.size());
    TimeBin bin{kEdges_s[b], kEdges_s[b + 1], 0, 0.0, {}};
    double total_m = 0.0;
    for (std::size_t w = 0; w < data.walks.size(); ++w) {
      for (std::size_t i = 0; i < data.instants[w].size(); ++i) {
        const Instant& instant = data.instants[w][i];
        const auto& answer = run.walks[w][i];
        if (!answer || !in_scope(instant, scope) || instant.since_start_s < bin.from_s || instant.since_start_s >= bin.to_s)
          continue;
        sums[w].sum += distance_m(answer->place.point, instant.truth.point);
        ++sums[w].count;
      }
      total_m += sums[w].sum;
      bin.n += sums[w].count;
    }
    bin.mean_m = bin.n == 0 ? std::numeric_limits<double>::quiet_NaN() : total_m / static_cast<double>(bin.n);
    bin.interval = bootstrap_mean(sums, Random(seed));
    bins.push_back(bin);
  }
  return bins;
}

}  // namespace wayfuse
