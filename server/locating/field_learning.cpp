#include "server/locating/field_learning.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace wayfuse {
namespace {

constexpr int kRounds = 8;
constexpr double kPriorSigma = 6.0;      // of a weight, about its standard value
constexpr double kLeastWeight = 1.0;
constexpr double kMostWeight = 100.0;
constexpr float kCovered_m = 3.0f;       // a scan with no other walk this near cannot be told anything by the field
constexpr double kIrrelevant = -16.0;
constexpr double kAlike = 5.0;           // queries of one walk that say as much as one
constexpr double kDelay_s = 1.5;         // of readings, before the survey is heard
constexpr double kDelaySigma_s = 1.0;
constexpr std::size_t kFewestQuestions = 10;  // fewer say nothing about errors

struct Question {
  std::vector<RadioField::Pair> nodes;   // of the query's floor, surveyed ones only
  std::vector<BuildingPoint> points;     // of the nodes
  std::size_t truth = 0;
  BuildingPoint place;
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
  const std::size_t count = std::min(kFieldVoters, distances.size());
  std::ranges::partial_sort(distances, distances.begin() + static_cast<std::ptrdiff_t>(count));
  float sum = static_cast<float>(kFieldVoters - count);
  for (std::size_t i = 0; i < count; ++i) sum += distances[i];
  return sum / static_cast<float>(kFieldVoters);
}

bool ask(const RadioField& field, const SurveyQuery& query, RadioField::Scratch& scratch, Question& question) {
  const auto storey = std::ranges::find(field.storeys(), query.place.floor, &RadioField::Storey::floor);
  if (storey == field.storeys().end() || !covered(field, *storey, query)) return false;
  float sum = 0.0f, squares = 0.0f;
  for (const RadioStrength& heard : query.heard) sum += heard.strength, squares += heard.strength * heard.strength;
  field.match(query.heard, sum, std::sqrt(squares), scratch);
  field.expose(*storey, scratch);
  const auto column = static_cast<int>(std::lround((static_cast<float>(query.place.point.x_m) - storey->x_m) / RadioField::kLattice_m));
  const auto row = static_cast<int>(std::lround((static_cast<float>(query.place.point.y_m) - storey->y_m) / RadioField::kLattice_m));
  if (column < 0 || row < 0 || column >= storey->columns || row >= storey->rows) return false;
  const std::uint32_t truth = storey->first_node + static_cast<std::uint32_t>(row * storey->columns + column);
  const std::uint32_t end = storey->first_node + static_cast<std::uint32_t>(storey->columns * storey->rows);
  question.nodes.clear();
  question.points.clear();
  question.place = query.place.point;
  question.least_distance = least_distance(field, *storey, query.walk, scratch);
  for (std::uint32_t node = storey->first_node; node < end; ++node) {
    if (node == truth) question.truth = question.nodes.size();
    else if (field.kernels(node).empty()) continue;
    question.nodes.push_back(field.node(node, scratch, query.walk));
    const auto at = static_cast<int>(node - storey->first_node);
    question.points.push_back({static_cast<double>(storey->x_m + RadioField::kLattice_m * static_cast<float>(at % storey->columns)),
                               static_cast<double>(storey->y_m + RadioField::kLattice_m * static_cast<float>(at / storey->columns))});
  }
  return true;
}

double level_of(const RadioField::Pair& p, const std::array<double, 2>& weight) {
  return weight[0] * static_cast<double>(p.sorensen) + weight[1] * static_cast<double>(p.cosine);
}

/// Distance from the mean of the field's posterior to where the scan was.
double error_m(const Question& question, const std::array<double, 2>& weight) {
  double highest = -INFINITY;
  for (const RadioField::Pair& pair : question.nodes) highest = std::max(highest, level_of(pair, weight));
  double total = 0.0;
  BuildingPoint mean;
  for (std::size_t i = 0; i < question.nodes.size(); ++i) {
    const double share = std::exp(level_of(question.nodes[i], weight) - highest);
    total += share;
    mean = {mean.x_m + share * question.points[i].x_m, mean.y_m + share * question.points[i].y_m};
  }
  return distance_m({mean.x_m / total, mean.y_m / total}, question.place);
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

}  // namespace

double log_fit(const RadioField& field, std::size_t most_queries) {
  const std::size_t step = std::max<std::size_t>(1, field.queries().size() / most_queries);
  const auto scratch = field.borrow();
  const std::array<double, 2> weight = {field.weights().sorensen, field.weights().cosine};
  Question question;
  double sum = 0.0;
  std::size_t asked = 0;
  for (std::size_t i = 0; i < field.queries().size(); i += step) {
    if (!ask(field, field.queries()[i], *scratch, question)) continue;
    double highest = -INFINITY, total = 0.0;
    for (const RadioField::Pair& pair : question.nodes) highest = std::max(highest, level_of(pair, weight));
    for (const RadioField::Pair& pair : question.nodes) total += std::exp(level_of(pair, weight) - highest);
    sum += level_of(question.nodes[question.truth], weight) - highest - std::log(total);
    ++asked;
  }
  // A mean times the queries there are: another delay may leave one more or one less of them on surveyed ground.
  return asked == 0 ? 0.0 : sum / static_cast<double>(asked) * static_cast<double>(field.queries().size()) / kAlike;
}

double likeliest_delay_s(std::span<const double> delays_s, std::span<const double> fits) {
  const auto score = [&](std::size_t i) { return fits[i] - std::pow((delays_s[i] - kDelay_s) / kDelaySigma_s, 2) / 2; };
  std::size_t best = 0;
  for (std::size_t i = 1; i < fits.size(); ++i) best = score(i) > score(best) ? i : best;
  const std::size_t middle = std::clamp<std::size_t>(best, 1, fits.size() - 2);
  const double a = score(middle - 1), b = score(middle), c = score(middle + 1);
  const double bend = a - 2.0 * b + c;
  const double step_s = delays_s[middle + 1] - delays_s[middle];
  if (!(bend < 0.0)) return delays_s[best];
  return std::clamp(delays_s[middle] + step_s * (a - c) / (2.0 * bend), delays_s.front(), delays_s.back());
}

FieldWeights learn_weights(const RadioField& field, std::size_t most_queries) {
  FieldWeights learnt = field.weights();
  const FieldWeights standard;
  const std::size_t step = std::max<std::size_t>(1, field.queries().size() / most_queries);
  std::vector<Question> questions;
  std::vector<double> loudness;
  {
    const auto scratch = field.borrow();
    Question question;
    for (std::size_t i = 0; i < field.queries().size(); i += step) {
      const SurveyQuery& query = field.queries()[i];
      if (!ask(field, query, *scratch, question)) continue;
      questions.push_back(question);
      const auto storey = std::ranges::find(field.storeys(), query.place.floor, &RadioField::Storey::floor);
      if (const auto ratio = field.loudness(query.heard, *storey, query.place.point, query.walk)) loudness.push_back(*ratio);
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
  if (questions.size() < kFewestQuestions) return learnt;
  if (loudness.size() >= kFewestQuestions) learnt.loudness = quantile(loudness, 0.5);
  std::vector<double> errors_m, distances;
  for (const Question& question : questions) {
    errors_m.push_back(error_m(question, weight));
    distances.push_back(static_cast<double>(question.least_distance));
  }
  learnt.resolution_m = std::clamp(quantile(errors_m, 0.68), 0.5, 50.0);
  learnt.usual_distance = std::max(0.02, quantile(distances, 0.5));
  return learnt;
}

}  // namespace wayfuse
