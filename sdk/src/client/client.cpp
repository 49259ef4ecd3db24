#include "wayfuse/sdk/client.hpp"

#include "sdk/src/client/client_state.hpp"
#include "wayfuse/proto/codec.hpp"

namespace wayfuse {
namespace {

constexpr std::size_t kReadingsSurelyFit = 256;  // of a JSON frame; above, the frame is measured

Result<void> check_sample(const SampleBody& body) {
  if (const auto* motion = std::get_if<MotionReport>(&body)) return check(*motion, "motion");
  if (const auto* fix = std::get_if<GnssFix>(&body)) return check(*fix, "gnss");
  const RssScan& scan = std::get<RssScan>(body);
  if (auto checked = check(scan, "scan"); !checked) return checked;
  if (scan.readings.size() <= kReadingsSurelyFit) return {};
  const std::size_t bytes = encode(ClientMessage(SampleBatch{{{~0ull, body}}}), Encoding::kJson).size();
  if (bytes <= Limits::kMessageBytes) return {};
  return Fault{FaultCode::kTooLarge, "scan.readings", std::to_string(bytes) + " bytes as JSON, at most " +
                                                          std::to_string(Limits::kMessageBytes)};
}

Fault wrong_role(const char* what) { return {FaultCode::kUnexpectedMessage, "", std::string(what) + " in this client's role"}; }

}  // namespace

Client::State::State(ClientSettings settings, ClientEvents events, LinkFactory links, Scheduler& scheduler, Random random)
    : settings_(std::move(settings)),
      events_(std::move(events)),
      links_(std::move(links)),
      scheduler_(scheduler),
      random_(random),
      outbox_(settings_.sample_ring, settings_.sample_bytes_most),
      uploads_(settings_.uploads_most, settings_.upload_patience) {}

Result<void> Client::State::send(SampleBody sample) {
  if (settings_.role != Role::kTrack) return wrong_role("no samples");
  if (state_ == ClientState::kEnded) return Fault{FaultCode::kUnexpectedMessage, "", "the client has ended"};
  if (auto* scan = std::get_if<RssScan>(&sample)) keep_youngest(*scan, Limits::kReadingsPerScan);
  if (auto checked = check_sample(sample); !checked) return checked;
  outbox_.push(std::move(sample), scheduler_.now());
  arm_flush();
  return {};
}

Result<void> Client::State::upload(SurveyUpload upload) {
  if (settings_.role != Role::kSurvey) return wrong_role("no uploads");
  if (auto queued = uploads_.push(std::move(upload)); !queued) return queued;
  arm_flush();
  return {};
}

Result<void> Client::State::subscribe(Subscribe subscription) {
  if (settings_.role != Role::kObserve) return wrong_role("no subscriptions");
  if (auto checked = check(ClientMessage(subscription)); !checked) return checked;
  subscription_ = std::move(subscription);
  if (state_ == ClientState::kStreaming) put(*subscription_);
  return {};
}

void Client::State::stop() {
  if (state_ == ClientState::kIdle || state_ == ClientState::kEnded) return;
  if (state_ == ClientState::kStreaming) {
    const std::uint64_t generation = generation_;
    flush_samples();
    if (generation_ == generation) put(Goodbye{"the application stopped"});
  }
  end();
}

Client::Client(ClientSettings settings, ClientEvents events, LinkFactory links, Scheduler& scheduler, Random random)
    : state_(std::make_shared<State>(std::move(settings), std::move(events), std::move(links), scheduler, random)) {}

Client::~Client() { state_->abandon(); }

void Client::start() {
  const auto self = state_;
  if (self->state_ != ClientState::kIdle && self->state_ != ClientState::kEnded) return;
  self->attempt_ = 0;
  self->token_refusals_ = 0;
  self->connect();
}

Result<void> Client::send(SampleBody sample) { return state_->send(std::move(sample)); }
Result<void> Client::upload(SurveyUpload upload) { return state_->upload(std::move(upload)); }
Result<void> Client::subscribe(Subscribe subscription) { return state_->subscribe(std::move(subscription)); }

void Client::network_changed() {
  const auto self = state_;
  self->network_changed();
}

void Client::stop() {
  const auto self = state_;
  self->stop();
}

ClientState Client::state() const { return state_->state_; }
std::uint64_t Client::last_sequence() const { return state_->outbox_.last(); }
std::uint64_t Client::acked_through() const { return state_->outbox_.acked(); }
std::size_t Client::uploads_waiting() const { return state_->uploads_.size(); }

}  // namespace wayfuse
