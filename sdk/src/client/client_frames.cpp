// Frames in: every one is somebody else's word, believed as far as it can be true.
#include <algorithm>

#include "sdk/src/client/client_state.hpp"
#include "wayfuse/proto/codec.hpp"

namespace wayfuse {
namespace {

constexpr Duration kWaitMost = std::chrono::minutes(5);    // whatever a server asks for
constexpr Duration kLeaveMost = std::chrono::minutes(10);
constexpr int kGapsMost = 3;

Duration bounded(Duration wait, Duration most) { return std::clamp(wait, Duration{0}, most); }

// The batch is sound and may be stored another time; everything else will never be.
bool passes(FaultCode code) {
  switch (code) {
    case FaultCode::kRateLimited:
    case FaultCode::kOverloaded:
    case FaultCode::kDraining:
    case FaultCode::kTimeout:
    case FaultCode::kStorageFull:
    case FaultCode::kStorageFailed:
    case FaultCode::kStoreBusy:
    case FaultCode::kStoreTooNew:
    case FaultCode::kStoreCorrupt:
    case FaultCode::kInternal:
      return true;
    default:
      return false;
  }
}

}  // namespace

void Client::State::received(std::string_view frame) {
  heard();
  if (state_ != ClientState::kGreeting && state_ != ClientState::kStreaming) return;
  if (frame.size() > Limits::kMessageBytes) {
    return distrust(FaultCode::kTooLarge, "", std::to_string(frame.size()) + " bytes in one frame");
  }
  auto message = decode_server_message(frame, encoding_);
  if (message) return std::visit([this](const auto& body) { on(body); }, message.value());
  if (message.fault().code != FaultCode::kUnknownType) {  // a newer server's word is none of ours
    return distrust(message.fault().code, message.fault().field, message.fault().cause);
  }
}

/// The server said what cannot be: tell, leave, and take nothing of it along but the samples.
void Client::State::distrust(FaultCode code, std::string field, std::string cause) {
  const std::uint64_t generation = generation_;
  const FaultReport report{{code, std::move(field), std::move(cause)}, 0, {}, Duration{0}};
  session_.clear();
  if (events_.fault) events_.fault(report);
  if (generation_ == generation) drop_link("the server broke the protocol: " + to_string(report.fault));
}

void Client::State::on(const Ack& ack) {
  if (state_ != ClientState::kStreaming || ack.epoch != epoch_) return;
  const std::uint64_t before = outbox_.acked();
  if (!outbox_.acknowledge(ack.through)) return distrust(FaultCode::kOutOfRange, "through", "beyond what was sent");
  if (outbox_.acked() == before) return;
  gaps_in_a_row_ = 0;
  progress_at_ = scheduler_.now();
  if (replaying_) flush();
}

void Client::State::on(const SurveyAck& ack) {
  if (state_ != ClientState::kStreaming || !uploads_.settle(ack.idempotency_key)) return;
  const std::uint64_t generation = generation_;
  if (events_.survey_stored) events_.survey_stored(ack);
  if (generation_ != generation || hold_until_) return;
  flush_uploads();
  if (generation_ == generation) arm_flush();
}

void Client::State::on(const Position& position) {
  if (state_ != ClientState::kStreaming || !events_.position) return;
  Position told = position;
  told.applied_through = outbox_.own(position.applied_through);
  events_.position(told);
}

void Client::State::on(const NoFix& no_fix) {
  if (state_ == ClientState::kStreaming && events_.no_fix) events_.no_fix(no_fix);
}

void Client::State::on(const Observation& observation) {
  if (state_ == ClientState::kStreaming && events_.observed) events_.observed(observation);
}

void Client::State::on(const ZoneEvent& event) {
  if (state_ == ClientState::kStreaming && events_.zone_crossed) events_.zone_crossed(event);
}

void Client::State::on(const TokenAccepted& accepted) {
  if (state_ == ClientState::kStreaming) renew_token_after(accepted.expires_in);
}

void Client::State::on(const ClockAnswer& answer) {
  if (state_ == ClientState::kStreaming && events_.clock) events_.clock(answer);
}

void Client::State::on(const ScanHint& hint) {
  if (state_ == ClientState::kStreaming && events_.scan_hint) events_.scan_hint(hint);
}

void Client::State::on(const Ticket& ticket) {
  if (state_ == ClientState::kStreaming) ticket_ = ticket.sealed;
}

void Client::State::on(const FaultReport& report) {
  const std::uint64_t generation = generation_;
  FaultReport told = report;
  told.sequence = outbox_.own(report.sequence);
  if (events_.fault) events_.fault(told);
  if (generation_ != generation) return;
  if (!report.idempotency_key.empty()) {
    upload_refused(report);
  } else {
    refused_by_server(report);
  }
  if (generation_ != generation || face_of(report.fault.code).close_code == 0) return;
  retry_after_ = bounded(report.retry_after, kWaitMost);
  drop_link(to_string(report.fault));
}

void Client::State::upload_refused(const FaultReport& report) {
  if (!passes(report.fault.code)) {
    uploads_.settle(report.idempotency_key);
  } else {
    const Duration wait = std::max(bounded(report.retry_after, kWaitMost), settings_.batch_interval);
    uploads_.retry(report.idempotency_key, scheduler_.now() + wait);
  }
  arm_flush();
}

void Client::State::refused_by_server(const FaultReport& report) {
  switch (report.fault.code) {
    case FaultCode::kSequenceGap:
      return gap_reported();
    case FaultCode::kRateLimited:
    case FaultCode::kOverloaded:
      return hold(bounded(report.retry_after, kWaitMost));
    case FaultCode::kNotAuthenticated:  // the next connection asks for a fresh token
      if (++token_refusals_ >= settings_.token_refusals_most) end();
      return;
    case FaultCode::kNotAllowed:
    case FaultCode::kUnknownBuilding:
    case FaultCode::kUnknownName:
    case FaultCode::kUnsupportedVersion:
      if (state_ == ClientState::kGreeting) end();  // asking again would be answered again
      return;
    default:
      return;
  }
}

/// The server misses samples: send again from the last acknowledged one. Several reports of one gap count once.
void Client::State::gap_reported() {
  if (state_ != ClientState::kStreaming || outbox_.nothing_on_the_way()) return;
  if (++gaps_in_a_row_ > kGapsMost) {
    session_.clear();
    return drop_link("sending again does not close the gap: a new session begins");
  }
  outbox_.rewind();
  replaying_ = true;
  arm_flush();
}

/// Not so fast: what was refused goes out again after the pause, duplicates are harmless.
void Client::State::hold(Duration wait) {
  if (state_ != ClientState::kStreaming) return;
  const Duration pause = std::max(wait, settings_.batch_interval);
  hold_until_ = scheduler_.now() + pause;
  progress_at_ += pause;  // what the server asked for is not held against it; nor does asking wipe out what it owes
  outbox_.rewind();
  cancel(flush_timer_);
  arm_flush();
}

void Client::State::on(const GoAway& go_away) {
  const Duration within = bounded(go_away.within, kLeaveMost);
  const PhoneTime at = scheduler_.now() + from_seconds(random_.uniform() * seconds(within));
  if (leave_at_ && *leave_at_ <= at) return;
  leave_at_ = at;
  cancel(leave_timer_);
  leave_timer_ = scheduler_.after(at - scheduler_.now(), [weak = weak_from_this()] {
    if (const auto self = weak.lock()) self->drop_link("the server asked to leave");
  });
}

}  // namespace wayfuse
