#include "tests/evaluation/motion/attitude_score.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "sdk/src/attitude/block_heading.hpp"
#include "sdk/src/attitude/catalogue.hpp"
#include "sdk/src/attitude/rotation.hpp"
#include "tests/evaluation/motion/madgwick_heading.hpp"

namespace wayfuse {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

class Tally {
 public:
  void add(const AttitudeError& error, double sigma_rad) {
    sum_.total_deg += error.total_deg * error.total_deg;
    sum_.heading_deg += error.heading_deg * error.heading_deg;
    sum_.inclination_deg += error.inclination_deg * error.inclination_deg;
    inside_ += error.heading_deg * kDegree < sigma_rad;
    inside_two_ += error.heading_deg * kDegree < 2.0 * sigma_rad;
    totals_deg_.push_back(error.total_deg);
  }
  void write(TrialScore& score) {
    const double n = std::max<double>(1.0, static_cast<double>(totals_deg_.size()));
    score.rmse = {std::sqrt(sum_.total_deg / n), std::sqrt(sum_.heading_deg / n), std::sqrt(sum_.inclination_deg / n)};
    score.in_sigma = inside_ / n;
    score.in_two_sigma = inside_two_ / n;
    score.totals_deg = std::move(totals_deg_);
    if (score.totals_deg.empty()) return;
    auto middle = score.totals_deg.begin() + static_cast<std::ptrdiff_t>(score.totals_deg.size() / 2);
    std::nth_element(score.totals_deg.begin(), middle, score.totals_deg.end());
    score.median_deg = *middle;
  }

 private:
  AttitudeError sum_;
  std::vector<double> totals_deg_;
  double inside_ = 0.0, inside_two_ = 0.0;
};

std::vector<MargSample> samples_of(const AttitudeTrial& trial, const TrialRun& run) {
  PhoneTime from = trial.samples.empty() ? PhoneTime{} : trial.samples.front().time;
  if (run.skip_rest) {
    const auto first = std::find_if(trial.truth.begin(), trial.truth.end(), [](const TrueAttitude& t) { return t.counts; });
    if (first != trial.truth.end()) from = first->time;
  }
  std::vector<MargSample> samples;
  int skipped = 0;
  for (const MargSample& sample : trial.samples) {
    if (sample.time >= from && skipped++ % run.every == 0) samples.push_back(sample);
  }
  return samples;
}

double time_feeding(const NamedEstimator& estimator, const std::vector<MargSample>& samples) {
  double best_ns = 1e300;
  for (int pass = 0; pass < 3; ++pass) {
    const auto made = estimator.make();
    const auto begin = std::chrono::steady_clock::now();
    for (const MargSample& sample : samples) made->feed(sample);
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - begin;
    best_ns = std::min(best_ns, took.count() / std::max<double>(1.0, static_cast<double>(samples.size())));
  }
  return best_ns;
}

}  // namespace

AttitudeError attitude_error(Quaternion truth, Quaternion estimate) {
  const Quaternion d = normalized(estimate * conjugate(truth));  // in east-north-up
  return {2.0 * std::acos(std::min(1.0, std::abs(d.w))) / kDegree, 2.0 * std::atan2(std::abs(d.z), std::abs(d.w)) / kDegree,
          2.0 * std::acos(std::min(1.0, std::hypot(d.w, d.z))) / kDegree};
}

std::vector<NamedEstimator> measured_estimators() {
  std::vector<NamedEstimator> all;
  for (const HeadingEstimatorRow& row : heading_estimators()) all.push_back({std::string(row.name), row.make});
  all.push_back({"block_marg_no_delay", [] {
                   BlockHeadingSettings settings;
                   settings.sensor_delay_s = 0.0;
                   return std::make_unique<BlockHeading>(settings);
                 }});
  all.push_back({"madgwick_baseline", [] { return std::make_unique<MadgwickHeading>(); }});
  return all;
}

// Truth at the time of the newest sample fed: what an application would have known then.
TrialScore score(const NamedEstimator& estimator, const AttitudeTrial& trial, const TrialRun& run) {
  TrialScore result;
  result.estimator = estimator.name;
  result.trial = trial.name;
  const std::vector<MargSample> samples = samples_of(trial, run);
  const auto made = estimator.make();
  if (run.expected) made->expect(*run.expected);
  Tally tally;
  auto truth = trial.truth.begin();
  const auto look = [&] {
    if (!truth->counts || !truth->body_to_enu) return;
    if (const auto attitude = made->attitude()) tally.add(attitude_error(*truth->body_to_enu, attitude->body_to_enu), attitude->heading_sigma_rad);
  };
  for (const MargSample& sample : samples) {
    for (; truth != trial.truth.end() && truth->time < sample.time; ++truth) {
      if (run.every == 1) look();
    }
    made->feed(sample);
    if (truth != trial.truth.end() && truth->time == sample.time) {
      look();
      ++truth;
    }
  }
  tally.write(result);
  result.ns_per_sample = time_feeding(estimator, samples);
  return result;
}

TrialScore score_phone(const AttitudeTrial& trial, const TrialRun& run) {
  TrialScore result;
  result.estimator = "phone";
  result.trial = trial.name;
  Tally tally;
  auto own = trial.phone.begin();
  const Quaternion to_true = about_up(run.expected ? -run.expected->declination_rad : 0.0);
  for (const TrueAttitude& truth : trial.truth) {
    while (own != trial.phone.end() && std::next(own) != trial.phone.end() && std::next(own)->time <= truth.time) ++own;
    if (own == trial.phone.end() || own->time > truth.time || !truth.counts || !truth.body_to_enu) continue;
    tally.add(attitude_error(*truth.body_to_enu, normalized(to_true * own->body_to_enu)), 0.0);
  }
  tally.write(result);
  return result;
}

}  // namespace wayfuse
