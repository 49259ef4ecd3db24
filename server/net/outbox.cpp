#include "server/net/outbox.hpp"

namespace wayfuse {

bool Outbox::push(const ServerMessage& message) {
  if (const auto* ack = std::get_if<Ack>(&message)) {
    ack_ = *ack;
    return true;
  }
  if (std::holds_alternative<Position>(message) || std::holds_alternative<NoFix>(message)) {
    position_ = message;
    return true;
  }
  std::string frame = encode(message, encoding_);
  if (frames_.size() >= bounds_.messages || bytes_ + frame.size() > bounds_.bytes) return false;
  bytes_ += frame.size();
  frames_.push_back(std::move(frame));
  return true;
}

std::optional<std::string> Outbox::pop() {
  if (!frames_.empty()) {
    std::string frame = std::move(frames_.front());
    frames_.pop_front();
    bytes_ -= frame.size();
    return frame;
  }
  if (ack_) {
    const ServerMessage ack = *ack_;
    ack_.reset();
    return encode(ack, encoding_);
  }
  if (position_) {
    const ServerMessage position = *std::move(position_);
    position_.reset();
    return encode(position, encoding_);
  }
  return std::nullopt;
}

void Outbox::clear() {
  frames_.clear();
  bytes_ = 0;
  ack_.reset();
  position_.reset();
}

}  // namespace wayfuse
