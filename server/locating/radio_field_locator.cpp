#include "server/locating/radio_field_locator.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/locating/mean_of_smallest.hpp"

namespace wayfuse {
namespace {
constexpr double kStrongDbm = -50.0;
constexpr double kWellHeardDbm = -80.0;
constexpr double kAround_m = 25.0;
constexpr double kAtHomeDbm = -60.0;     // heard so loud by the survey, a radio stands near there
constexpr double kNeighbours_m = 45.0;   // between the homes of two radios that one phone can hear from close by
constexpr int kEnoughToPlace = 8;        // radios: a scan of fewer may lie anywhere
constexpr double kFitsWell = 1.4;        // mismatch: the place can be believed, and what is not at home around it told
constexpr double kFitsNothing = 2.2;     // the rest of such a scan denies nothing
constexpr std::size_t kFewestToDeny = 5; // weak radios that must speak before a strong one is denied
constexpr float kVagueDistance = 0.75f;  // Sorensen: the rest of the scan fits nothing and denies nothing
constexpr double kFaintest_db = 10.0;      // above -100 dBm: quieter scans say nothing about loudness
constexpr double kMostLouder_db = 10.0;    // of one scan
constexpr double kMostOffset_db = 12.0;
constexpr double kScanSigma_db = 8.0;      // of one scan's loudness; those of one walk err together
constexpr float kTogetherS = 0.5f;       // members of one radio heard within this are averaged
constexpr std::size_t kFloorVoters = 3;  // fingerprints that speak for a floor

}  // namespace

RadioFieldLocator::RadioFieldLocator(std::shared_ptr<const RadioField> field) : field_(std::move(field)) {}

RadioFieldLocator::RadioFieldLocator(const RadioFieldLocator& other)
    : field_(other.field_),
      scratch_(other.scratch_ ? std::make_unique<RadioField::Scratch>(*other.scratch_) : nullptr),
      misplaced_(other.misplaced_),
      sum_(other.sum_),
      norm_(other.norm_),
      exposed_(other.exposed_),
      best_(other.best_),
      floors_(other.floors_),
      known_(other.known_),
      unknown_(other.unknown_),
      heard_before_(other.heard_before_),
      mismatch_(other.mismatch_),
      offset_db_(other.offset_db_),
      offset_variance_db2_(other.offset_variance_db2_),
      level_db_(other.level_db_) {}

RadioFieldLocator::~RadioFieldLocator() { RadioFieldLocator::rest(); }

void RadioFieldLocator::rest() {
  if (scratch_) field_->give_back(std::move(scratch_));
}

// Readings to radios: members heard together are averaged, older ones of the same radio fall behind.
bool RadioFieldLocator::listen(const RssScan& scan) {
  const ReadingStrength& strength = field_->settings().strength;
  scratch_->rows.clear();
  for (const ScanReading& reading : scan.readings) {
    const double age_s = seconds(reading.age);
    if (age_s < 0.0 || age_s > strength.most_age_s || !std::isfinite(reading.rss_dbm)) continue;
    scratch_->rows.push_back({RadioNames::key(reading), static_cast<float>(age_s), static_cast<float>(reading.rss_dbm)});
  }
  std::ranges::sort(scratch_->rows, [](const auto& a, const auto& b) { return a.key != b.key ? a.key < b.key : a.age_s < b.age_s; });
  scratch_->heard.clear();
  scratch_->strong.clear();
  double sum = 0.0, squares = 0.0, ages = 0.0, levels = 0.0;
  known_ = unknown_ = 0;
  for (std::size_t begin = 0, end; begin < scratch_->rows.size(); begin = end) {
    double level = 0.0;
    int members = 0;
    for (end = begin; end < scratch_->rows.size() && scratch_->rows[end].key == scratch_->rows[begin].key; ++end) {
      if (scratch_->rows[end].age_s > scratch_->rows[begin].age_s + kTogetherS) continue;
      level += static_cast<double>(scratch_->rows[end].rss_dbm);
      ++members;
    }
    const double level_dbm = level / members - offset_db_;
    const float value = strength.of(level_dbm, static_cast<double>(scratch_->rows[begin].age_s));
    if (value <= 0.0f) continue;
    const auto radio = field_->radios().find(scratch_->rows[begin].key);
    if (level / members > kStrongDbm) {
      scratch_->strong.push_back(radio);
      if (!radio) continue;  // too strong to have been overlooked: new here, or a trick, and no evidence either way
    }
    sum += static_cast<double>(value);
    squares += static_cast<double>(value) * static_cast<double>(value);
    ages += static_cast<double>(value * scratch_->rows[begin].age_s);
    levels += static_cast<double>(value) * (level_dbm + 100.0);
    if (radio) {
      scratch_->heard.push_back({*radio, value});
      ++known_;
    } else {
      ++unknown_;
    }
  }
  sum_ = static_cast<float>(sum);
  norm_ = static_cast<float>(std::sqrt(squares));
  level_db_ = sum > 0.0 ? levels / sum : 0.0;
  if (sum > 0.0) heard_before_ = from_seconds(ages / sum - field_->weights().delay_s);
  return !scratch_->heard.empty();
}

// Strengths go with a power of the level: a ratio of them, small, is so many dB of the mean level.
void RadioFieldLocator::learn(const RssScan& /*scan*/, const Place& fused) {
  const RadioField::Storey* on = storey(fused.floor);
  if (!on || !scratch_ || level_db_ < kFaintest_db) return;
  const auto ratio = field_->loudness(scratch_->heard, *on, fused.point);
  if (!ratio) return;
  const double power = field_->settings().strength.power;
  const double louder_db = std::clamp(level_db_ * (*ratio - field_->weights().loudness) / power, -kMostLouder_db, kMostLouder_db);
  const double gain = offset_variance_db2_ / (offset_variance_db2_ + kScanSigma_db * kScanSigma_db);
  offset_db_ = std::clamp(offset_db_ + gain * louder_db, -kMostOffset_db, kMostOffset_db);
  offset_variance_db2_ *= 1.0 - gain;
}

void RadioFieldLocator::inherit(const Locator& older) {
  const auto* other = dynamic_cast<const RadioFieldLocator*>(&older);
  if (!other) return;
  offset_db_ = other->offset_db_;
  offset_variance_db2_ = other->offset_variance_db2_;
}

std::optional<Fix> RadioFieldLocator::locate(const RssScan& scan) {
  if (!scratch_) scratch_ = field_->borrow();
  if (!listen(scan)) {
    rest();
    return std::nullopt;
  }
  leave_out_misplaced();
  field_->match(scratch_->heard, sum_, norm_, *scratch_);
  exposed_.assign(field_->storeys().size(), 0);
  vote();
  const RadioField::Storey* best = storey(floors_.front().floor);
  double weight = 0.0, x = 0.0, y = 0.0, squares = 0.0;
  float highest = -INFINITY;
  for (std::uint32_t i = best->begin; i < best->end; ++i) highest = std::max(highest, resemblance(i));
  for (std::uint32_t i = best->begin; i < best->end; ++i) {
    const double share = std::exp(static_cast<double>(resemblance(i) - highest));
    const BuildingPoint p = field_->fingerprints()[i].place.point;
    weight += share, x += share * p.x_m, y += share * p.y_m, squares += share * (p.x_m * p.x_m + p.y_m * p.y_m);
  }
  x /= weight, y /= weight;
  const double spread = std::sqrt(std::max(0.0, (squares / weight - x * x - y * y) / 2.0));
  return Fix{{{x, y}, best->floor}, std::hypot(spread, field_->weights().bandwidth_m), known_};
}

float RadioFieldLocator::resemblance(std::uint32_t fingerprint) const {
  return -static_cast<float>(field_->weights().sorensen) * scratch_->sorensen[fingerprint] -
         static_cast<float>(field_->weights().cosine) * scratch_->cosine[fingerprint];
}

// A floor's score is the mean of its smallest cosine distances, unknown radios charged: in half-surveyed buildings wrong for half as many
// scans as Sorensen's. How well the scan fits at all is Sorensen's to say.
void RadioFieldLocator::vote() {
  floors_.clear();
  best_.clear();
  float fit = 1.0f;
  for (const RadioField::Storey& each : field_->storeys()) {
    const auto of_storey = [&](const std::vector<float>& distances) { return std::span(distances).subspan(each.begin, each.surveyed_end - each.begin); };
    fit = std::min(fit, mean_of_smallest<kFieldVoters>(of_storey(scratch_->sorensen)));
    best_.push_back(mean_of_smallest<kFloorVoters>(of_storey(scratch_->cosine)));
  }
  const float least = std::ranges::min(best_);
  mismatch_ = static_cast<double>(fit) / field_->weights().usual_distance;
  double total = 0.0;
  for (std::size_t s = 0; s < best_.size(); ++s) {
    const double vote = std::exp(-field_->settings().floor_gain * static_cast<double>(best_[s] - least));
    floors_.push_back({field_->storeys()[s].floor, vote});
    total += vote;
  }
  for (FloorProbability& each : floors_) each.probability /= total;
  most_probable_first(floors_);
}

const RadioField::Storey* RadioFieldLocator::storey(FloorOrdinal floor) const {
  const auto found = std::ranges::find(field_->storeys(), floor, &RadioField::Storey::floor);
  return found == field_->storeys().end() ? nullptr : &*found;
}

float RadioFieldLocator::node(const RadioField::Storey& storey, int column, int row) const {
  if (column < 0 || row < 0 || column >= storey.columns || row >= storey.rows) return 0.0f;  // neutral
  const auto number = storey.first_node + static_cast<std::uint32_t>(row * storey.columns + column);
  if (scratch_->known[number] != scratch_->scan) {
    const RadioField::Pair pair = field_->node(number, *scratch_);
    scratch_->level[number] = static_cast<float>(field_->weights().sorensen) * pair.sorensen +
                              static_cast<float>(field_->weights().cosine) * pair.cosine;
    scratch_->known[number] = scratch_->scan;
  }
  return scratch_->level[number];
}

void RadioFieldLocator::add_log_likelihood(std::span<const float> x_m, std::span<const float> y_m, FloorOrdinal floor,
                                           std::span<float> log_likelihood) const {
  const RadioField::Storey* on = storey(floor);
  if (!on || !scratch_) return;
  const auto number = static_cast<std::size_t>(on - field_->storeys().data());
  if (!exposed_[number]) {
    field_->expose(*on, *scratch_);
    exposed_[number] = 1;
  }
  for (std::size_t i = 0; i < x_m.size(); ++i) {
    const float x = (x_m[i] - on->x_m) / RadioField::kLattice_m;
    const float y = (y_m[i] - on->y_m) / RadioField::kLattice_m;
    if (!(x > -1.0f && y > -1.0f && x < static_cast<float>(on->columns) && y < static_cast<float>(on->rows))) continue;
    const auto column = static_cast<int>(std::floor(x));
    const auto row = static_cast<int>(std::floor(y));
    const float right = x - static_cast<float>(column);
    const float up = y - static_cast<float>(row);
    log_likelihood[i] += (1.0f - up) * ((1.0f - right) * node(*on, column, row) + right * node(*on, column + 1, row)) +
                         up * ((1.0f - right) * node(*on, column, row + 1) + right * node(*on, column + 1, row + 1));
  }
}

// A radio this strong stands within a few metres: whoever surveyed around the point must have heard it well.
int RadioFieldLocator::implausible(FloorOrdinal floor, BuildingPoint point) const {
  const RadioField::Storey* on = storey(floor);
  if (!on || !scratch_) return 0;
  const float least = field_->settings().strength.of(kWellHeardDbm, 0.0);
  const auto here = std::ranges::count_if(scratch_->strong, [&](const std::optional<std::uint32_t>& radio) {
    return !radio || !field_->heard_near(*radio, *on, point, kAround_m, least);
  });
  const auto unknown = std::ranges::count(scratch_->strong, std::optional<std::uint32_t>{});
  return static_cast<int>(std::max(here, unknown + misplaced_));
}

// Where nobody surveyed, strong radios are not at home around any match: that is the survey's fault, not theirs. But wherever that is,
// radios from close by are close to each other, and to the phone.
int RadioFieldLocator::out_of_place(FloorOrdinal floor, BuildingPoint point) const {
  if (!scratch_) return 0;
  const int apart = std::max(apart_from_each_other(), far_from_home(point));
  if (mismatch_ > kFitsNothing) return apart;
  const int unknown = static_cast<int>(std::ranges::count(scratch_->strong, std::optional<std::uint32_t>{}));
  return std::max(mismatch_ < kFitsWell ? implausible(floor, point) : unknown + misplaced_, unknown + apart);
}

bool RadioFieldLocator::settled(const std::optional<std::uint32_t>& radio) const {
  return radio && field_->home(*radio).strength >= field_->settings().strength.of(kAtHomeDbm, 0.0);
}

// Of the strong radios with a home: how many live too far from here to be heard from close by.
int RadioFieldLocator::far_from_home(BuildingPoint point) const {
  return static_cast<int>(std::ranges::count_if(
      scratch_->strong, [&](const auto& radio) { return settled(radio) && distance_m(field_->home(*radio).place.point, point) > kNeighbours_m; }));
}

// Of the strong radios with a home: how many are not of the largest group that can be neighbours.
int RadioFieldLocator::apart_from_each_other() const {
  std::ptrdiff_t largest = 0;
  for (const auto& radio : scratch_->strong) {
    if (!settled(radio)) continue;
    const BuildingPoint home = field_->home(*radio).place.point;
    largest = std::max(largest, std::ranges::count_if(scratch_->strong, [&](const auto& other) {
      return settled(other) && distance_m(field_->home(*other).place.point, home) <= kNeighbours_m;
    }));
  }
  return static_cast<int>(std::ranges::count_if(scratch_->strong, [&](const auto& radio) { return settled(radio); }) - largest);
}

std::optional<double> RadioFieldLocator::misfit(FloorOrdinal floor, BuildingPoint point) const {
  if (!scratch_ || known_ < kEnoughToPlace) return std::nullopt;
  float here = 2.0f, elsewhere = 2.0f;
  for (const RadioField::Storey& each : field_->storeys()) {
    for (std::uint32_t i = each.begin; i < each.surveyed_end; ++i) {
      const bool near = each.floor == floor && distance_m(field_->fingerprints()[i].place.point, point) < kAround_m;
      float& least = near ? here : elsewhere;
      least = std::min(least, scratch_->sorensen[i]);
    }
  }
  if (here > 1.5f || elsewhere > 1.5f) return std::nullopt;  // nobody surveyed here, or nowhere else
  return static_cast<double>(here - elsewhere);
}

// Leave-out consistency [SAFETY C26]: the scan is matched without its strong radios, and one that nobody heard well around any of
// the best matches is no evidence. A copied address cannot pull the phone to where its owner stands.
void RadioFieldLocator::leave_out_misplaced() {
  misplaced_ = 0;
  scratch_->set_aside.clear();
  const auto strong = [&](const RadioStrength& heard) { return std::ranges::find(scratch_->strong, std::optional(heard.radio)) != scratch_->strong.end(); };
  std::ranges::copy_if(scratch_->heard, std::back_inserter(scratch_->set_aside), strong);
  if (scratch_->set_aside.empty() || scratch_->heard.size() - scratch_->set_aside.size() < kFewestToDeny) return;
  std::erase_if(scratch_->heard, strong);
  float sum = sum_, squares = norm_ * norm_;
  for (const RadioStrength& each : scratch_->set_aside) sum -= each.strength, squares -= each.strength * each.strength;
  field_->match(scratch_->heard, sum, std::sqrt(std::max(squares, 1e-6f)), *scratch_);
  std::array<std::pair<float, std::uint32_t>, kFieldVoters> best;
  best.fill({2.0f, 0});
  for (const RadioField::Storey& each : field_->storeys()) {
    for (std::uint32_t i = each.begin; i < each.surveyed_end; ++i) {
      if (scratch_->sorensen[i] >= best.back().first) continue;
      best.back() = {scratch_->sorensen[i], i};
      for (std::size_t at = best.size() - 1; at > 0 && best[at] < best[at - 1]; --at) std::swap(best[at], best[at - 1]);
    }
  }
  const float least = field_->settings().strength.of(kWellHeardDbm, 0.0);
  for (const RadioStrength& each : scratch_->set_aside) {
    const bool belongs = best.front().first > kVagueDistance || std::ranges::any_of(best, [&](const auto& match) {
      const Place place = field_->fingerprints()[match.second].place;
      return match.first < 2.0f && field_->heard_near(each.radio, *storey(place.floor), place.point, kAround_m, least);
    });
    if (belongs) {
      scratch_->heard.push_back(each);
      sum += each.strength, squares += each.strength * each.strength;
    } else {
      ++misplaced_;
      --known_;
    }
  }
  std::ranges::sort(scratch_->heard, {}, &RadioStrength::radio);
  sum_ = sum;
  norm_ = std::sqrt(std::max(squares, 1e-6f));
}

// A fingerprint by its resemblance, then a step as far as its kernel reaches: what the field is made of, drawn directly.
bool RadioFieldLocator::draw(FloorOrdinal floor, Random& random, std::span<float> x_m, std::span<float> y_m) {
  const RadioField::Storey* on = storey(floor);
  if (!on || !scratch_) return false;
  float highest = -INFINITY;
  for (std::uint32_t i = on->begin; i < on->end; ++i) highest = std::max(highest, resemblance(i));
  std::vector<float>& cumulated = scratch_->cumulated;
  cumulated.clear();
  float total = 0.0f;
  for (std::uint32_t i = on->begin; i < on->end; ++i) cumulated.push_back(total += std::exp(resemblance(i) - highest) / field_->crowd(i));
  const double share = static_cast<double>(total) / static_cast<double>(x_m.size()), offset = random.uniform();
  std::uint32_t drawn = 0;
  for (std::size_t k = 0; k < x_m.size(); ++k) {
    const auto sought = static_cast<float>((static_cast<double>(k) + offset) * share);
    while (cumulated[drawn] < sought && drawn + 1 < cumulated.size()) ++drawn;
    const BuildingPoint p = field_->fingerprints()[on->begin + drawn].place.point;
    x_m[k] = static_cast<float>(p.x_m + field_->weights().bandwidth_m * random.normal());
    y_m[k] = static_cast<float>(p.y_m + field_->weights().bandwidth_m * random.normal());
  }
  return true;
}

}  // namespace wayfuse
