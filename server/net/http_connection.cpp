#include "server/net/http_connection.hpp"

#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <exception>

#include "server/net/http_messages.hpp"
#include "server/net/target.hpp"
#include "server/net/websocket_connection.hpp"

namespace wayfuse {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
using beast::error_code;

template <typename Stream>
Stream stream_over(PlainStream socket, [[maybe_unused]] const Visit& visit) {
  if constexpr (std::is_same_v<Stream, TlsStream>) {
    return TlsStream(std::move(socket), *visit.tls);
  } else {
    return socket;
  }
}

/// One HTTP conversation: a request at a time, until it closes or becomes a WebSocket.
///
/// Thread: everything on its strand, but for the calls of Ticked and the handlers' answers, which go there.
template <typename Stream>
class HttpConnection final : public Ticked, public std::enable_shared_from_this<HttpConnection<Stream>> {
 public:
  HttpConnection(NetWorld& world, PlainStream socket, Visit visit)
      : world_(world),
        visit_(std::move(visit)),
        buffer_(kBufferBytes),
        stream_(stream_over<Stream>(std::move(socket), visit_)) {
    world_.counters.half_open++;
  }
  ~HttpConnection() override { complete(); }

  void start() {
    allow(world_.settings.handshake_deadline);
    world_.wheel.add(this->weak_from_this());
    if constexpr (std::is_same_v<Stream, TlsStream>) {
      stream_.async_handshake(asio::ssl::stream_base::server, [self = this->shared_from_this()](error_code error) {
        if (error) {
          self->world_.counters.tls_failures++;
          return self->hang_up();
        }
        self->read();
      });
    } else {
      asio::post(stream_.get_executor(), [self = this->shared_from_this()] { self->read(); });
    }
  }

  // ---- Ticked
  void look_at_deadlines() override {
    asio::post(stream_.get_executor(), [self = this->shared_from_this()] { self->tick(); });
  }
  void drain(Duration, Duration) override {
    asio::post(stream_.get_executor(), [self = this->shared_from_this()] {
      if (self->idle_ || self->half_open_) return self->hang_up();
      if (self->source_) self->end_soon();
    });
  }
  void cut() override {
    asio::post(stream_.get_executor(), [self = this->shared_from_this()] { self->hang_up(); });
  }

 private:
  static constexpr std::size_t kBufferBytes = 64 * 1024;
  static constexpr std::uint64_t kSlowestUpload = 256 * 1024;  ///< bytes a second of a body beyond the usual limit

  // ---- reading
  void read() {
    if (gone_) return;
    parser_.emplace();
    parser_->header_limit(world_.settings.header_bytes);
    parser_->body_limit(world_.settings.upload_bytes);
    idle_ = true;
    http::async_read_header(stream_, buffer_, *parser_, [self = this->shared_from_this()](error_code error, std::size_t) {
      self->idle_ = false;
      self->header_read(error);
    });
  }

  void header_read(error_code error) {
    if (error) return read_failed(error);
    const auto& request = parser_->get();
    if (static_cast<std::size_t>(std::distance(request.begin(), request.end())) > world_.settings.header_fields) {
      return refuse({FaultCode::kTooLarge, "headers", "more than " + std::to_string(world_.settings.header_fields) + " fields"},
                    431);
    }
    if (beast::websocket::is_upgrade(request)) return upgrade();
    const bool upload = request.method() == http::verb::post || request.method() == http::verb::put;
    std::uint64_t most = upload ? world_.settings.upload_bytes : world_.settings.body_bytes;
    const std::uint64_t announced = parser_->content_length().value_or(0);
    if (upload && announced > most) most = std::max(most, limit_of_path());
    parser_->body_limit(most);
    if (announced > most) return refuse({FaultCode::kTooLarge, "body", "longer than this path takes"}, 413);
    allow(world_.settings.body_deadline + std::chrono::seconds(announced / kSlowestUpload));
    if (beast::iequals(request[http::field::expect], "100-continue")) return ask_for_body();
    read_body();
  }

  // A path may take more, from a key that may use it: whoever else announces that much is refused before it is read.
  std::uint64_t limit_of_path() {
    const auto header = request_from(parser_->get(), visit_.address);
    if (!header || !world_.addresses->may_authenticate(visit_.address, world_.clock.now())) return 0;
    return world_.router.body_limit(*header).value_or(0);
  }

  void ask_for_body() {
    static constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";
    asio::async_write(stream_, asio::buffer(kContinue), [self = this->shared_from_this()](error_code error, std::size_t) {
      if (error) return self->hang_up();
      self->read_body();
    });
  }

  void read_body() {
    http::async_read(stream_, buffer_, *parser_, [self = this->shared_from_this()](error_code error, std::size_t) {
      if (error) return self->read_failed(error);
      self->answer();
    });
  }

