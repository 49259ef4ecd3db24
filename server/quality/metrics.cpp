#include "server/quality/metrics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

namespace wayfuse {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::vector<double> ranks(std::span<const double> values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> rank(values.size());
  for (std::size_t i = 0; i < order.size();) {
    std::size_t end = i;
    while (end < order.size() && values[order[end]] == values[order[i]]) ++end;
    const double tied = 0.5 * static_cast<double>(i + end - 1);
    for (; i < end; ++i) rank[order[i]] = tied;
  }
  return rank;
}

GroupSum total(std::span<const GroupSum> groups, std::span<const std::size_t> drawn) {
  GroupSum sum;
  for (const std::size_t i : drawn) {
    sum.sum += groups[i].sum;
    sum.count += groups[i].count;
  }
  return sum;
}

double mean_of(const GroupSum& group) {
  return group.count == 0 ? kNone : group.sum / static_cast<double>(group.count);
}

}  // namespace

double mean(std::span<const double> values) {
  if (values.empty()) return kNone;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double root_mean_square(std::span<const double> values) {
  if (values.empty()) return kNone;
  return std::sqrt(std::inner_product(values.begin(), values.end(), values.begin(), 0.0) / static_cast<double>(values.size()));
}

double percentile_of_sorted(std::span<const double> ascending, double share) {
  if (ascending.empty()) return kNone;
  const double place = share * static_cast<double>(ascending.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  if (below + 1 >= ascending.size()) return ascending.back();
  const double part = place - static_cast<double>(below);
  return ascending[below] + part * (ascending[below + 1] - ascending[below]);
}

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return percentile_of_sorted(values, share);
}

std::optional<double> rank_correlation(std::span<const double> a, std::span<const double> b) {
  assert(a.size() == b.size());
  if (a.size() < 3) return std::nullopt;
  const std::vector<double> ra = ranks(a);
  const std::vector<double> rb = ranks(b);
  const double middle = 0.5 * static_cast<double>(a.size() - 1);
  double ab = 0.0, aa = 0.0, bb = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (ra[i] - middle) * (rb[i] - middle);
    aa += (ra[i] - middle) * (ra[i] - middle);
    bb += (rb[i] - middle) * (rb[i] - middle);
  }
  if (aa == 0.0 || bb == 0.0) return std::nullopt;
  return ab / std::sqrt(aa * bb);
}

ErrorSummary summarise(std::vector<double> errors) {
  std::sort(errors.begin(), errors.end());
  return {errors.size(),
          mean(errors),
          root_mean_square(errors),
          percentile_of_sorted(errors, 0.50),
          percentile_of_sorted(errors, 0.75),
          percentile_of_sorted(errors, 0.90),
          percentile_of_sorted(errors, 0.95)};
}

Interval bootstrap_interval(std::size_t groups, const std::function<double(std::span<const std::size_t>)>& statistic,
                            Random random, int draws) {
  std::vector<double> values;
  std::vector<std::size_t> drawn(groups);
  for (int draw = 0; groups > 0 && draw < draws; ++draw) {
    for (std::size_t& i : drawn) i = random.below(groups);
    const double value = statistic(drawn);
    if (!std::isnan(value)) values.push_back(value);
  }
  std::sort(values.begin(), values.end());
  return {percentile_of_sorted(values, 0.025), percentile_of_sorted(values, 0.975)};
}

Interval bootstrap_mean(std::span<const GroupSum> groups, Random random, int draws) {
  return bootstrap_interval(
      groups.size(), [&](std::span<const std::size_t> drawn) { return mean_of(total(groups, drawn)); }, random, draws);
}

PairedDifference paired_difference(std::span<const GroupSum> a, std::span<const GroupSum> b, Random random, int draws) {
  assert(a.size() == b.size());
  std::vector<std::size_t> all(a.size());
  std::iota(all.begin(), all.end(), 0);
  const auto difference = [&](std::span<const std::size_t> drawn) {
    return mean_of(total(b, drawn)) - mean_of(total(a, drawn));
  };
  PairedDifference result;
  result.difference = difference(all);
  result.interval = bootstrap_interval(a.size(), difference, random, draws);
  std::size_t both = 0;
  std::size_t better = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].count == 0 || b[i].count == 0) continue;
    ++both;
    better += mean_of(b[i]) < mean_of(a[i]);
  }
  result.share_better = both == 0 ? kNone : static_cast<double>(better) / static_cast<double>(both);
  return result;
}

}  // namespace wayfuse
