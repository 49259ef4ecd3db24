#include "sdk/src/client/outbox.hpp"

#include <algorithm>

namespace wayfuse {
namespace {

constexpr Duration kRestMost = std::chrono::seconds(4);  // beyond 5 s without news a server widens its doubt
constexpr Duration kSeam = std::chrono::milliseconds(50);

const RssScan* scan_of(const SampleBody& body) { return std::get_if<RssScan>(&body); }

std::size_t memory_bytes(const SampleBody& body) {
  const RssScan* scan = scan_of(body);
  return 64 + sizeof(SampleBody) + (scan ? scan->readings.capacity() * sizeof(ScanReading) : 0);
}

// An upper guess of its JSON spelling; the frame itself is measured after encoding.
std::size_t wire_bytes(const SampleBody& body) {
  const RssScan* scan = scan_of(body);
  return scan ? 64 + scan->readings.size() * 120 : 420;
}

bool at_rest(const SampleBody& body) {
  const MotionReport* motion = std::get_if<MotionReport>(&body);
  return motion && motion->at_rest;
}

}  // namespace

/// Lying on a table for an hour is a sample every four seconds, not every half.
bool Outbox::merge_rest(const SampleBody& body) {
  if (kept_.empty() || last_ <= ever_sent_ || !at_rest(body) || !at_rest(kept_.back().body)) return false;
  MotionReport& before = std::get<MotionReport>(kept_.back().body);
  const MotionReport& after = std::get<MotionReport>(body);
  const Duration together = after.time - (before.time - before.interval);
  const bool seamless = after.time > before.time && after.time - after.interval <= before.time + kSeam;
  if (!seamless || together > kRestMost || before.steps > 0 || after.steps > 0 || before.reference != after.reference ||
      before.climb_m || after.climb_m) {
    return false;
  }
  const double turned = seconds(before.interval) * before.turn_rate_radps + seconds(after.interval) * after.turn_rate_radps;
  before = after;
  before.interval = together;
  before.turn_rate_radps = turned / seconds(together);
  return true;
}

std::uint64_t Outbox::push(SampleBody body, PhoneTime now) {
  if (merge_rest(body)) return last_;
  const std::size_t bytes = memory_bytes(body);
  kept_.push_back({++last_, std::move(body), now, bytes});
  bytes_ += bytes;
  evict(now);
  return last_;
}

void Outbox::pop() {
  bytes_ -= kept_.front().bytes;
  kept_.pop_front();
}

void Outbox::lose(std::uint64_t first, std::uint64_t last) {
  if (first > last) return;
  if (!lost_.empty() && lost_.back().second + 1 == first) {
    lost_.back().second = last;
  } else {
    lost_.emplace_back(first, last);
  }
}

void Outbox::evict(PhoneTime now) {
  const auto too_old = [&](const Kept& kept) { return !still_ && now - kept.queued_at > keep_; };
  while (!kept_.empty() && (too_old(kept_.front()) || bytes_ > bytes_most_)) {
    const std::uint64_t number = kept_.front().number;
    if (number > ever_sent_) lose(number, number);
    pop();
  }
}

bool Outbox::only_rest_unsent() const {
  const std::size_t unsent = std::min<std::size_t>(kept_.size(), last_ - sent_);
  return std::all_of(kept_.end() - static_cast<std::ptrdiff_t>(unsent), kept_.end(),
                     [](const Kept& kept) { return at_rest(kept.body); });
}

void Outbox::begin_session() {
  lose(acked_ + 1, std::min(ever_sent_, first() - 1));
  base_ = acked_ = sent_ = ever_sent_ = first() - 1;
}

bool Outbox::resume_session(bool whole, std::uint64_t applied) {
  if (applied < asked_) return false;
  if (!whole) {
    if (applied > asked_) return false;
    lose(acked_ + 1, std::min(ever_sent_, first() - 1));
    acked_ = sent_ = ever_sent_ = base_ + asked_;
    return true;
  }
  if (!acknowledge(applied)) return false;
  rewind();
  return true;
}

bool Outbox::acknowledge(std::uint64_t wire) {
  if (wire > ever_sent_ - base_) return false;
  acked_ = std::max(acked_, base_ + wire);
  sent_ = std::max(sent_, acked_);  // an acknowledgement may overtake a rewind
  while (!kept_.empty() && kept_.front().number <= acked_) pop();
  return true;
}

SampleBatch Outbox::next(std::size_t samples, std::size_t bytes) const {
  SampleBatch batch;
  if (broken()) return batch;
  for (std::size_t at = sent_ + 1 - first(); at < kept_.size() && batch.samples.size() < samples; ++at) {
    const std::size_t size = wire_bytes(kept_[at].body);
    if (size > bytes && !batch.samples.empty()) break;
    batch.samples.push_back({kept_[at].number - base_, kept_[at].body});
    bytes -= std::min(size, bytes);
  }
  return batch;
}

void Outbox::mark_sent(std::size_t samples) {
  sent_ += samples;
  ever_sent_ = std::max(ever_sent_, sent_);
}

std::optional<Outbox::Range> Outbox::take_lost() {
  if (lost_.empty()) return std::nullopt;
  const Range range = lost_.front();
  lost_.pop_front();
  return range;
}

}  // namespace wayfuse
