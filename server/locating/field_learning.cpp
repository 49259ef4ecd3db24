#include "server/locating/field_learning.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "server/locating/mean_of_smallest.hpp"

namespace wayfuse {
namespace {

constexpr int kRounds = 8;
constexpr double kPriorSigma = 6.0;      // of a weight, about its standard value
constexpr double kLeastWeight = 1.0;
constexpr double kMostWeight = 100.0;
constexpr float kCovered_m = 3.0f;       // a scan with no other walk this near cannot be told anything by the field
constexpr double kIrrelevant = -16.0;
constexpr double kAlike = 5.0;           // queries of one walk that say as much as one
constexpr double kClear = 2.0;           // standard errors
constexpr double kDelay_s = 1.5;         // of readings, before the survey is heard
constexpr double kDelaySigma_s = 1.0;
constexpr double kAlikeFits = 1e-9;
constexpr double kHalfWay = 0.5;
constexpr double kScansToTrust = 8.0;    // for half of what they say
constexpr std::size_t kMostShifting = 4000;  // queries: bounds the cost for a survey of days
constexpr double kNearby_m = 12.0;       // farther off is a mistaken place, not a shifted one
constexpr std::size_t kGroups = 8;       // of walks, left out one at a time
constexpr std::size_t kFewestQuestions = 10;  // fewer say nothing about errors

struct Question {
  std::vector<RadioField::Pair> nodes;   // of the query's floor, surveyed ones only
  std::vector<BuildingPoint> points;     // of the nodes
  std::size_t truth = 0;
  BuildingPoint place;
  int walk = 0;
  float least_distance = 1.0f;           // mean of the smallest to other walks
};

bool covered(const RadioField& field, const RadioField::Storey& storey, const SurveyQuery& query) {
  for (std::uint32_t i = storey.begin; i < storey.end; ++i) {
    const SurveyFingerprint& fingerprint = field.fingerprints()[i];
    if (fingerprint.walk != query.walk && distance_m(fingerprint.place.point, query.place.point) < kCovered_m) return true;
  }
  return false;
}

// Of unexposed distances: expose() overwrites other columns only.
float least_distance(const RadioField& field, const RadioField::Storey& storey, int without_walk, const RadioField::Scratch& scratch) {
  std::vector<float> distances;
  for (std::uint32_t i = storey.begin; i < storey.end; ++i) {
    if (field.fingerprints()[i].walk != without_walk) distances.push_back(scratch.sorensen[i]);
  }
  return distances.empty() ? 1.0f : mean_of_smallest<kFieldVoters>(distances);
}

// Ascending. A lattice spans whatever was surveyed: one place a thousand kilometres off, and nearly all of it is empty.
std::vector<std::uint32_t> nodes_surveyed(const RadioField& field) {
  std::vector<std::uint32_t> nodes;
  for (std::uint32_t node = 0; node < field.nodes(); ++node) {
    if (!field.kernels(node).empty()) nodes.push_back(node);
  }
  return nodes;
}

bool ask(const RadioField& field, std::span<const std::uint32_t> surveyed, const SurveyQuery& query, RadioField::Scratch& scratch, Question& question) {
  const auto storey = std::ranges::find(field.storeys(), query.place.floor, &RadioField::Storey::floor);
  if (storey == field.storeys().end() || !covered(field, *storey, query)) return false;
  float sum = 0.0f, squares = 0.0f;
  for (const RadioStrength& heard : query.heard) sum += heard.strength, squares += heard.strength * heard.strength;
  field.match(query.heard, sum, std::sqrt(squares), scratch);
  field.expose(*storey, scratch);
  const auto truth = storey->node_near(query.place.point);
  if (!truth) return false;
  const std::uint32_t end = storey->first_node + static_cast<std::uint32_t>(storey->columns * storey->rows);
  question.nodes.clear();
  question.points.clear();
  question.place = query.place.point;
  question.walk = query.walk;
  question.least_distance = least_distance(field, *storey, query.walk, scratch);
  const auto add = [&](std::uint32_t node) {
    question.nodes.push_back(field.node(node, scratch, query.walk));
    const auto at = static_cast<int>(node - storey->first_node);
    question.points.push_back({static_cast<double>(storey->x_m + RadioField::kLattice_m * static_cast<float>(at % storey->columns)),
                               static_cast<double>(storey->y_m + RadioField::kLattice_m * static_cast<float>(at / storey->columns))});
  };
  const auto first = std::ranges::lower_bound(surveyed, storey->first_node), middle = std::ranges::lower_bound(surveyed, *truth);
  for (auto at = first; at != middle; ++at) add(*at);
  question.truth = question.nodes.size();
  add(*truth);
  for (auto at = middle; at != surveyed.end() && *at < end; ++at) {
    if (*at != *truth) add(*at);
  }
  return true;
}

double level_of(const RadioField::Pair& p, const std::array<double, 2>& weight) {
  return weight[0] * static_cast<double>(p.sorensen) + weight[1] * static_cast<double>(p.cosine);
}

/// From where the scan was to the mean of the field's posterior, over nodes this near to where it was.
BuildingPoint error(const Question& question, const std::array<double, 2>& weight, double within_m) {
  double highest = -INFINITY;
  for (const RadioField::Pair& pair : question.nodes) highest = std::max(highest, level_of(pair, weight));
  double total = 0.0;
  BuildingPoint sum;
  for (std::size_t i = 0; i < question.nodes.size(); ++i) {
    if (distance_m(question.points[i], question.place) > within_m) continue;
    const double share = std::exp(level_of(question.nodes[i], weight) - highest);
    total += share;
    sum = {sum.x_m + share * question.points[i].x_m, sum.y_m + share * question.points[i].y_m};
  }
  if (total <= 0.0) return {};
  return {sum.x_m / total - question.place.x_m, sum.y_m / total - question.place.y_m};
}

double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

/// Gradient and Hessian of the log-likelihood in (sorensen, cosine).
struct Slope {
  std::array<double, 2> gradient{};
  std::array<double, 3> curvature{};     // ss sc cc, of minus the log-likelihood