  void read_failed(error_code error) {
    if (error == http::error::body_limit) return refuse({FaultCode::kTooLarge, "body", "longer than this path takes"}, 413);
    if (error == http::error::header_limit) return refuse({FaultCode::kTooLarge, "headers", "longer than the limit"}, 431);
    const bool ended = error == http::error::end_of_stream || error == http::error::partial_message;
    if (!ended && error.category() == http::make_error_code(http::error::bad_method).category()) {
      return refuse({FaultCode::kMalformed, "", error.message()}, 400);
    }
    hang_up();
  }

  // ---- answering
  void answer() {
    complete();
    const auto& message = parser_->get();
    keep_alive_ = message.keep_alive();
    head_ = message.method() == http::verb::head;
    version_ = message.version();
    auto request = request_from(message, visit_.address);
    if (!request) return refuse(request.fault(), 400);
    const bool names_key = request->headers.contains("authorization");
    if (names_key && !world_.addresses->may_authenticate(visit_.address, world_.clock.now())) {
      return respond(problem({FaultCode::kRateLimited, "authorization", "too many wrong keys came from this address; wait"}));
    }
    busy_ = true;
    allow(world_.settings.body_deadline);
    const Respond respond_once = [self = this->shared_from_this()](Response response) {
      asio::post(self->stream_.get_executor(),
                 [self, response = std::move(response)]() mutable { self->respond(std::move(response)); });
    };
    try {
      world_.router.handle(*std::move(request), respond_once);
    } catch (const std::exception& broken) {
      world_.complain(std::string("a handler failed: ") + broken.what());
      respond_once(problem({FaultCode::kInternal, "", "a bug of ours; it was logged"}));
    }
  }

  void refuse(const Fault& fault, int status) {
    complete();
    keep_alive_ = false;
    respond(problem(fault, status));
  }

  void respond(Response response) {
    if (gone_) return;
    busy_ = false;
    auto& counters = world_.counters;
    (response.status < 400   ? counters.http_ok
     : response.status < 500 ? counters.http_client_errors
                             : counters.http_server_errors)++;
    if (response.status == 401) {
      counters.authentication_failures++;
      world_.addresses->refused(visit_.address, world_.clock.now());
    }
    if (response.stream && !head_) return begin_stream(std::move(response));
    response_ = whole_answer(std::move(response), version_, head_);
    response_.keep_alive(keep_alive_ && !world_.draining);
    allow(world_.settings.http_write_deadline);
    http::async_write(stream_, response_, [self = this->shared_from_this()](error_code error, std::size_t) {
      if (error || !self->response_.keep_alive()) return self->say_goodbye();
      self->response_ = {};
      self->allow(self->world_.settings.keep_alive_deadline);
      self->read();
    });
  }

  // ---- answering in pieces: one in flight, the next asked for when it is written
  void begin_stream(Response response) {
    source_ = std::move(response.stream);
    stream_head_ = head_of(response, version_);
    // HTTP/1.0 knows no chunks: there the end of the connection is the end of the body.
    if (version_ < 11) keep_alive_ = false;
    stream_head_->keep_alive(keep_alive_ && !world_.draining);
    if (version_ >= 11) stream_head_->chunked(true);
    stream_head_writer_.emplace(*stream_head_);
    source_->on_ready([weak = this->weak_from_this(), strand = stream_.get_executor()] {
      asio::post(strand, [weak] {
        if (const auto self = weak.lock()) self->woken();
      });
    });
    allow(world_.settings.http_write_deadline);
    http::async_write_header(stream_, *stream_head_writer_, [self = this->shared_from_this()](error_code error, std::size_t) {
      if (error) return self->hang_up();
      self->pump();
    });
  }

  void pump() {
    if (gone_ || !source_) return;
    auto piece = ending_ ? std::nullopt : source_->next();
    if (!piece) return end_stream();
    if (piece->empty()) {  // nothing is under way that would keep the connection alive: it keeps itself
      staying_ = this->shared_from_this();
      return;
    }
    write_piece(*std::move(piece));
  }

  void woken() {
    if (!staying_) return;
    staying_.reset();
    pump();
  }

  void stay_alive() {
    auto piece = source_->idle();
    if (!piece) return end_stream();
    if (piece->empty()) return;
    staying_.reset();
    write_piece(*std::move(piece));
  }

  void write_piece(std::string piece) {
    piece_ = std::move(piece);
    allow(world_.settings.http_write_deadline);
    auto written = [self = this->shared_from_this()](error_code error, std::size_t) {
      if (error) return self->hang_up();
      self->pump();
    };
    if (version_ >= 11) {
      asio::async_write(stream_, http::make_chunk(asio::buffer(piece_)), std::move(written));
    } else {
      asio::async_write(stream_, asio::buffer(piece_), std::move(written));
    }
  }

  void end_soon() {
    ending_ = true;
    keep_alive_ = false;
    woken();
  }

