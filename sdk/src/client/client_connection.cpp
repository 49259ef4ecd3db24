// The life of connections: connect, greet, watch, lose, back off, leave, end.
#include <algorithm>
#include <cmath>

#include "sdk/src/client/client_state.hpp"

namespace wayfuse {
namespace {

constexpr Duration kSteady = std::chrono::seconds(5);    // a connection that lived so long was a good one
constexpr Duration kRingMost = std::chrono::minutes(5);  // no server makes us keep samples longer
constexpr Duration kTokenLifeMost = std::chrono::hours(24 * 30);
constexpr Duration kSilenceMost = std::chrono::minutes(10);

}  // namespace

std::uint64_t Client::State::after(Duration delay, void (State::*task)()) {
  return scheduler_.after(delay, [weak = weak_from_this(), task] {
    if (const auto self = weak.lock()) (self.get()->*task)();
  });
}

void Client::State::cancel(std::optional<std::uint64_t>& timer) {
  if (timer) scheduler_.cancel(*timer);
  timer.reset();
}

void Client::State::enter(ClientState next) {
  if (state_ == next) return;
  state_ = next;
  if (events_.state_changed) events_.state_changed(next);
}

void Client::State::connect() {
  cancel(back_off_timer_);
  const std::uint64_t generation = ++generation_;
  retry_after_ = Duration{0};
  leave_at_.reset();
  hold_until_.reset();
  replaying_ = false;
  gaps_in_a_row_ = 0;
  enter(ClientState::kConnecting);
  if (generation_ != generation || state_ != ClientState::kConnecting) return;  // the application stopped us just now
  outbox_.evict(scheduler_.now());
  report_lost();
  if (generation_ != generation) return;
  token_ = settings_.token ? settings_.token() : std::string();
  link_ = links_();
  if (!link_) return lost_link("no link could be made");
  watch(settings_.connect_most, "connecting took too long");
  link_->open({guarded(&State::opened), guarded(&State::received), guarded(&State::lost_link), guarded(&State::heard)});
}

void Client::State::opened(Encoding used) {
  if (state_ != ClientState::kConnecting) return;
  encoding_ = used;
  const std::uint64_t generation = generation_;
  enter(ClientState::kGreeting);
  if (generation_ != generation) return;
  watch(settings_.greeting_most, "the server did not answer hello");
  Hello hello{settings_.role, settings_.building, token_,           settings_.device_model,
              settings_.app,  settings_.pipeline, scheduler_.now(), std::nullopt};
  outbox_.hold_still(true);
  resuming_ = settings_.role == Role::kTrack && !session_.empty();
  if (resuming_) hello.resume = Resume{session_, epoch_, outbox_.ask_resume(), ticket_};
  if (!put(hello) && generation_ == generation) drop_link("the link took no hello");
}

void Client::State::on(const Welcome& welcome) {
  if (state_ == ClientState::kStreaming) {  // the building was resolved, or its map renewed
    if (welcome.session != session_) return distrust(FaultCode::kUnexpectedMessage, "session", "another one in mid-stream");
    if (!outbox_.acknowledge(welcome.applied_through)) {
      return distrust(FaultCode::kOutOfRange, "applied_through", "beyond what was sent");
    }
    epoch_ = welcome.epoch;
    const std::uint64_t generation = generation_;
    renew_token_after(welcome.token_expires_in);
    if (events_.welcomed) events_.welcomed(welcome);
    if (generation_ == generation) arm_flush();
    return;
  }
  if (state_ != ClientState::kGreeting) return;
  if (resuming_) {
    if (welcome.recovered && welcome.session != session_) {
      return distrust(FaultCode::kUnexpectedMessage, "session", "recovered, but another one");
    }
    if (!outbox_.resume_session(welcome.recovered, welcome.applied_through)) {
      return distrust(FaultCode::kOutOfRange, "applied_through", "the session cannot go on from there");
    }
    if (!welcome.recovered) ticket_.clear();
  } else {
    if (welcome.applied_through != 0) return distrust(FaultCode::kOutOfRange, "applied_through", "not 0 in a new session");
    outbox_.begin_session();
    ticket_.clear();
  }
  session_ = welcome.session;
  epoch_ = welcome.epoch;
  welcomed(welcome);
}

void Client::State::welcomed(const Welcome& welcome) {
  const std::uint64_t generation = generation_;
  outbox_.keep_for(std::max(settings_.sample_ring, std::min(welcome.sample_ring, kRingMost)));
  settings_.silence_most =
      std::max(settings_.silence_most, std::min(3 * std::min(welcome.keep_alive, kSilenceMost), kSilenceMost));
  streaming_since_ = scheduler_.now();
  token_refusals_ = 0;
  replaying_ = outbox_.has_unsent();
  outbox_.hold_still(replaying_);
  last_heard_ = progress_at_ = scheduler_.now();
  watch_silence();
  enter(ClientState::kStreaming);
  if (generation_ == generation) renew_token_after(welcome.token_expires_in);
  if (generation_ == generation && events_.welcomed) events_.welcomed(welcome);
  if (generation_ == generation) report_lost();
  if (generation_ == generation && subscription_) put(*subscription_);
  if (generation_ == generation) flush();
}

void Client::State::watch(Duration delay, const char* reason) {
  cancel(deadline_timer_);
  deadline_timer_ = scheduler_.after(delay, [weak = weak_from_this(), reason] {
    const auto self = weak.lock();
    if (!self) return;
    self->deadline_timer_.reset();
    self->drop_link(reason);
  });
}

/// Half the patience gone: ask. All of it: the link is dead. A heard frame only notes the time, so that no timer is set a
/// frame.
void Client::State::watch_silence() {
  cancel(deadline_timer_);
  const Duration quiet = scheduler_.now() - last_heard_;
  if (quiet >= settings_.silence_most) return drop_link("the server fell silent");
  if (acks_stay_out()) return drop_link("samples are sent and none is acknowledged");
  const Duration half = settings_.silence_most / 2;
  if (quiet >= half) put(ClockProbe{scheduler_.now()});
  if (!link_) return;
  deadline_timer_ = after(quiet >= half ? settings_.silence_most - quiet : half - quiet, &State::watch_silence);
}

void Client::State::heard() {
  last_heard_ = scheduler_.now();
}

/// A fresh token goes up while the old one still has a tenth of its life left.
void Client::State::renew_token_after(Duration expires_in) {
  cancel(token_timer_);
  if (expires_in <= Duration{0} || !settings_.token) return;
  token_timer_ = after(std::min(expires_in, kTokenLifeMost) * 9 / 10, &State::renew_token);
}

void Client::State::renew_token() {
  token_timer_.reset();
  if (state_ != ClientState::kStreaming) return;
  const std::uint64_t generation = generation_;
  std::string fresh = settings_.token();
  if (generation_ != generation) return;
  token_ = std::move(fresh);
  put(TokenRefresh{token_});
}

// A link is never destroyed under its own feet: it may be in the middle of calling us.
void Client::State::bury_link() {
  ++generation_;
  cancel(deadline_timer_);
  cancel(leave_timer_);
  cancel(flush_timer_);
  cancel(token_timer_);
  if (!link_) return;
  scheduler_.after(Duration{0}, [link = std::shared_ptr<Link>(std::move(link_))] {});
}

// What was on the way counts as not sent.
void Client::State::forget_transit() {
  outbox_.hold_still(false);
  outbox_.rewind();
  uploads_.rewind();
}

void Client::State::drop_link(std::string_view reason) {
  const std::string kept(reason);
  if (link_) link_->close();
  lost_link(kept);
}

void Client::State::lost_link(std::string_view reason) {
  if (state_ == ClientState::kEnded || state_ == ClientState::kIdle) return;
  const std::string kept(reason);  // the link may own it
  bury_link();
  if (state_ == ClientState::kStreaming && scheduler_.now() - streaming_since_ >= kSteady) attempt_ = 0;
  forget_transit();
  const std::uint64_t generation = generation_;
  if (events_.disconnected) events_.disconnected(kept);
  if (generation_ == generation && state_ != ClientState::kEnded) back_off(next_delay());
}

/// Full jitter: uniform between nothing and a ceiling that doubles. The server's own wish comes on top.
Duration Client::State::next_delay() {
  if (leave_at_) return std::max(Duration{0}, *leave_at_ - scheduler_.now());
  const double most = seconds(settings_.back_off_most);
  const double ceiling = std::min(most, seconds(settings_.back_off_first) * std::ldexp(1.0, std::min(attempt_, 30)));
  ++attempt_;
  return retry_after_ + from_seconds(random_.uniform() * ceiling);
}

void Client::State::back_off(Duration delay) {
  const std::uint64_t generation = generation_;
  enter(ClientState::kBackingOff);
  if (generation_ == generation && state_ == ClientState::kBackingOff) back_off_timer_ = after(delay, &State::connect);
}

void Client::State::network_changed() {
  if (state_ == ClientState::kIdle || state_ == ClientState::kEnded) return;
  if (state_ != ClientState::kBackingOff) {
    if (link_) link_->close();
    bury_link();
    forget_transit();
  } else if (retry_after_ > Duration{0}) {
    return;  // the server asked for patience; another network does not change that
  }
  attempt_ = 0;
  connect();
}

void Client::State::end() {
  if (link_) link_->close();
  bury_link();
  cancel(back_off_timer_);
  session_.clear();
  forget_transit();
  enter(ClientState::kEnded);
}

void Client::State::abandon() {
  if (link_) link_->close();
  bury_link();
  cancel(back_off_timer_);
  state_ = ClientState::kEnded;
}

}  // namespace wayfuse
