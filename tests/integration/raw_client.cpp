#include "tests/integration/raw_client.hpp"

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <stdexcept>
#include <utility>

namespace wayfuse {

RawSocket::RawSocket(std::uint16_t port) : descriptor_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) ended_ = true;
}
RawSocket::~RawSocket() {
  close();
}
RawSocket::RawSocket(RawSocket&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), ended_(other.ended_), buffer_(std::move(other.buffer_)) {}

void RawSocket::close() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
  ended_ = true;
}

bool RawSocket::send(std::string_view bytes) {
  while (!bytes.empty() && descriptor_ >= 0) {
    const ssize_t sent = ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return bytes.empty();
}

std::size_t RawSocket::send_some(std::string_view bytes) {
  const ssize_t sent = ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  return sent > 0 ? static_cast<std::size_t>(sent) : 0;
}

bool RawSocket::fill(double patience_s) {
  if (ended_) return false;
  pollfd waited{descriptor_, POLLIN, 0};
  if (::poll(&waited, 1, static_cast<int>(patience_s * 1000)) <= 0) return false;
  char bytes[65536];
  const ssize_t count = ::recv(descriptor_, bytes, sizeof bytes, 0);
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

RawWebsocket::RawWebsocket(std::uint16_t port, std::string_view key, std::string_view subprotocol, std::string_view path)
    : socket_(port), encoding_(encoding_of(subprotocol).value_or(Encoding::kJson)) {
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

HttpAnswer http(std::uint16_t port, std::string_view method, std::string_view path, std::string_view key,
                std::string_view body) {
  RawSocket socket(port);
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
