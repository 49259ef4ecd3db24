#include "tests/integration/raw_client.hpp"

#include <netdb.h>
#include <openssl/ssl.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <stdexcept>
#include <utility>

namespace wayfuse {

Endpoint::Endpoint(std::string_view url, std::string_view trusted) : tls(url.starts_with("https://")), authority(trusted) {
  const auto begin = url.find("://");
  const auto colon = url.rfind(':');
  if (begin == std::string_view::npos || colon <= begin) throw std::invalid_argument("not a URL with a port: " + std::string(url));
  host = url.substr(begin + 3, colon - begin - 3);
  port = static_cast<std::uint16_t>(std::stoi(std::string(url.substr(colon + 1))));
}

struct RawSocket::Tls {
  Tls(const Endpoint& where, int descriptor) {
    ::signal(SIGPIPE, SIG_IGN);  // OpenSSL writes without MSG_NOSIGNAL
    SSL_CTX_load_verify_locations(context, where.authority.c_str(), nullptr);
    SSL_CTX_set_verify(context, SSL_VERIFY_PEER, nullptr);
    SSL_set1_host(stream, where.host.c_str());
    SSL_set_fd(stream, descriptor);
    open = SSL_connect(stream) == 1;
  }
  ~Tls() {
    SSL_free(stream);
    SSL_CTX_free(context);
  }
  SSL_CTX* context = SSL_CTX_new(TLS_client_method());
  SSL* stream = SSL_new(context);
  bool open = false;
};

RawSocket::RawSocket(const Endpoint& where) {
  addrinfo wanted{};
  wanted.ai_family = AF_INET;
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  ended_ = ::getaddrinfo(where.host.c_str(), std::to_string(where.port).c_str(), &wanted, &found) != 0;
  if (ended_) return;
  descriptor_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  ended_ = ::connect(descriptor_, found->ai_addr, found->ai_addrlen) != 0;
  ::freeaddrinfo(found);
  if (ended_ || !where.tls) return;
  tls_ = std::make_unique<Tls>(where, descriptor_);
  ended_ = !tls_->open;
}
RawSocket::~RawSocket() {
  close();
}
RawSocket::RawSocket(RawSocket&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), tls_(std::move(other.tls_)), ended_(other.ended_), buffer_(std::move(other.buffer_)) {}

void RawSocket::close() {
  tls_.reset();
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
  ended_ = true;
}

bool RawSocket::send(std::string_view bytes) {
  while (!bytes.empty() && descriptor_ >= 0 && (!tls_ || tls_->open)) {
    const ssize_t sent = tls_ ? SSL_write(tls_->stream, bytes.data(), static_cast<int>(bytes.size()))
                              : ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return bytes.empty();
}

bool RawSocket::fill(double patience_s) {
  if (ended_) return false;
  pollfd waited{descriptor_, POLLIN, 0};
  const bool decrypted = tls_ && SSL_pending(tls_->stream) > 0;
  if (!decrypted && ::poll(&waited, 1, static_cast<int>(patience_s * 1000)) <= 0) return false;
  char bytes[65536];
  const ssize_t count = tls_ ? SSL_read(tls_->stream, bytes, sizeof bytes) : ::recv(descriptor_, bytes, sizeof bytes, 0);
  if (count <= 0) {
    ended_ = true;
    return false;
  }
  buffer_.append(bytes, static_cast<std::size_t>(count));
  return true;
}

std::optional<std::string> RawSocket::read(std::size_t size, double patience_s) {
  while (buffer_.size() < size) {
    if (!fill(patience_s)) return std::nullopt;
  }
  std::string bytes = buffer_.substr(0, size);
  buffer_.erase(0, size);
  return bytes;
}

std::optional<std::string> RawSocket::read_until(std::string_view mark, double patience_s) {
  for (;;) {
    const auto at = buffer_.find(mark);
    if (at != std::string::npos) return read(at + mark.size());
    if (!fill(patience_s)) return std::nullopt;
  }
}

std::optional<std::string> RawSocket::read_to_end(double patience_s) {
  while (fill(patience_s)) {
  }
  if (!ended_) return std::nullopt;
  return std::exchange(buffer_, {});
}

RawWebsocket::RawWebsocket(const Endpoint& where, std::string_view key, std::string_view subprotocol, std::string_view path)
    : socket_(where), encoding_(encoding_of(subprotocol).value_or(Encoding::kJson)) {
  std::string request = "GET " + std::string(path) +
                        " HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n" +
                        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n";
  if (!subprotocol.empty()) request += "Sec-WebSocket-Protocol: " + std::string(subprotocol) + "\r\n";
  if (!key.empty()) request += "Authorization: Bearer " + std::string(key) + "\r\n";
  socket_.send(request + "\r\n");
  answer_ = socket_.read_until("\r\n\r\n").value_or("");
  if (answer_.size() > 12) status_ = std::atoi(answer_.c_str() + 9);
  // The accept value of that nonce is the one RFC 6455 section 1.3 computes.
  if (status_ == 101 && answer_.find("s3pPLMBiTxaQ9kYGzzhZRbK+xOo=") == std::string::npos) status_ = 0;
}

bool RawWebsocket::send_frame(int opcode, std::string_view payload) {
  std::string frame(1, static_cast<char>(0x80 | opcode));
  if (payload.size() < 126) {
    frame += static_cast<char>(0x80 | payload.size());
  } else if (payload.size() < 65536) {
    frame += static_cast<char>(0x80 | 126);
    for (const int shift : {8, 0}) frame += static_cast<char>(payload.size() >> shift & 0xff);
  } else {
    frame += static_cast<char>(0x80 | 127);
    for (int shift = 56; shift >= 0; shift -= 8) frame += static_cast<char>(payload.size() >> shift & 0xff);
  }
  const char mask[4] = {0x12, 0x34, 0x56, 0x78};
  frame.append(mask, 4);
  for (std::size_t i = 0; i < payload.size(); ++i) frame += static_cast<char>(payload[i] ^ mask[i % 4]);
  return socket_.send(frame);
}

bool RawWebsocket::send(const ClientMessage& message) {
  return send_frame(encoding_ == Encoding::kJson ? 1 : 2, encode(message, encoding_));
}

std::optional<RawWebsocket::Frame> RawWebsocket::read_frame(double patience_s) {
  for (;;) {
    const auto head = socket_.read(2, patience_s);
    if (!head) return std::nullopt;
    const auto byte = [](char value) { return static_cast<unsigned char>(value); };
    std::uint64_t size = byte((*head)[1]) & 0x7f;
    if (byte((*head)[1]) & 0x80) throw std::runtime_error("a server must not mask");
    if (size >= 126) {
      const auto more = socket_.read(size == 126 ? 2 : 8, patience_s);
      if (!more) return std::nullopt;
      size = 0;
      for (const char digit : *more) size = size << 8 | byte(digit);
    }
    auto payload = socket_.read(size, patience_s);
    if (!payload) return std::nullopt;
    const int opcode = byte((*head)[0]) & 0x0f;
    if (opcode == 9) {
      send_frame(10, *payload);
      continue;
    }
    return Frame{opcode, *std::move(payload)};
  }
}

std::optional<ServerMessage> RawWebsocket::receive(double patience_s) {
  for (;;) {
    const auto frame = read_frame(patience_s);
    if (!frame) return std::nullopt;
    if (frame->opcode == 10) continue;
    if (frame->opcode == 8) {
      const auto& code = frame->payload;
      close_code_ = code.size() >= 2 ? static_cast<unsigned char>(code[0]) << 8 | static_cast<unsigned char>(code[1]) : 1005;
      send_frame(8, frame->payload);
      return std::nullopt;
    }
    auto message = decode_server_message(frame->payload, encoding_);
    if (!message) throw std::runtime_error("the server's message does not decode: " + to_string(message.fault()));
    return *std::move(message);
  }
}

int RawWebsocket::close_code(double patience_s) {
  while (!close_code_ && receive(patience_s)) {
  }
  return close_code_.value_or(1006);
}

HttpAnswer http(const Endpoint& where, std::string_view method, std::string_view path, std::string_view key,
                std::string_view body) {
  RawSocket socket(where);
  std::string request = std::string(method) + " " + std::string(path) + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n";
  if (!key.empty()) request += "Authorization: Bearer " + std::string(key) + "\r\n";
  if (!body.empty()) request += "Content-Type: application/json\r\nContent-Length: " + std::to_string(body.size()) + "\r\n";
  socket.send(request + "\r\n" + std::string(body));
  const std::string answer = socket.read_to_end().value_or("");
  const auto split = answer.find("\r\n\r\n");
  if (split == std::string::npos) return {};
  return {std::atoi(answer.c_str() + 9), answer.substr(split + 4)};
}

}  // namespace wayfuse
