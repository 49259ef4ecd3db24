// Frames out: samples a batch a second, uploads as they are due, never beyond what the link takes.
#include <algorithm>

#include "sdk/src/client/client_state.hpp"
#include "wayfuse/proto/codec.hpp"

namespace wayfuse {
namespace {

constexpr int kFramesAtOnce = 8;                  // of a replay, before the server answered
constexpr std::size_t kBatchBytes = 48 * 1024;    // by estimate; the limit is 64 KiB

}  // namespace

bool Client::State::put(const ClientMessage& message) { return link_ && link_->send(encode(message, encoding_)); }

void Client::State::report_lost() {
  const std::uint64_t generation = generation_;
  while (generation_ == generation) {
    const auto lost = outbox_.take_lost();
    if (!lost) return;
    if (events_.samples_lost) events_.samples_lost(lost->first, lost->second);
  }
}

void Client::State::arm_flush() {
  if (state_ != ClientState::kStreaming) return;
  std::optional<PhoneTime> at;
  if (outbox_.has_unsent()) {
    const bool hurried = replaying_ || !outbox_.only_rest_unsent();
    at = last_flush_ + (hurried ? settings_.batch_interval : settings_.rest_interval);
  }
  if (const auto due = uploads_.due()) {
    const PhoneTime upload_at = std::max(*due, last_flush_ + settings_.batch_interval);
    at = at ? std::min(*at, upload_at) : upload_at;
  }
  if (!at) return;
  if (hold_until_) at = std::max(*at, *hold_until_);
  at = std::max(*at, scheduler_.now());
  if (flush_timer_ && flush_at_ <= at) return;
  cancel(flush_timer_);
  flush_at_ = at;
  flush_timer_ = after(*at - scheduler_.now(), &State::flush);
}

void Client::State::flush() {
  cancel(flush_timer_);
  if (state_ != ClientState::kStreaming) return;
  const std::uint64_t generation = generation_;
  outbox_.evict(scheduler_.now());
  report_lost();
  if (generation_ != generation) return;
  if (hold_until_ && *hold_until_ > scheduler_.now()) return arm_flush();
  hold_until_.reset();
  if (outbox_.broken()) {
    return drop_link("samples were dropped unsent: this session cannot go on, a new one begins");
  }
  if (acks_stay_out()) return drop_link("samples are sent and none is acknowledged");
  last_flush_ = scheduler_.now();
  if (outbox_.all_acknowledged()) progress_at_ = last_flush_;
  if (flush_samples()) flush_uploads();
  if (generation_ == generation) arm_flush();
}

bool Client::State::acks_stay_out() const {
  return !outbox_.nothing_on_the_way() && scheduler_.now() - progress_at_ > settings_.ack_most;
}

/// False = the link takes no more, or is gone.
bool Client::State::flush_samples() {
  const std::uint64_t generation = generation_;
  for (int frames = 0; frames < kFramesAtOnce && outbox_.has_unsent(); ++frames) {
    SampleBatch batch = outbox_.next(Limits::kSamplesPerBatch, kBatchBytes);
    if (batch.samples.empty()) return true;
    std::string frame = encode(ClientMessage(batch), encoding_);
    while (frame.size() > Limits::kMessageBytes && batch.samples.size() > 1) {
      batch.samples.resize(batch.samples.size() / 2);
      frame = encode(ClientMessage(batch), encoding_);
    }
    outbox_.mark_sent(batch.samples.size());  // before sending: the answer may come from inside
    if (!link_->send(std::move(frame))) {
      if (generation_ == generation) outbox_.unsend(batch.samples.size());
      return false;
    }
    if (generation_ != generation) return false;
  }
  if (!outbox_.has_unsent()) {
    replaying_ = false;
    outbox_.hold_still(false);
  }
  return true;
}

bool Client::State::flush_uploads() {
  const std::uint64_t generation = generation_;
  while (const SurveyUpload* upload = uploads_.next(scheduler_.now())) {
    const std::string key = key_of(*upload);
    if (!put(std::visit([](const auto& body) { return ClientMessage(body); }, *upload))) {
      if (generation_ == generation) uploads_.unsend(key);
      return false;
    }
    if (generation_ != generation) return false;
  }
  return true;
}

}  // namespace wayfuse
