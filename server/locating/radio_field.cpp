#include "server/locating/radio_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/locating/between_walks.hpp"
#include "server/locating/field_learning.hpp"
#include "server/locating/radio_field_locator.hpp"

namespace wayfuse {
namespace {

constexpr float kLeastMass = 0.01f;      // of a kernel, against the nearest fingerprint's: three sigmas away
constexpr float kEdge = 2.0f;            // of beyond_m: from there on unsurveyed ground is neutral
constexpr std::size_t kMiddleSamples = 40;
constexpr std::size_t kMostSpare = 64;
constexpr double kAround_m = 4.0;            // of a point: fingerprints that hear what is heard there
constexpr int kFewestShared = 3;
// Tried on the survey.
constexpr std::array kDelays_s = {0.0, 1.0, 2.0, 3.0};
constexpr std::array kPowers = {2.72, 1.6, 1.0};
constexpr std::size_t kQuickQueries = 500;  // fewer turn a map over by chance

float median(std::vector<float>& values) {
  if (values.empty()) return 1.0f;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

std::optional<std::uint32_t> RadioField::Storey::node_near(BuildingPoint point) const {
  const long column = std::lround((static_cast<float>(point.x_m) - x_m) / kLattice_m);
  const long row = std::lround((static_cast<float>(point.y_m) - y_m) / kLattice_m);
  if (column < 0 || row < 0 || column >= columns || row >= rows) return std::nullopt;
  return first_node + static_cast<std::uint32_t>(row * columns + column);
}

RadioField::RadioField(std::span<const ReferencePoint> survey, const RadioFieldSettings& settings) : settings_(settings) {
  const auto read = [&] {
    take(read_survey(survey, {.strength = settings_.strength, .delay_s = weights_.delay_s, .spacing_s = settings_.spacing_s}));
  };
  if (settings_.delay_s >= 0.0) weights_.delay_s = settings_.delay_s;
  if (settings_.strength.power <= 0.0) settings_.strength.power = settings_.learn ? learn_power(read) : kPowers.front();
  if (settings_.delay_s < 0.0 && settings_.learn) weights_.delay_s = learn_delay_s(read);
  read();
  if (settings_.learn && !queries_.empty()) {
    bring_walks_together();
    weights_ = learn_weights(*this).weights;
  }
  if (settings_.between) fill_between();
}

// The representation that explains the survey's own scans best, each judged with the weights it would get. The first one stays
// unless another is clearly better: a few scans more or less must not turn a building's whole map over.
double RadioField::learn_power(const std::function<void()>& read) {
  double best = kPowers.front();
  std::optional<SurveyFit> highest;
  const FieldWeights standard = weights_;
  for (const double power : kPowers) {
    settings_.strength.power = power;
    weights_ = standard;
    read();
    SurveyFit fit = learn_weights(*this, kQuickQueries).fit;
    if (highest && !clearly_better(fit, *highest)) continue;
    best = power;
    highest = std::move(fit);
  }
  weights_ = standard;
  return best;
}

double RadioField::learn_delay_s(const std::function<void()>& read) {
  std::vector<SurveyFit> fits;
  for (const double delay_s : kDelays_s) {
    weights_.delay_s = delay_s;
    read();
    fits.push_back(learn_weights(*this, kQuickQueries).fit);
  }
  return likeliest_delay_s(kDelays_s, fits);
}

// By shifts_of_walks, with the standard weights: the weights are learnt over the walks as they stand then.
void RadioField::bring_walks_together() {
  const std::vector<BuildingPoint> shifts = shifts_of_walks(*this);
  const auto move = [&](Place& place, int walk) {
    const auto number = static_cast<std::size_t>(walk);
    if (number >= shifts.size()) return;
    place.point = {place.point.x_m + shifts[number].x_m, place.point.y_m + shifts[number].y_m};
  };
  for (SurveyFingerprint& fingerprint : fingerprints_) move(fingerprint.place, fingerprint.walk);
  for (SurveyQuery& query : queries_) move(query.place, query.walk);
  find_homes();
  lay_lattice();
}

// After learning, which asks what each walk is told by the others alone.
void RadioField::fill_between() {
  std::vector<SurveyFingerprint> made = fingerprints_between(*this);
  if (made.empty()) return;
  std::vector<SurveyFingerprint> all;
  auto next = made.begin();
  for (Storey& storey : storeys_) {
    const auto begin = static_cast<std::uint32_t>(all.size());
    for (std::uint32_t i = storey.begin; i < storey.end; ++i) all.push_back(std::move(fingerprints_[i]));
    storey.begin = begin;
    storey.surveyed_end = static_cast<std::uint32_t>(all.size());
    while (next != made.end() && next->place.floor == storey.floor) all.push_back(std::move(*next++));
    storey.end = static_cast<std::uint32_t>(all.size());
  }
  fingerprints_ = std::move(all);
  index_fingerprints();
  lay_lattice();
}

std::unique_ptr<Locator> RadioField::make() const { return std::make_unique<RadioFieldLocator>(shared_from_this()); }

void RadioField::take(SurveyReading reading) {
  radios_ = std::move(reading.radios);
  std::vector<Place> places;
  for (const SurveyFingerprint& fingerprint : reading.fingerprints) places.push_back(fingerprint.place);
  fingerprints_.clear();
  for (const std::uint32_t i : space_filling_order(places)) fingerprints_.push_back(std::move(reading.fingerprints[i]));
  queries_ = std::move(reading.queries);
  storeys_.clear();
  for (std::uint32_t i = 0; i < fingerprints_.size(); ++i) {
    const FloorOrdinal floor = fingerprints_[i].place.floor;
    if (storeys_.empty() || storeys_.back().floor != floor) storeys_.push_back({.floor = floor, .begin = i});
    storeys_.back().surveyed_end = storeys_.back().end = i + 1;
  }
  index_fingerprints();
  find_homes();
  lay_lattice();
  find_middles();
}

void RadioField::index_fingerprints() {
  std::vector<LevelBlocks::Level> levels;
  sum_.assign(fingerprints_.size(), 0.0f);
  norm_.assign(fingerprints_.size(), 0.0f);
  walk_.clear();
  for (const SurveyFingerprint& fingerprint : fingerprints_) walk_.push_back(fingerprint.walk);
  for (std::uint32_t i = 0; i < fingerprints_.size(); ++i) {
    for (const RadioStrength& heard : fingerprints_[i].heard) {
      levels.push_back({i, heard.radio, heard.strength});
      sum_[i] += heard.strength;
      norm_[i] += heard.strength * heard.strength;
    }
    norm_[i] = std::sqrt(norm_[i]);
  }
  blocks_ = LevelBlocks(fingerprints_.size(), radios_.size(), levels);
  sum_.resize(blocks_.padded());
  norm_.resize(blocks_.padded());
}

void RadioField::find_homes() {
  homes_.assign(radios_.size(), {});
  for (const SurveyFingerprint& fingerprint : fingerprints_) {
    for (const RadioStrength& heard : fingerprint.heard) {
      if (heard.strength > homes_[heard.radio].strength) homes_[heard.radio] = {fingerprint.place, heard.strength};
    }
  }
}

// Every node within `reach_m` of a fingerprint: each(node, fingerprint, squared distance in m2).
void RadioField::near_nodes(float reach_m, const auto& each) const {
  const float reach = reach_m / kLattice_m;
  for (const Storey& storey : storeys_) {
    for (std::uint32_t i = storey.begin; i < storey.end; ++i) {
      const auto x = (static_cast<float>(fingerprints_[i].place.point.x_m) - storey.x_m) / kLattice_m;
      const auto y = (static_cast<float>(fingerprints_[i].place.point.y_m) - storey.y_m) / kLattice_m;
      const int last_row = std::min(storey.rows - 1, static_cast<int>(std::floor(y + reach)));
      const int last_column = std::min(storey.columns - 1, static_cast<int>(std::floor(x + reach)));
      for (int row = std::max(0, static_cast<int>(std::ceil(y - reach))); row <= last_row; ++row) {
        for (int column = std::max(0, static_cast<int>(std::ceil(x - reach))); column <= last_column; ++column) {
          const float dx_m = (static_cast<float>(column) - x) * kLattice_m, dy_m = (static_cast<float>(row) - y) * kLattice_m;
          const float square_m2 = dx_m * dx_m + dy_m * dy_m;
          if (square_m2 > reach_m * reach_m) continue;
          each(storey.first_node + static_cast<std::uint32_t>(row * storey.columns + column), i, square_m2);
        }
      }
    }
  }
}

// Lattices over the surveyed ground and `edge_m` around it; returns the number of all nodes.
std::uint32_t RadioField::measure_storeys(float edge_m) {
  std::uint32_t nodes = 0;
  for (Storey& storey : storeys_) {
    float low_x = INFINITY, low_y = INFINITY, high_x = -INFINITY, high_y = -INFINITY;
    for (std::uint32_t i = storey.begin; i < storey.end; ++i) {
      const BuildingPoint p = fingerprints_[i].place.point;
      low_x = std::min(low_x, static_cast<float>(p.x_m)), high_x = std::max(high_x, static_cast<float>(p.x_m));
      low_y = std::min(low_y, static_cast<float>(p.y_m)), high_y = std::max(high_y, static_cast<float>(p.y_m));
    }
    storey.x_m = low_x - edge_m - kLattice_m;
    storey.y_m = low_y - edge_m - kLattice_m;
    storey.columns = static_cast<int>((high_x + edge_m + kLattice_m - storey.x_m) / kLattice_m) + 2;
    storey.rows = static_cast<int>((high_y + edge_m + kLattice_m - storey.y_m) / kLattice_m) + 2;
    storey.first_node = nodes;
    nodes += static_cast<std::uint32_t>(storey.columns) * static_cast<std::uint32_t>(storey.rows);
  }
  return nodes;
}

// A node's kernel is as narrow as the bandwidth whoever is nearest; how much all of them weigh falls with the distance of the nearest.
void RadioField::lay_lattice() {
  const auto bandwidth_m = static_cast<float>(weights_.bandwidth_m), beyond_m = static_cast<float>(settings_.beyond_m);
  const float edge_m = kEdge * beyond_m;
  const float kernel_m2 = -2.0f * std::log(kLeastMass) * bandwidth_m * bandwidth_m;
  const std::uint32_t nodes = measure_storeys(edge_m);
  std::vector<float> nearest_m2(nodes, INFINITY);
  near_nodes(edge_m, [&](std::uint32_t node, std::uint32_t, float square_m2) { nearest_m2[node] = std::min(nearest_m2[node], square_m2); });
  const auto each_kernel = [&](const auto& each) {
    near_nodes(std::sqrt(edge_m * edge_m + kernel_m2), [&](std::uint32_t node, std::uint32_t fingerprint, float square_m2) {
      if (std::isfinite(nearest_m2[node]) && square_m2 - nearest_m2[node] < kernel_m2) each(node, fingerprint, square_m2);
    });
  };
  first_kernel_.assign(nodes + 1, 0);
  each_kernel([&](std::uint32_t node, std::uint32_t, float) { first_kernel_[node + 1]++; });
  for (std::size_t n = 1; n < first_kernel_.size(); ++n) first_kernel_[n] += first_kernel_[n - 1];
  kernels_.resize(first_kernel_.back());
  std::vector<std::uint32_t> next(first_kernel_.begin(), first_kernel_.end() - 1);
  each_kernel([&](std::uint32_t node, std::uint32_t fingerprint, float square_m2) {
    const float mass = std::exp(-(square_m2 - nearest_m2[node]) / (2.0f * bandwidth_m * bandwidth_m) - nearest_m2[node] / (2.0f * beyond_m * beyond_m));
    kernels_[next[node]++] = {fingerprint, mass};
  });
  count_crowds();
  const std::lock_guard lock(mutex_);
  spare_.clear();
}

// Of the node next to each: no more than 1.4 m off, where kernels are metres wide.
void RadioField::count_crowds() {
  std::vector<float> mass(nodes(), 0.0f);
  for (std::uint32_t node = 0; node < nodes(); ++node) {
    for (const Kernel& kernel : kernels(node)) mass[node] += kernel.mass;
  }
  crowd_.resize(fingerprints_.size());
  for (const Storey& storey : storeys_) {
    for (std::uint32_t i = storey.begin; i < storey.end; ++i) crowd_[i] = std::max(1.0f, mass[storey.node_near(fingerprints_[i].place.point).value()]);
  }
}

// The middle of the distances between unrelated places: what "no information" looks like in this building.
void RadioField::find_middles() {
  const auto scratch = borrow();
  std::vector<float> sorensen, cosine;
  for (Storey& storey : storeys_) {
    sorensen.clear(), cosine.clear();
    const std::uint32_t step = std::max<std::uint32_t>(1, (storey.end - storey.begin) / kMiddleSamples);
    for (std::uint32_t i = storey.begin; i < storey.end; i += step) {
      match(fingerprints_[i].heard, sum_[i], norm_[i], *scratch);
      for (std::uint32_t j = storey.begin; j < storey.end; ++j) {
        if (fingerprints_[j].walk == fingerprints_[i].walk) continue;
        sorensen.push_back(scratch->sorensen[j]);
        cosine.push_back(scratch->cosine[j]);
      }
    }
    storey.sorensen_middle = median(sorensen);
    storey.cosine_middle = median(cosine);
  }
}

void RadioField::match(std::span<const RadioStrength> heard, float sum, float norm, Scratch& scratch) const {
  std::ranges::fill(scratch.common, 0.0f);
  std::ranges::fill(scratch.product, 0.0f);
  for (const RadioStrength& level : heard) blocks_.add_overlaps_and_products(level.radio, level.strength, scratch.common, scratch.product);
  similarity_distances(sum, sum_, scratch.common, scratch.sorensen, norm, norm_, scratch.product, scratch.cosine);
  if (++scratch.scan == 0) {  // numbers ran out: no stale node may look fresh
    std::ranges::fill(scratch.known, 0u);
    scratch.scan = 1;
  }
}

void RadioField::expose(const Storey& storey, Scratch& scratch) const {
  const auto sorensen = static_cast<float>(settings_.sorensen_sharpness);
  const auto cosine = static_cast<float>(settings_.cosine_sharpness);
  for (std::uint32_t i = storey.begin; i < storey.end; ++i) {
    scratch.common[i] = std::exp(-sorensen * (scratch.sorensen[i] - storey.sorensen_middle));
    scratch.product[i] = std::exp(-cosine * (scratch.cosine[i] - storey.cosine_middle));
  }
}

RadioField::Pair RadioField::node(std::uint32_t number, const Scratch& scratch, int without_walk) const {
  const auto neutral = static_cast<float>(settings_.neutral);
  float mass = neutral, sorensen = neutral, cosine = neutral;
  if (without_walk < 0) {
    for (const Kernel& kernel : kernels(number)) {
      mass += kernel.mass;
      sorensen += kernel.mass * scratch.common[kernel.fingerprint];
      cosine += kernel.mass * scratch.product[kernel.fingerprint];
    }
  } else {
    for (const Kernel& kernel : kernels(number)) {
      if (walk_[kernel.fingerprint] == without_walk) continue;
      mass += kernel.mass;
      sorensen += kernel.mass * scratch.common[kernel.fingerprint];
      cosine += kernel.mass * scratch.product[kernel.fingerprint];
    }
  }
  return {std::log(sorensen / mass) / static_cast<float>(settings_.sorensen_sharpness),
          std::log(cosine / mass) / static_cast<float>(settings_.cosine_sharpness)};
}

bool RadioField::heard_near(std::uint32_t radio, const Storey& storey, BuildingPoint point, double around_m, float least_strength) const {
  bool heard = false;
  blocks_.for_each_level(radio, [&](std::uint32_t i, float strength) {
    heard = heard || (strength >= least_strength && i >= storey.begin && i < storey.surveyed_end &&
                      distance_m(fingerprints_[i].place.point, point) < around_m);
  });
  return heard;
}

std::optional<double> RadioField::loudness(std::span<const RadioStrength> heard, const Storey& storey, BuildingPoint point,
                                           int without_walk) const {
  double sum = 0.0;
  int count = 0;
  for (std::uint32_t i = storey.begin; i < storey.surveyed_end; ++i) {
    const SurveyFingerprint& there = fingerprints_[i];
    if (there.walk == without_walk || distance_m(there.place.point, point) > kAround_m) continue;
    double ours = 0.0, theirs = 0.0;
    int shared = 0;
    auto other = there.heard.begin();
    for (const RadioStrength& level : heard) {
      while (other != there.heard.end() && other->radio < level.radio) ++other;
      if (other == there.heard.end()) break;
      if (other->radio != level.radio) continue;
      ours += static_cast<double>(level.strength), theirs += static_cast<double>(other->strength);
      ++shared;
    }
    if (shared < kFewestShared) continue;
    sum += std::log(ours / theirs);
    ++count;
  }
  if (count < kFewestShared) return std::nullopt;
  return sum / count;
}

std::unique_ptr<RadioField::Scratch> RadioField::borrow() const {
  {
    const std::lock_guard lock(mutex_);
    if (!spare_.empty()) {
      auto scratch = std::move(spare_.back());
      spare_.pop_back();
      return scratch;
    }
  }
  auto scratch = std::make_unique<Scratch>();
  for (auto* column : {&scratch->common, &scratch->product, &scratch->sorensen, &scratch->cosine}) {
    column->resize(blocks_.padded());
  }
  scratch->level.resize(nodes());
  scratch->known.resize(nodes());
  return scratch;
}

void RadioField::give_back(std::unique_ptr<Scratch> scratch) const {
  const std::lock_guard lock(mutex_);
  if (spare_.size() < kMostSpare && scratch->known.size() == nodes()) spare_.push_back(std::move(scratch));
}

}  // namespace wayfuse
