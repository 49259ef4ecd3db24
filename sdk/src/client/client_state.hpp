#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "sdk/src/client/outbox.hpp"
#include "sdk/src/client/upload_queue.hpp"
#include "wayfuse/sdk/client.hpp"

namespace wayfuse {

/// The state machine behind Client. Kept alive by its own callbacks; every timer and link event holds it weakly.
///
///   kIdle -> kConnecting -> kGreeting -> kStreaming
///               ^ \____________|____________|____ the link closed, a deadline passed, the server said so
///               |________ kBackingOff <__/           stop(), refused for good: -> kEnded
struct Client::State : std::enable_shared_from_this<Client::State> {
  State(ClientSettings settings, ClientEvents events, LinkFactory links, Scheduler& scheduler, Random random);

  // client.cpp: what the application asks
  Result<void> send(SampleBody sample);
  Result<void> upload(SurveyUpload upload);
  Result<void> subscribe(Subscribe subscription);
  void stop();
  void abandon();  // the client object goes away

  // client_connection.cpp: the life of connections
  void connect();
  void opened(Encoding used);
  void welcomed(const Welcome& welcome);
  void lost_link(std::string_view reason);
  void forget_transit();
  void drop_link(std::string_view reason);  // closes it ourselves
  void back_off(Duration delay);
  void end();
  void network_changed();
  Duration next_delay();
  void watch(Duration delay, const char* reason);  // the one deadline: connect, greeting, silence
  void watch_silence();
  void heard();
  void renew_token_after(Duration expires_in);
  void renew_token();
  void bury_link();
  void enter(ClientState next);

  // client_stream.cpp: frames out
  void arm_flush();
  void flush();
  bool flush_samples();
  bool flush_uploads();
  bool acks_stay_out() const;
  bool put(const ClientMessage& message);
  void report_lost();

  // client_frames.cpp: frames in
  void received(std::string_view frame);
  void on(const Welcome& welcome);
  void on(const Ack& ack);
  void on(const SurveyAck& ack);
  void on(const Position& position);
  void on(const NoFix& no_fix);
  void on(const Observation& observation);
  void on(const ZoneEvent& event);
  void on(const TokenAccepted& accepted);
  void on(const ClockAnswer& answer);
  void on(const ScanHint& hint);
  void on(const Ticket& ticket);
  void on(const FaultReport& report);
  void on(const GoAway& go_away);
  void upload_refused(const FaultReport& report);
  void gap_reported();
  void refused_by_server(const FaultReport& report);
  void hold(Duration wait);
  void distrust(FaultCode code, std::string field, std::string cause);

  /// A call through the weak self that does nothing once the client is gone or the connection is another one.
  template <typename Call>
  auto guarded(Call call);
  std::uint64_t after(Duration delay, void (State::*task)());
  void cancel(std::optional<std::uint64_t>& timer);

  ClientSettings settings_;
  ClientEvents events_;
  LinkFactory links_;
  Scheduler& scheduler_;
  Random random_;

  ClientState state_ = ClientState::kIdle;
  Outbox outbox_;
  UploadQueue uploads_;
  std::optional<Subscribe> subscription_;

  std::unique_ptr<Link> link_;
  std::uint64_t generation_ = 0;  // of the link; events of earlier ones are not heard
  Encoding encoding_ = Encoding::kCbor;
  std::string token_;             // used on this connection
  int token_refusals_ = 0;

  std::string session_;           // empty = none to resume
  std::uint64_t epoch_ = 0;
  std::string ticket_;            ///< newest one sealed by a server
  bool resuming_ = false;         // the hello of this connection asked for it

  int attempt_ = 0;
  PhoneTime streaming_since_;
  Duration retry_after_{0};       // the server's wish for the next connection
  std::optional<PhoneTime> leave_at_;  // the server drains
  std::optional<PhoneTime> hold_until_;
  PhoneTime last_flush_ = PhoneTime::min();
  PhoneTime last_heard_;
  PhoneTime progress_at_;         // since then samples are on the way and none was acknowledged
  bool replaying_ = false;
  int gaps_in_a_row_ = 0;

  std::optional<std::uint64_t> deadline_timer_;
  std::optional<std::uint64_t> back_off_timer_;
  std::optional<std::uint64_t> leave_timer_;
  std::optional<std::uint64_t> token_timer_;
  std::optional<std::uint64_t> flush_timer_;
  std::optional<PhoneTime> flush_at_;
};

template <typename Call>
auto Client::State::guarded(Call call) {
  return [weak = weak_from_this(), generation = generation_, call](auto&&... arguments) {
    const auto self = weak.lock();
    if (self && self->generation_ == generation) (self.get()->*call)(arguments...);
  };
}

}  // namespace wayfuse
