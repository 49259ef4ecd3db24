#include "server/net/websocket_connection.hpp"

#include <boost/asio/post.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <boost/beast/websocket/stream.hpp>

namespace wayfuse {
namespace {

namespace beast = boost::beast;
namespace websocket = beast::websocket;
using beast::error_code;

/// One session's frames: read, decode, converse, write one at a time.
///
/// Thread: everything on its strand, but for the calls of Ticked, which go there.
template <typename Stream>
class WebsocketConnection final : public SessionOutput,
                                  public Ticked,
                                  public std::enable_shared_from_this<WebsocketConnection<Stream>> {
 public:
  WebsocketConnection(NetWorld& world, Stream stream, Encoding encoding, Visit visit)
      : world_(world),
        visit_(std::move(visit)),
        encoding_(encoding),
        outbox_(encoding, world.settings.outbox),
        buffer_(Limits::kMessageBytes),
        frames_(world.settings.frames_per_second, world.settings.frames_burst, world.clock.now()),
        last_heard_(world.clock.now()),
        ws_(std::move(stream)) {
    world_.counters.websockets++;
  }
  ~WebsocketConnection() override {
    world_.counters.outbox_bytes -= counted_bytes_;
    world_.counters.websockets--;
  }

  void accept(HttpRequest upgrade, std::optional<Rights> rights) {
    ws_.set_option(websocket::stream_base::timeout{websocket::stream_base::none(), websocket::stream_base::none(), false});
    ws_.set_option(websocket::stream_base::decorator([encoding = encoding_](websocket::response_type& response) {
      response.set(beast::http::field::sec_websocket_protocol, subprotocol(encoding));
      response.set(beast::http::field::server, "wayfuse");
    }));
    ws_.read_message_max(Limits::kMessageBytes);
    ws_.auto_fragment(false);
    ws_.write_buffer_bytes(512);
    ws_.binary(encoding_ == Encoding::kCbor);
    ws_.control_callback([this](websocket::frame_type, beast::string_view) { last_heard_ = world_.clock.now(); });
    const auto self = this->shared_from_this();
    conversation_ = begin_conversation(
        world_.sessions, *this,
        [weak = this->weak_from_this(), strand = ws_.get_executor()](std::function<void()> task) {
          // After the connection's end there is nobody left to tell.
          if (!weak.expired()) asio::post(strand, std::move(task));
        },
        std::move(rights), [this](std::string_view token) { return authenticate(token); });
    world_.wheel.add(self);
    upgrade_ = std::move(upgrade);
    ws_.async_accept(upgrade_, [self](error_code error) { self->accepted(error); });
  }

  // ---- SessionOutput
  void send(const ServerMessage& message) override {
    if (ending_ || gone_) return;
    if (!outbox_.push(message)) return slow();
    account();
    write();
  }
  bool congested() const override { return outbox_.bytes() > world_.settings.outbox.bytes / 4; }
  void close(const Fault& reason) override {
    if (ending_ || gone_) return;
    const std::uint16_t code = face_of(reason.code).close_code;
    send(FaultReport{reason, 0, {}, Duration{0}});
    end(code != 0 ? code : 1008, to_string(reason));
  }
  void finish() override { end(websocket::close_code::normal, "goodbye"); }

  // ---- Ticked
  void look_at_deadlines() override {
    asio::post(ws_.get_executor(), [self = this->shared_from_this()] { self->tick(); });
  }
  void drain(Duration within, Duration leave_after) override {
    asio::post(ws_.get_executor(), [self = this->shared_from_this(), within, leave_after] {
      self->send(GoAway{within, "the server is going down"});
      self->leave_at_ = self->world_.clock.now() + leave_after;
    });
  }
  void cut() override {
    asio::post(ws_.get_executor(), [self = this->shared_from_this()] { self->hang_up(); });
  }

 private:
  void accepted(error_code error) {
    upgrade_ = {};
    if (error) return gone();
    read();
    write();
  }

  Result<Rights> authenticate(std::string_view token) {
    if (!world_.addresses->may_authenticate(visit_.address, world_.clock.now())) {
      return Fault{FaultCode::kNotAuthenticated, "token", "too many wrong keys came from this address; wait"};
    }
    const auto principal = world_.access.principal_of(token);
    if (principal) return rights_of(*principal);
    world_.addresses->refused(visit_.address, world_.clock.now());
    world_.counters.authentication_failures++;
    return principal.fault();
  }

  // ---- reading
  void read() {
    if (gone_ || ending_ || reading_) return;
    if (!frames_.has(world_.clock.now())) {  // TCP holds the client back; nothing is dropped
      if (!paused_) world_.counters.read_pauses++;
      paused_ = true;
      held_ = this->shared_from_this();
      return;
    }
    paused_ = false;
    const auto held = std::move(held_);
    reading_ = true;
    ws_.async_read(buffer_,
                   [self = this->shared_from_this()](error_code error, std::size_t bytes) { self->was_read(error, bytes); });
  }

  void was_read(error_code error, std::size_t bytes) {
    reading_ = false;
    if (error) return read_failed(error);
    const ServerTime now = world_.clock.now();
    last_heard_ = now;
    frames_.spend(1, now);
    world_.counters.frames_in++;
    world_.counters.bytes_in += bytes;
    take();
    buffer_.consume(buffer_.size());
    if (buffer_.capacity() > kKeptBuffer) buffer_.shrink_to_fit();
    if (!often_ && conversation_->tick_interval() < std::chrono::seconds(1)) {
      often_ = true;
      world_.wheel.add_often(this->weak_from_this());
    }
    read();
  }

  void take() {
    if (ws_.got_text() != (encoding_ == Encoding::kJson)) {
      return conversation_->receive(Fault{FaultCode::kMalformed, "",
                                          encoding_ == Encoding::kJson ? "a binary frame came where JSON was negotiated"
                                                                       : "a text frame came where CBOR was negotiated"});
    }
    const auto data = buffer_.cdata();
    auto message = decode_client_message({static_cast<const char*>(data.data()), data.size()}, encoding_);
    if (message) {
      conversation_->receive(*std::move(message));
    } else {
      conversation_->receive(message.fault());
    }
  }

  void read_failed(error_code error) {
    if (error == websocket::error::message_too_big || error == websocket::error::buffer_overflow)
      world_.sessions.counters.malformed_messages++;
    gone();
  }

  // ---- writing: one at a time
  void write() {
    if (writing_ || gone_ || !ws_.is_open() || closing_) return;
    auto frame = outbox_.pop();
    account();
    if (!frame) {
      if (ending_) say_close();
      return;
    }
    frame_ = *std::move(frame);
    writing_ = true;
    write_began_ = world_.clock.now();
    ws_.async_write(asio::buffer(frame_),
                    [self = this->shared_from_this()](error_code error, std::size_t bytes) { self->written(error, bytes); });
  }

  void written(error_code error, std::size_t bytes) {
    writing_ = false;
    if (error) return gone();
    world_.counters.frames_out++;
    world_.counters.bytes_out += bytes;
    if (frame_.capacity() > kKeptBuffer) std::string().swap(frame_);
    write();
  }

  void account() {
    const std::uint64_t bytes = outbox_.bytes();
    world_.counters.outbox_bytes += bytes - counted_bytes_;  // modulo 2^64: also downwards
    counted_bytes_ = bytes;
  }

  // ---- ending
  void end(std::uint16_t code, std::string reason) {
    if (ending_ || gone_) return;
    ending_ = websocket::close_reason(static_cast<websocket::close_code>(code), beast::string_view(reason).substr(0, 120));
    close_by_ = world_.clock.now() + world_.settings.close_deadline + world_.settings.write_deadline;
    write();
  }

  void say_close() {
    closing_ = true;
    close_by_ = world_.clock.now() + world_.settings.close_deadline;
    ws_.async_close(*ending_, [self = this->shared_from_this()](error_code) { self->gone(); });
  }

  void slow() {
    world_.counters.slow_closed++;
    hang_up();
  }

  // A write in flight cannot be taken back and a close frame would queue behind it.
  void hang_up() {
    error_code ignored;
    lowest(ws_.next_layer()).close(ignored);
    gone();
  }

  void gone() {
    if (gone_) return;
    gone_ = true;
    error_code ignored;
    lowest(ws_.next_layer()).close(ignored);
    outbox_.clear();
    account();
    conversation_->disconnected();
    const auto held = std::move(held_);
  }

  // ---- deadlines
  void tick() {
    if (gone_) return;
    const ServerTime now = world_.clock.now();
    if (ending_ && now > close_by_) return hang_up();
    if (writing_ && now - write_began_ > world_.settings.write_deadline) return slow();
    if (ending_) return;
    if (leave_at_ && now >= *leave_at_) return end(websocket::close_code::going_away, "the server is going down");
    if (!paused_ && now - last_heard_ > world_.settings.dead_after) {
      world_.counters.dead_closed++;
      return hang_up();
    }
    if (now - last_heard_ > world_.settings.ping_interval && now - last_ping_ > world_.settings.ping_interval && !pinging_)
      ping(now);
    if (often_ && !world_.budget.keeps_observers()) {
      world_.counters.shed++;
      return close({FaultCode::kOverloaded, "", "the server is short of memory"});
    }
    conversation_->tick();
    if (paused_) read();
  }

  void ping(ServerTime now) {
    last_ping_ = now;
    pinging_ = true;
    ws_.async_ping({}, [self = this->shared_from_this()](error_code error) {
      self->pinging_ = false;
      if (error) self->gone();
    });
  }

  static constexpr std::size_t kKeptBuffer = 4096;

  NetWorld& world_;
  const Visit visit_;
  const Encoding encoding_;
  Outbox outbox_;
  beast::flat_buffer buffer_;
  TokenBucket frames_;
  ServerTime last_heard_;
  ServerTime last_ping_;
  ServerTime write_began_;
  ServerTime close_by_;
  std::optional<ServerTime> leave_at_;
  std::optional<websocket::close_reason> ending_;
  std::uint64_t counted_bytes_ = 0;
  bool reading_ = false;
  bool paused_ = false;
  std::shared_ptr<WebsocketConnection> held_;  // itself, while paused: no pending read keeps it alive then
  bool writing_ = false;
  bool pinging_ = false;
  bool closing_ = false;
  bool gone_ = false;
  bool often_ = false;
  HttpRequest upgrade_;
  std::string frame_;
  std::shared_ptr<Conversation> conversation_;
  websocket::stream<Stream> ws_;
};

template <typename Stream>
void serve(NetWorld& world, Stream stream, HttpRequest upgrade, Encoding encoding, std::optional<Rights> rights, Visit visit) {
  auto connection = std::make_shared<WebsocketConnection<Stream>>(world, std::move(stream), encoding, std::move(visit));
  connection->accept(std::move(upgrade), std::move(rights));
}

}  // namespace

std::optional<Encoding> negotiate(std::string_view offered) {
  bool json = false;
  while (!offered.empty()) {
    const std::size_t comma = std::min(offered.find(','), offered.size());
    std::string_view name = offered.substr(0, comma);
    offered.remove_prefix(std::min(comma + 1, offered.size()));
    while (!name.empty() && (name.front() == ' ' || name.front() == '\t')) name.remove_prefix(1);
    while (!name.empty() && (name.back() == ' ' || name.back() == '\t')) name.remove_suffix(1);
    const auto encoding = encoding_of(name);
    if (encoding == Encoding::kCbor) return encoding;
    json = json || encoding == Encoding::kJson;
  }
  return json ? std::optional(Encoding::kJson) : std::nullopt;
}

Rights rights_of(const Principal& principal) {
  const auto has = [&](Scope scope) { return std::ranges::find(principal.scopes, scope) != principal.scopes.end(); };
  return {principal.key_id,     has(Scope::kTrack), has(Scope::kSurvey),
          has(Scope::kObserve), principal.building, principal.expires_at, principal.coarse};
}

void serve_websocket(NetWorld& world, PlainStream stream, HttpRequest upgrade, Encoding encoding, std::optional<Rights> rights,
                     Visit visit) {
  serve(world, std::move(stream), std::move(upgrade), encoding, std::move(rights), std::move(visit));
}
void serve_websocket(NetWorld& world, TlsStream stream, HttpRequest upgrade, Encoding encoding, std::optional<Rights> rights,
                     Visit visit) {
  serve(world, std::move(stream), std::move(upgrade), encoding, std::move(rights), std::move(visit));
}

}  // namespace wayfuse
