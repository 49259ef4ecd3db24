// A WebSocket connection, plain or over TLS: name look-up, connect, handshake, upgrade, frames, farewell.
//
// Beast's own timeouts are not used: they fire only while a read is pending and know nothing of writes. Every phase has its
// deadline here. One read and one write are in flight at most; permessage-deflate is never offered.
#include <openssl/err.h>

#include <algorithm>
#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/host_name_verification.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/beast/core/bind_handler.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <deque>
#include <optional>

#include "sdk/src/client/websocket_link_loop.hpp"

namespace wayfuse {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;

// After a close frame or broken framing Beast waits for the peer to close the socket, for ever if it does not. These streams
// do not wait: Beast finds the overloads below by their types.
class PlainStream : public tcp::socket {
 public:
  using tcp::socket::socket;
};
class TlsStream : public asio::ssl::stream<tcp::socket> {
 public:
  using asio::ssl::stream<tcp::socket>::stream;
};

template <typename Stream, typename Handler>
void close_at_once(Stream& stream, Handler&& handler) {
  auto& socket = stream.lowest_layer();
  error_code ignored;
  socket.shutdown(tcp::socket::shutdown_send, ignored);
  socket.close(ignored);
  asio::post(stream.get_executor(), beast::bind_front_handler(std::forward<Handler>(handler), error_code{}));
}
template <typename Handler>
void async_teardown(beast::role_type, PlainStream& stream, Handler&& handler) {
  close_at_once(stream, std::forward<Handler>(handler));
}
template <typename Handler>
void async_teardown(beast::role_type, TlsStream& stream, Handler&& handler) {
  close_at_once(stream, std::forward<Handler>(handler));
}
template <typename Stream>
void teardown(beast::role_type, Stream& stream, error_code& error) {  // asked for by Beast's synchronous calls, never used
  stream.lowest_layer().close(error);
}

constexpr bool kIsTls(const TlsStream*) { return true; }
constexpr bool kIsTls(const PlainStream*) { return false; }

std::string offered(const WebsocketLinkSettings& settings) {
  std::string list;
  if (settings.offer_cbor) list += kSubprotocolCbor;
  if (settings.offer_json) list += (list.empty() ? "" : ", ") + std::string(kSubprotocolJson);
  return list;
}

template <typename Stream>
class Connection final : public std::enable_shared_from_this<Connection<Stream>> {
 public:
  explicit Connection(std::shared_ptr<const WebsocketTarget> target)
      : target_(std::move(target)),
        resolver_(target_->io),
        deadline_(target_->io),
        write_deadline_(target_->io),
        stream_(make_stream(*target_)) {}

  void open(Link::Events events);
  bool send(std::string frame);
  void close();

 private:
  static websocket::stream<Stream> make_stream(const WebsocketTarget& target) {
    if constexpr (kIsTls(static_cast<Stream*>(nullptr))) {
      return websocket::stream<Stream>(target.io, *target.tls);
    } else {
      return websocket::stream<Stream>(target.io);
    }
  }
  tcp::socket::lowest_layer_type& socket() { return stream_.next_layer().lowest_layer(); }
  auto self() { return this->shared_from_this(); }

  void connect(const tcp::resolver::results_type& found);
  void secure();
  bool trusted(bool verified, asio::ssl::verify_context& context);
  void upgrade();
  void upgraded(error_code error);
  void watch_idle();
  void read();
  void write();
  void say_farewell();
  void fail(const std::string& reason);
  std::string why(error_code error);