  void end_stream() {
    staying_.reset();
    source_.reset();
    if (version_ < 11) return say_goodbye();
    const bool goes_on = keep_alive_ && !world_.draining;
    allow(world_.settings.http_write_deadline);
    asio::async_write(stream_, http::make_chunk_last(), [self = this->shared_from_this(), goes_on](error_code error, std::size_t) {
      if (error || !goes_on) return self->say_goodbye();
      self->allow(self->world_.settings.keep_alive_deadline);
      self->read();
    });
  }

  // ---- becoming a WebSocket
  void upgrade() {
    complete();
    version_ = 11;
    HttpRequest request = parser_->release();
    const std::string_view target(request.target().data(), request.target().size());
    if (target.substr(0, target.find('?')) != kSessionPath) {
      return refuse({FaultCode::kNotFound, "path", "sessions are opened at " + std::string(kSessionPath)}, 404);
    }
    const auto encoding = negotiate(std::string_view(request[http::field::sec_websocket_protocol]));
    if (!encoding) {
      return refuse({FaultCode::kUnsupportedVersion, "sec-websocket-protocol",
                     "offer " + std::string(kSubprotocolCbor) + " or " + std::string(kSubprotocolJson)},
                    400);
    }
    if (!world_.budget.takes_sessions()) {
      world_.counters.shed++;
      return refuse({FaultCode::kOverloaded, "", "the server is short of memory"}, 503);
    }
    auto rights = rights_in(request);
    if (!rights) return refuse(rights.fault(), 0);
    gone_ = true;  // the stream goes on without us
    serve_websocket(world_, std::move(stream_), std::move(request), *encoding, *std::move(rights), std::move(visit_));
  }

  Result<std::optional<Rights>> rights_in(const HttpRequest& request) {
    const auto field = request.find(http::field::authorization);
    if (field == request.end()) return std::optional<Rights>();
    if (!world_.addresses->may_authenticate(visit_.address, world_.clock.now())) {
      return Fault{FaultCode::kRateLimited, "authorization", "too many wrong keys came from this address; wait"};
    }
    const auto principal = world_.access.principal_of(bearer_token(std::string_view(field->value())));
    if (!principal) return principal.fault();
    return std::optional(rights_of(*principal));
  }

  // ---- deadlines and ends
  void allow(Duration time) { deadline_ = world_.clock.now() + time; }

  void tick() {
    if (gone_ || busy_) return;
    if (staying_) return stay_alive();
    if (world_.clock.now() <= deadline_) return;
    if (half_open_) world_.counters.handshake_timeouts++;
    hang_up();
  }

  // The first request is whole, or the connection ended: it is not half open any more.
  void complete() {
    if (half_open_) world_.counters.half_open--;
    half_open_ = false;
  }

  // A lingering peer is cut by the deadline.
  void say_goodbye() {
    if (gone_) return;
    allow(world_.settings.close_deadline);
    if constexpr (std::is_same_v<Stream, TlsStream>) {
      stream_.async_shutdown([self = this->shared_from_this()](error_code) { self->hang_up(); });
    } else {
      error_code ignored;
      stream_.shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
      linger();
    }
  }

  // Closing with unread input would reset the connection and could take our last answer with it.
  void linger() {
    buffer_.clear();
    stream_.async_read_some(buffer_.prepare(4096), [self = this->shared_from_this()](error_code error, std::size_t) {
      if (error || self->gone_) return self->hang_up();
      self->linger();
    });
  }

  void hang_up() {
    if (gone_) return;
    gone_ = true;
    source_.reset();
    staying_.reset();
    error_code ignored;
    lowest(stream_).close(ignored);
  }

  NetWorld& world_;
  Visit visit_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
  HttpResponse response_;
  std::shared_ptr<BodySource> source_;  ///< while a body goes out in pieces
  std::optional<HttpHead> stream_head_;
  std::optional<http::response_serializer<http::empty_body>> stream_head_writer_;
  std::string piece_;
  ServerTime deadline_;
  unsigned version_ = 11;
  bool half_open_ = true;
  bool idle_ = false;
  std::shared_ptr<HttpConnection> staying_;  ///< itself, while the source has nothing to say
  bool ending_ = false;                      ///< the server drains: no further piece
  bool busy_ = false;  ///< a handler has the request: it answers in its own time
  bool keep_alive_ = true;
  bool head_ = false;
  bool gone_ = false;
  Stream stream_;
};

}  // namespace

void serve_http(NetWorld& world, PlainStream socket, Visit visit) {
  if (visit.tls) {
    std::make_shared<HttpConnection<TlsStream>>(world, std::move(socket), std::move(visit))->start();
  } else {
    std::make_shared<HttpConnection<PlainStream>>(world, std::move(socket), std::move(visit))->start();
  }
}

}  // namespace wayfuse
