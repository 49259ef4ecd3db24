#include "server/quality/map_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "db/content_hash.hpp"

namespace wayfuse {
namespace {

constexpr double kNoise_m = 0.15;          // a difference of means below it does not repeat with other random numbers
constexpr double kNoiseShare = 0.05;
constexpr double kPlain = 4.0;             // this many times the noise counts even on a single walk
constexpr double kFewestRight = 0.01;      // floor hits and answers a map may lose
constexpr double kHonest95 = 0.90;
constexpr double kHonestLoss = 0.05;

std::string words(const char* form, double a, double b) {
  char text[160];
  std::snprintf(text, sizeof text, form, a, b);
  return text;
}

double share(double part, double whole) { return whole == 0.0 ? 0.0 : part / whole; }

std::vector<float> quantiles(std::span<const double> errors_m) {
  std::vector<double> ascending(errors_m.begin(), errors_m.end());
  std::ranges::sort(ascending);
  std::vector<float> found;
  for (int percent = 0; percent <= 100 && !ascending.empty(); ++percent) {
    found.push_back(static_cast<float>(percentile_of_sorted(ascending, 0.01 * percent)));
  }
  return found;
}

/// Figures of both sides on the walks both were measured by, in one order.
struct Paired {
  std::vector<MapQuality> candidate;
  std::vector<MapQuality> live;
};

Paired pair(std::span<const MapQuality> candidate, std::span<const MapQuality> live) {
  Paired paired;
  for (const MapQuality& figures : candidate) {
    const auto other = std::ranges::find(live, figures.walk_id, &MapQuality::walk_id);
    if (other == live.end()) continue;
    paired.candidate.push_back(figures);
    paired.live.push_back(*other);
  }
  return paired;
}

std::vector<GroupSum> sums(std::span<const MapQuality> walks) {
  std::vector<GroupSum> groups;
  for (const MapQuality& walk : walks) groups.push_back({walk.mean_m * static_cast<double>(walk.instants), static_cast<std::size_t>(walk.instants)});
  return groups;
}

void judge(MapComparison& comparison) {
  const PooledQuality& now = comparison.candidate;
  const PooledQuality& before = comparison.live;
  const auto worse = [&](std::string why) {
    comparison.verdict = Verdict::kWorse;
    comparison.reasons.push_back(std::move(why));
  };
  const double difference = comparison.mean_m.difference;
  const Interval interval = comparison.mean_m.interval;
  const double noise_m = std::max(kNoise_m, kNoiseShare * before.mean_m);
  const double answers = share(static_cast<double>(now.instants), static_cast<double>(now.asked));
  const double answers_before = share(static_cast<double>(before.instants), static_cast<double>(before.asked));
  // One walk has no other to differ from: its interval would be a point.
  const bool several = now.walks > 1;
  const std::string how_sure = several ? words(" (95 %% interval of the difference %.2f to %.2f m)", interval.low, interval.high)
                                       : " (one walk: no interval of the difference)";
  if (difference > noise_m && ((several && interval.low > 0.0) || difference > kPlain * noise_m)) {
    worse(words("the mean error rises from %.2f to %.2f m", before.mean_m, now.mean_m) + how_sure);
  }
  if (now.floor_hit < before.floor_hit - kFewestRight) {
    worse(words("the floor is right in %.1f instead of %.1f %% of the answers", 100.0 * now.floor_hit, 100.0 * before.floor_hit));
  }
  if (answers < answers_before - kFewestRight) {
    worse(words("%.1f instead of %.1f %% of the questions are answered", 100.0 * answers, 100.0 * answers_before));
  }
  if (now.in95 < kHonest95 && now.in95 < before.in95 - kHonestLoss) {
    worse(words("the 95 %% circle holds %.1f instead of %.1f %%", 100.0 * now.in95, 100.0 * before.in95));
  }
  if (comparison.verdict == Verdict::kWorse) return;
  const bool better = -difference > noise_m && ((several && interval.high < 0.0) || -difference > kPlain * noise_m);
  comparison.verdict = better ? Verdict::kBetter : Verdict::kSame;
  comparison.reasons.push_back(words("the mean error goes from %.2f to %.2f m", before.mean_m, now.mean_m) + how_sure);
}

}  // namespace

Result<std::vector<MapQuality>> measure(const Building& building, const std::string& pipeline, std::span<const QualityWalk> walks, UnixTime now) {
  const auto factory = building.pipeline(pipeline);
  if (!factory) return factory.fault();
  std::vector<MapQuality> measured;
  for (const QualityWalk& walk : walks) {
    const QualityGauge gauge = gauge_walk(**factory, walk.track, Random(0x9e3779b97f4a7c15u ^ walk.id));
    const TrackQuality quality = gauge.read();
    if (quality.asked == 0) continue;
    MapQuality figures;
    figures.version = building.map_version();
    figures.walk_id = walk.id;
    figures.measured_at = now;
    figures.asked = quality.asked;
    figures.instants = quality.error_m.n;
    figures.measured_with = measured_with((*factory)->spec());
    if (figures.instants > 0) {
      figures.mean_m = quality.error_m.mean;
      figures.rmse_m = quality.error_m.rmse;
      figures.median_m = quality.error_m.median;
      figures.p90_m = quality.error_m.p90;
      figures.floor_hit = quality.floor_hit;
      figures.in68 = quality.in68;
      figures.in95 = quality.in95;
      figures.error_quantiles_m = quantiles(gauge.errors_m());
    }
    measured.push_back(std::move(figures));
  }
  return measured;
}

std::string measured_with(const PipelineSpec& spec) { return spec.name + "@" + hex(sha256(to_json(spec))).substr(0, 16); }

std::string_view to_string(Verdict verdict) {
  constexpr std::string_view kNames[] = {"better", "same", "worse", "unknown"};
  return kNames[static_cast<std::size_t>(verdict)];
}

MapComparison compare(std::span<const MapQuality> candidate, std::span<const MapQuality> live) {
  const Paired paired = pair(candidate, live);
  MapComparison comparison;
  comparison.candidate = pool(paired.candidate);
  comparison.live = pool(paired.live);
  if (paired.candidate.empty()) {
    comparison.reasons.emplace_back("no quality walk was measured on both maps");
    return comparison;
  }
  if (comparison.live.instants == 0 && comparison.candidate.instants == 0) {
    comparison.reasons.emplace_back("neither map answers on any quality walk");
    return comparison;
  }
  const auto now = sums(paired.candidate), before = sums(paired.live);
  comparison.mean_m = paired_difference(before, now, Random(1));
  if (comparison.live.instants == 0) {
    comparison.verdict = Verdict::kBetter;
    comparison.reasons.emplace_back("the live map answers on no quality walk");
    return comparison;
  }
  if (comparison.candidate.instants == 0) {
    comparison.verdict = Verdict::kWorse;
    comparison.reasons.emplace_back("the candidate answers on no quality walk");
    return comparison;
  }
  judge(comparison);
  return comparison;
}

}  // namespace wayfuse