  std::shared_ptr<const WebsocketTarget> target_;
  tcp::resolver resolver_;
  asio::steady_timer deadline_;        // handshake, then idle, then farewell
  asio::steady_timer write_deadline_;
  websocket::stream<Stream> stream_;
  websocket::response_type response_;
  beast::flat_buffer buffer_;
  Link::Events events_;
  std::deque<std::string> queue_;      // front = being written
  std::size_t queued_bytes_ = 0;
  std::chrono::steady_clock::time_point heard_;
  std::string tls_reason_;
  bool open_ = false;
  bool writing_ = false;
  bool closing_ = false;
  bool farewell_ = false;
  bool done_ = false;
  bool muted_ = false;
};

template <typename Stream>
void Connection<Stream>::open(Link::Events events) {
  events_ = std::move(events);
  deadline_.expires_after(target_->settings.handshake_most);
  deadline_.async_wait([me = self()](error_code error) {
    if (!error && !me->open_) me->fail("no connection within the time allowed");
  });
  resolver_.async_resolve(target_->url.host, target_->url.port, [me = self()](error_code error, tcp::resolver::results_type found) {
    if (me->done_) return;
    if (error) return me->fail("host " + me->target_->url.host + ": " + error.message());
    me->connect(found);
  });
}

template <typename Stream>
void Connection<Stream>::connect(const tcp::resolver::results_type& found) {
  if (!target_->url.tls && !target_->settings.allow_plain) {
    const bool loopback = std::all_of(found.begin(), found.end(), [](const auto& entry) {
      return entry.endpoint().address().is_loopback();
    });
    if (!loopback) return fail("ws:// to another machine is refused: use wss://, or allow_plain");
  }
  asio::async_connect(socket(), found, [me = self()](error_code error, const tcp::endpoint&) {
    if (me->done_) return;
    if (error) return me->fail("connect: " + error.message());
    error_code ignored;
    me->socket().set_option(tcp::no_delay(true), ignored);
    me->secure();
  });
}

template <typename Stream>
void Connection<Stream>::secure() {
  if constexpr (kIsTls(static_cast<Stream*>(nullptr))) {
    TlsStream& tls = stream_.next_layer();
    error_code literal;
    asio::ip::make_address(target_->url.host, literal);
    if (literal) SSL_set_tlsext_host_name(tls.native_handle(), target_->url.host.c_str());  // SNI takes names only
    tls.set_verify_callback([this](bool verified, asio::ssl::verify_context& context) { return trusted(verified, context); });
    tls.async_handshake(asio::ssl::stream_base::client, [me = self()](error_code error) {
      if (me->done_) return;
      if (error) return me->fail("TLS: " + (me->tls_reason_.empty() ? error.message() : me->tls_reason_));
      me->upgrade();
    });
  } else {
    upgrade();
  }
}

/// Called once a certificate of the chain, the server's own last (depth 0).
template <typename Stream>
bool Connection<Stream>::trusted(bool verified, asio::ssl::verify_context& context) {
  X509_STORE_CTX* store = context.native_handle();
  if (!asio::ssl::host_name_verification(target_->url.host)(verified, context)) {
    const int error = X509_STORE_CTX_get_error(store);
    tls_reason_ = error == X509_V_OK ? "the certificate is not for " + target_->url.host : X509_verify_cert_error_string(error);
    return false;
  }
  const auto& pins = target_->settings.pins;
  if (pins.empty() || X509_STORE_CTX_get_error_depth(store) > 0) return true;
  const std::string pin = public_key_pin(X509_STORE_CTX_get_current_cert(store));
  if (std::find(pins.begin(), pins.end(), pin) != pins.end()) return true;
  tls_reason_ = "the server's key " + pin + " is none of the pinned ones";
  return false;
}

template <typename Stream>
void Connection<Stream>::upgrade() {
  stream_.read_message_max(Limits::kMessageBytes);
  stream_.write_buffer_bytes(1024);
  stream_.auto_fragment(false);
  const auto& settings = target_->settings;
  std::string authorization = settings.authorization ? settings.authorization() : std::string();
  stream_.set_option(websocket::stream_base::decorator(
      [protocols = offered(settings), authorization = std::move(authorization)](websocket::request_type& request) {
        request.set(beast::http::field::sec_websocket_protocol, protocols);
        request.set(beast::http::field::user_agent, "wayfuse");
        if (!authorization.empty()) request.set(beast::http::field::authorization, authorization);
      }));
  stream_.control_callback([this](websocket::frame_type, beast::string_view) {
    heard_ = std::chrono::steady_clock::now();
    if (!muted_ && !done_ && events_.alive) events_.alive();
  });
  stream_.async_handshake(response_, target_->url.host_header, target_->url.path, [me = self()](error_code error) {
    if (!me->done_) me->upgraded(error);
  });
}

template <typename Stream>
void Connection<Stream>::upgraded(error_code error) {
  if (error == websocket::error::upgrade_declined) {
    return fail("the server answered " + std::to_string(response_.result_int()) + " " + std::string(response_.reason()));
  }
  if (error) return fail("upgrade: " + error.message());
  const auto chosen = response_[beast::http::field::sec_websocket_protocol];
  const auto encoding = encoding_of(std::string_view(chosen.data(), chosen.size()));
  const bool was_offered = encoding && (*encoding == Encoding::kCbor ? target_->settings.offer_cbor : target_->settings.offer_json);
  if (!was_offered) return fail("the server speaks no version of the protocol that this client does");
  open_ = true;
  stream_.text(*encoding == Encoding::kJson);
  heard_ = std::chrono::steady_clock::now();
  watch_idle();
  read();
  if (!muted_) events_.opened(*encoding);
}

template <typename Stream>
void Connection<Stream>::watch_idle() {
  deadline_.expires_at(heard_ + target_->settings.idle_most);
  deadline_.async_wait([me = self()](error_code error) {
    if (error || me->done_ || me->closing_) return;
    if (std::chrono::steady_clock::now() - me->heard_ >= me->target_->settings.idle_most) return me->fail("nothing heard for too long");
    me->watch_idle();
  });
}

template <typename Stream>
void Connection<Stream>::read() {
  stream_.async_read(buffer_, [me = self()](error_code error, std::size_t) {
    if (me->done_) return;
    if (error) return me->fail(me->why(error));
    me->heard_ = std::chrono::steady_clock::now();
    if (me->stream_.got_text() != me->stream_.text()) return me->fail("a frame of the wrong kind");
    const auto data = me->buffer_.cdata();
    if (!me->muted_) me->events_.received({static_cast<const char*>(data.data()), data.size()});
    me->buffer_.consume(me->buffer_.size());
    if (!me->done_) me->read();
  });
}

template <typename Stream>
bool Connection<Stream>::send(std::string frame) {
  const auto& settings = target_->settings;
  if (!open_ || closing_ || done_) return false;
  if (queue_.size() >= settings.queued_frames_most || queued_bytes_ + frame.size() > settings.queued_bytes_most) return false;
  queued_bytes_ += frame.size();
  queue_.push_back(std::move(frame));
  if (!writing_) write();
  return true;
}

template <typename Stream>
void Connection<Stream>::write() {
  writing_ = true;
  write_deadline_.expires_after(target_->settings.write_most);
  write_deadline_.async_wait([me = self()](error_code error) {
    if (!error && me->writing_ && std::chrono::steady_clock::now() >= me->write_deadline_.expiry()) {
      me->fail("the network takes no data");
    }
  });
  stream_.async_write(asio::buffer(queue_.front()), [me = self()](error_code error, std::size_t) {
    me->writing_ = false;
    me->write_deadline_.cancel();
    if (me->done_) return;
    if (error) return me->fail(me->why(error));
    me->queued_bytes_ -= me->queue_.front().size();
    me->queue_.pop_front();
    if (!me->queue_.empty()) return me->write();
    if (me->closing_) me->say_farewell();
  });
}

template <typename Stream>
void Connection<Stream>::close() {
  muted_ = true;
  if (done_ || closing_) return;
  if (!open_) return fail("closed");
  closing_ = true;
  deadline_.expires_after(target_->settings.close_most);
  deadline_.async_wait([me = self()](error_code error) {
    if (!error) me->fail("closed");  // the peer did not answer the farewell in time
  });
  if (!writing_) say_farewell();
}

template <typename Stream>
void Connection<Stream>::say_farewell() {
  if (farewell_ || !stream_.is_open()) return;
  farewell_ = true;
  stream_.async_close(websocket::close_code::normal, [me = self()](error_code) { me->fail("closed"); });
}

/// The one end of every connection. The socket is closed, pending operations come back with an error and find `done_`.
template <typename Stream>
void Connection<Stream>::fail(const std::string& reason) {
  if (done_) return;
  done_ = true;
  open_ = false;
  deadline_.cancel();
  write_deadline_.cancel();
  resolver_.cancel();
  error_code ignored;
  socket().close(ignored);
  if (!muted_ && events_.closed) events_.closed(reason);
}

template <typename Stream>
std::string Connection<Stream>::why(error_code error) {
  if (error != websocket::error::closed) return error.message();
  const auto& reason = stream_.reason();
  return "the server closed: " + std::to_string(reason.code) + " " + std::string(reason.reason.data(), reason.reason.size());
}

template <typename Stream>
class WebsocketLink final : public Link {
 public:
  explicit WebsocketLink(std::shared_ptr<const WebsocketTarget> target)
      : connection_(std::make_shared<Connection<Stream>>(std::move(target))) {}
  ~WebsocketLink() override { connection_->close(); }  // which still says farewell; the connection outlives its link for that
  void open(Events events) override { connection_->open(std::move(events)); }
  bool send(std::string frame) override { return connection_->send(std::move(frame)); }
  void close() override { connection_->close(); }

 private:
  std::shared_ptr<Connection<Stream>> connection_;
};

}  // namespace

std::unique_ptr<Link> make_websocket_link(std::shared_ptr<const WebsocketTarget> target) {
  if (target->tls) return std::make_unique<WebsocketLink<TlsStream>>(std::move(target));
  return std::make_unique<WebsocketLink<PlainStream>>(std::move(target));
}

}  // namespace wayfuse