  void add(const Question& question, const std::array<double, 2>& weight) {
    double highest = -INFINITY;
    for (const RadioField::Pair& pair : question.nodes) highest = std::max(highest, level_of(pair, weight));
    double total = 0.0, s = 0.0, c = 0.0, ss = 0.0, sc = 0.0, cc = 0.0;
    for (const RadioField::Pair& pair : question.nodes) {
      const double log_share = level_of(pair, weight) - highest;
      if (log_share < kIrrelevant) continue;
      const double share = std::exp(log_share), a = static_cast<double>(pair.sorensen), b = static_cast<double>(pair.cosine);
      total += share, s += share * a, c += share * b, ss += share * a * a, sc += share * a * b, cc += share * b * b;
    }
    s /= total, c /= total;
    gradient[0] += static_cast<double>(question.nodes[question.truth].sorensen) - s;
    gradient[1] += static_cast<double>(question.nodes[question.truth].cosine) - c;
    curvature[0] += ss / total - s * s;
    curvature[1] += sc / total - s * c;
    curvature[2] += cc / total - c * c;
  }
};

double log_likelihood(const Question& question, const std::array<double, 2>& weight) {
  double highest = -INFINITY, total = 0.0;
  for (const RadioField::Pair& pair : question.nodes) highest = std::max(highest, level_of(pair, weight));
  for (const RadioField::Pair& pair : question.nodes) total += std::exp(level_of(pair, weight) - highest);
  return level_of(question.nodes[question.truth], weight) - highest - std::log(total);
}

/// Every `step`-th query of a walk, the first one by the walk's number: what is asked hardly changes with the delay.
std::vector<const SurveyQuery*> some_of(std::span<const SurveyQuery> queries, std::size_t most) {
  const std::size_t step = std::max<std::size_t>(1, (queries.size() + most - 1) / most);
  std::vector<const SurveyQuery*> some;
  int walk = -1;
  std::size_t number = 0;
  for (const SurveyQuery& query : queries) {
    if (query.walk != walk) walk = query.walk, number = static_cast<std::size_t>(walk);
    if (number++ % step == 0) some.push_back(&query);
  }
  return some;
}

/// Absent where all fits are alike.
std::optional<double> top_s(std::span<const double> delays_s, std::span<const double> fits) {
  const auto best = static_cast<std::size_t>(std::ranges::max_element(fits) - fits.begin());
  const std::size_t middle = std::clamp<std::size_t>(best, 1, fits.size() - 2);
  const double a = fits[middle - 1], b = fits[middle], c = fits[middle + 1];
  const double bend = a - 2.0 * b + c;
  if (fits[best] - std::ranges::min(fits) < kAlikeFits) return std::nullopt;
  if (!(bend < 0.0)) return delays_s[best];
  return std::clamp(delays_s[middle] + (delays_s[middle + 1] - delays_s[middle]) * (a - c) / (2.0 * bend), delays_s.front(), delays_s.back());
}

}  // namespace

double SurveyFit::total() const {
  double sum = 0.0;
  for (const double each : log_likelihood) sum += each;
  return sum;
}

bool clearly_better(const SurveyFit& challenger, const SurveyFit& standard) {
  const std::size_t walks = std::min(challenger.scans.size(), standard.scans.size());
  std::vector<double> leads, scans;
  double lead = 0.0, asked = 0.0;
  for (std::size_t w = 0; w < walks; ++w) {
    if (challenger.scans[w] == 0 || standard.scans[w] == 0) continue;
    // Means times the scans there are: another delay may leave one more or one less of them on surveyed ground.
    leads.push_back(standard.scans[w] * (challenger.log_likelihood[w] / challenger.scans[w] - standard.log_likelihood[w] / standard.scans[w]));
    scans.push_back(standard.scans[w]);
    lead += leads.back(), asked += scans.back();
  }
  if (leads.size() < 2) return false;
  double squares = 0.0;
  for (std::size_t i = 0; i < leads.size(); ++i) squares += std::pow(leads[i] - scans[i] * lead / asked, 2);
  return lead > kClear * std::sqrt(squares * static_cast<double>(leads.size()) / static_cast<double>(leads.size() - 1));
}

double likeliest_delay_s(std::span<const double> delays_s, std::span<const SurveyFit> fits) {
  const auto without = [&](std::size_t group) {
    std::vector<double> means;
    for (const SurveyFit& fit : fits) {
      double sum = 0.0, scans = 0.0;
      for (std::size_t w = 0; w < fit.scans.size(); ++w) {
        if (w % kGroups != group) sum += fit.log_likelihood[w], scans += fit.scans[w];
      }
      means.push_back(sum / std::max(1.0, scans));
    }
    return top_s(delays_s, means);
  };
  const auto top = without(kGroups);
  if (!top) return kDelay_s;
  double squares = 0.0;
  for (std::size_t group = 0; group < kGroups; ++group) {
    const auto other = without(group);
    if (!other) return kDelay_s;
    squares += std::pow(*other - *top, 2);
  }
  const double variance_s2 = squares * (kGroups - 1) / kGroups;
  const double trust = kDelaySigma_s * kDelaySigma_s / (kDelaySigma_s * kDelaySigma_s + variance_s2);
  return kDelay_s + trust * (*top - kDelay_s);
}

std::vector<BuildingPoint> shifts_of_walks(const RadioField& field) {
  std::vector<int> asked;
  for (const SurveyQuery& query : field.queries()) {
    const auto walk = static_cast<std::size_t>(query.walk);
    if (asked.size() <= walk) asked.resize(walk + 1);
    asked[walk]++;
  }
  std::vector<BuildingPoint> errors(asked.size());
  std::vector<double> scans(asked.size());
  const std::vector<std::uint32_t> surveyed = nodes_surveyed(field);
  const auto scratch = field.borrow();
  Question question;
  for (const SurveyQuery* query : some_of(field.queries(), kMostShifting)) {
    const auto walk = static_cast<std::size_t>(query->walk);
    if (asked[walk] < 2 || !ask(field, surveyed, *query, *scratch, question)) continue;
    const BuildingPoint off = error(question, {field.weights().sorensen, field.weights().cosine}, kNearby_m);
    errors[walk] = {errors[walk].x_m + off.x_m, errors[walk].y_m + off.y_m};
    scans[walk]++;
  }
  for (std::size_t walk = 0; walk < errors.size(); ++walk) {
    const double share = kHalfWay / (scans[walk] + kScansToTrust);
    errors[walk] = {share * errors[walk].x_m, share * errors[walk].y_m};
  }
  return errors;
}

Learnt learn_weights(const RadioField& field, std::size_t most_queries) {
  FieldWeights learnt = field.weights();
  const FieldWeights standard;
  std::vector<Question> questions;
  std::vector<double> loudness;
  SurveyFit fit;
  {
    const std::vector<std::uint32_t> surveyed = nodes_surveyed(field);
    const auto scratch = field.borrow();
    Question question;
    for (const SurveyQuery* query : some_of(field.queries(), most_queries)) {
      if (!ask(field, surveyed, *query, *scratch, question)) continue;
      questions.push_back(question);
      const auto storey = std::ranges::find(field.storeys(), query->place.floor, &RadioField::Storey::floor);
      if (const auto ratio = field.loudness(query->heard, *storey, query->place.point, query->walk)) loudness.push_back(*ratio);
    }
  }
  std::array<double, 2> weight = {learnt.sorensen, learnt.cosine};
  const std::array<double, 2> prior = {standard.sorensen, standard.cosine};
  for (int round = 0; round < kRounds && !questions.empty(); ++round) {
    Slope slope;
    for (const Question& question : questions) slope.add(question, weight);
    const double precision = kAlike / (kPriorSigma * kPriorSigma);
    for (int k = 0; k < 2; ++k) slope.gradient[k] -= precision * (weight[k] - prior[k]);
    const double a = slope.curvature[0] + precision, b = slope.curvature[1], d = slope.curvature[2] + precision;
    const double determinant = a * d - b * b;
    weight[0] += (d * slope.gradient[0] - b * slope.gradient[1]) / determinant;
    weight[1] += (a * slope.gradient[1] - b * slope.gradient[0]) / determinant;
    for (double& each : weight) each = std::clamp(each, kLeastWeight, kMostWeight);
  }
  learnt.sorensen = weight[0];
  learnt.cosine = weight[1];
  for (const Question& question : questions) {
    const auto walk = static_cast<std::size_t>(question.walk);
    if (fit.scans.size() <= walk) fit.scans.resize(walk + 1), fit.log_likelihood.resize(walk + 1);
    fit.scans[walk]++;
    fit.log_likelihood[walk] += log_likelihood(question, weight);
  }
  if (questions.size() < kFewestQuestions) return {learnt, fit};
  if (loudness.size() >= kFewestQuestions) learnt.loudness = quantile(loudness, 0.5);
  std::vector<double> distances;
  for (const Question& question : questions) distances.push_back(static_cast<double>(question.least_distance));
  learnt.usual_distance = std::max(0.02, quantile(distances, 0.5));
  return {learnt, std::move(fit)};
}

}  // namespace wayfuse
