#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "wayfuse/proto/random.hpp"

namespace wayfuse {

double mean(std::span<const double> values);  ///< NaN of nothing, like all below
double root_mean_square(std::span<const double> values);
/// Between order statistics on a straight line (type 7 of Hyndman and Fan 1996); `share` in 0..1.
double percentile(std::vector<double> values, double share);
double percentile_of_sorted(std::span<const double> ascending, double share);

/// Spearman's rho with mean ranks for ties; absent with fewer than three pairs or a constant side.
std::optional<double> rank_correlation(std::span<const double> a, std::span<const double> b);

struct ErrorSummary {
  std::size_t n = 0;
  double mean = 0.0;
  double rmse = 0.0;
  double median = 0.0;
  double p75 = 0.0;
  double p90 = 0.0;
  double p95 = 0.0;
};
ErrorSummary summarise(std::vector<double> errors);

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// The 95 % percentile bootstrap over whole groups: errors within a walk hang together, walks do not.
///
/// `statistic` is called with the indices of the groups drawn, as many as there are. NaN answers are left out.
Interval bootstrap_interval(std::size_t groups, const std::function<double(std::span<const std::size_t>)>& statistic,
                            Random random, int draws = 1000);

/// The pooled mean over groups and its interval, from per-group sums and counts.
struct GroupSum {
  double sum = 0.0;
  std::size_t count = 0;
};
Interval bootstrap_mean(std::span<const GroupSum> groups, Random random, int draws = 1000);

/// Pooled mean of `b` minus that of `a` over the same groups, with its interval: negative = b is better.
struct PairedDifference {
  double difference = 0.0;
  Interval interval;
  double share_better = 0.0;  ///< of the groups where both have values, those whose mean is lower in b
};
PairedDifference paired_difference(std::span<const GroupSum> a, std::span<const GroupSum> b, Random random, int draws = 1000);

}  // namespace wayfuse
