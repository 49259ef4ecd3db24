#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "wayfuse/proto/codec.hpp"

namespace wayfuse {

/// Where a server listens. A port alone is plain TCP on loopback.
struct Endpoint {
  Endpoint(std::uint16_t a_port) : port(a_port) {}  // NOLINT: a port says all of it in most tests
  /// `http://HOST:PORT` or `https://HOST:PORT`; `authority` = PEM file to trust.
  Endpoint(std::string_view url, std::string_view authority);

  std::string host = "127.0.0.1";
  std::uint16_t port = 0;
  bool tls = false;
  std::string authority;
};

/// A TCP connection, over TLS where the endpoint says so, without manners: it sends what the test wants.
class RawSocket {
 public:
  explicit RawSocket(const Endpoint& where);
  ~RawSocket();
  RawSocket(RawSocket&& other) noexcept;

  /// False = the peer is gone.
  bool send(std::string_view bytes);
  /// Exactly `size` bytes; absent = the peer closed before, or was silent for `patience_s`.
  std::optional<std::string> read(std::size_t size, double patience_s = 10);
  /// Up to and including `mark`.
  std::optional<std::string> read_until(std::string_view mark, double patience_s = 10);
  /// All there is until the peer closes; absent = it did not within `patience_s`.
  std::optional<std::string> read_to_end(double patience_s = 10);
  void close();

 private:
  struct Tls;
  bool fill(double patience_s);
  int descriptor_ = -1;
  std::unique_ptr<Tls> tls_;
  bool ended_ = false;
  std::string buffer_;
};

/// A WebSocket client written from RFC 6455 alone, so that server and SDK cannot agree on a mistake.
class RawWebsocket {
 public:
  struct Frame {
    int opcode = 0;
    std::string payload;
  };
  /// Upgrades; `status` is the HTTP status of the answer (101 = open).
  RawWebsocket(const Endpoint& where, std::string_view key, std::string_view subprotocol = kSubprotocolJson,
               std::string_view path = "/v1/session");
  int status() const { return status_; }
  const std::string& answer() const { return answer_; }

  /// One masked frame with FIN set.
  bool send_frame(int opcode, std::string_view payload);
  bool send(const ClientMessage& message);
  /// The next frame, pings answered and skipped; absent = end of the stream or silence.
  std::optional<Frame> read_frame(double patience_s = 10);
  /// The next message; absent = a close frame (see close_code()), the end or silence.
  std::optional<ServerMessage> receive(double patience_s = 10);
  /// The next message of this kind; others are skipped.
  template <typename Body>
  std::optional<Body> expect(double patience_s = 10) {
    while (const auto message = receive(patience_s)) {
      if (const auto* body = std::get_if<Body>(&*message)) return *body;
    }
    return std::nullopt;
  }
  /// Reads to the end; the code of the close frame, 1006 if there was none.
  int close_code(double patience_s = 10);
  RawSocket& socket() { return socket_; }

 private:
  RawSocket socket_;
  Encoding encoding_;
  int status_ = 0;
  std::string answer_;
  std::optional<int> close_code_;
};

/// One HTTP request over a connection of its own: status and body.
struct HttpAnswer {
  int status = 0;
  std::string body;
};
HttpAnswer http(const Endpoint& where, std::string_view method, std::string_view path, std::string_view key = "",
                std::string_view body = "");

}  // namespace wayfuse
