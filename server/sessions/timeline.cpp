#include "server/sessions/timeline.hpp"

#include <algorithm>

namespace wayfuse {

PhoneTime time_of(const SampleBody& body) {
  return std::visit([](const auto& evidence) { return evidence.time; }, body);
}

Timeline::Timeline(std::unique_ptr<Tracker> tracker, Duration window) : window_(window), tracker_(std::move(tracker)) {
  copies_.push_back({applied_, tracker_->clone()});
}

bool Timeline::take(const Sample& sample) {
  const Key key{time_of(sample.body), sample.body.index(), sample.sequence};
  if ((newest_ && *newest_ - key.time > window_) || key < copies_.front().applied) return false;
  if (!newest_ || key.time > *newest_) newest_ = key.time;
  if (key < applied_) rewind_before(key);
  if (const auto* motion = std::get_if<MotionReport>(&sample.body)) insert(key, *motion);
  else if (const auto* scan = std::get_if<RssScan>(&sample.body)) insert(key, KeptScan(*scan));
  else insert(key, std::get<GnssFix>(sample.body));
  return true;
}

void Timeline::exchange(std::shared_ptr<const TrackerFactory> newer, Random random, std::uint64_t after) {
  insert({*newest_, std::variant_size_v<SampleBody>, after}, Exchange{std::move(newer), random});
}

void Timeline::insert(const Key& key, Kept body) {
  const auto place = std::ranges::upper_bound(evidence_, key, {}, &Evidence::key);
  readings_ += readings_in(*evidence_.insert(place, Evidence{key, std::move(body)}));
}

void Timeline::apply(const Evidence& evidence) {
  if (const auto* motion = std::get_if<MotionReport>(&evidence.body)) {
    tracker_->feed(*motion);
  } else if (const auto* scan = std::get_if<KeptScan>(&evidence.body)) {
    tracker_->feed(scan->scan());
  } else if (const auto* fix = std::get_if<GnssFix>(&evidence.body)) {
    tracker_->feed(*fix);
  } else {
    const Exchange& exchange = std::get<Exchange>(evidence.body);
    tracker_ = go_on(*exchange.newer, *tracker_, evidence.key.time, exchange.random);
  }
  applied_ = evidence.key;
}

std::size_t Timeline::readings_in(const Evidence& evidence) {
  const auto* scan = std::get_if<KeptScan>(&evidence.body);
  return 1 + (scan ? scan->readings() : 0);
}

void Timeline::catch_up() {
  auto next = std::ranges::upper_bound(evidence_, applied_, {}, &Evidence::key);
  for (; next != evidence_.end(); ++next) apply(*next);
  if (newest_ &&
      (copies_.back().applied.time == PhoneTime::min() || applied_.time - copies_.back().applied.time >= kCopyEvery)) {
    copies_.push_back({applied_, tracker_->clone()});
  }
  if (readings_ > kReadingsMost) {
    copies_.clear();
    copies_.push_back({applied_, tracker_->clone()});
  }
  forget();
}

std::unique_ptr<Timeline> Timeline::clone() const {
  auto copy = std::make_unique<Timeline>(tracker_->clone(), window_);
  copy->copies_.clear();
  for (const Copy& each : copies_) copy->copies_.push_back({each.applied, each.tracker->clone()});
  copy->applied_ = applied_;
  copy->newest_ = newest_;
  copy->evidence_ = evidence_;
  copy->readings_ = readings_;
  copy->rewinds_ = rewinds_;
  return copy;
}

std::size_t Timeline::bytes() const {
  constexpr std::size_t kWithoutParticles = 8192, kParticle = 32, kParticlesMost = 100'000;
  const std::size_t tracker = kWithoutParticles + kParticle * tracker_->cloud(kParticlesMost).size();
  std::size_t kept = evidence_.size() * sizeof(Evidence);
  for (const Evidence& each : evidence_) {
    if (const auto* scan = std::get_if<KeptScan>(&each.body)) kept += scan->bytes();
  }
  return tracker * (1 + copies_.size()) + kept;
}

void Timeline::rewind_before(const Key& key) {
  while (copies_.size() > 1 && copies_.back().applied > key) copies_.pop_back();
  tracker_ = copies_.back().tracker->clone();
  applied_ = copies_.back().applied;
  ++rewinds_;
}

// The oldest copy must precede every straggler still let in, and the evidence after it must be at hand.
void Timeline::forget() {
  if (!newest_) return;
  while (copies_.size() > 1 && copies_[1].applied.time < *newest_ - window_) copies_.pop_front();
  while (!evidence_.empty() && evidence_.front().key <= copies_.front().applied) {
    readings_ -= readings_in(evidence_.front());
    evidence_.pop_front();
  }
}

}  // namespace wayfuse
