#include "tests/evaluation/walks/virtual_loop.hpp"

namespace wayfuse {

VirtualLoop::VirtualLoop(PhoneTime begin) : now_(begin) {}

std::uint64_t VirtualLoop::add(PhoneTime time, std::function<void()> task) {
  const std::uint64_t number = next_++;
  const PhoneTime due = std::max(time, now_);
  due_.emplace(Key{due, number}, std::move(task));
  timers_.emplace(number, due);
  return number;
}

void VirtualLoop::PhoneSide::cancel(std::uint64_t timer) {
  const auto found = loop_.timers_.find(timer);
  if (found == loop_.timers_.end()) return;
  loop_.due_.erase(Key{found->second, timer});
  loop_.timers_.erase(found);
}

void VirtualLoop::run_until(PhoneTime time) {
  while (!due_.empty() && due_.begin()->first.first <= time) {
    auto next = due_.extract(due_.begin());
    now_ = next.key().first;
    timers_.erase(next.key().second);
    next.mapped()();
  }
  now_ = std::max(now_, time);
}

// Both ends of the wire. It lives until the last frame in flight has landed.
struct LoopLink::Wire final : SessionOutput, std::enable_shared_from_this<LoopLink::Wire> {
  Wire(VirtualLoop& loop_in, SessionWorld& world_in, Rights rights_in, Encoding encoding_in)
      : loop(loop_in), world(world_in), rights(rights_in), encoding(encoding_in) {}

  void send(const ServerMessage& message) override {
    loop.post([self = shared_from_this(), frame = encode(message, encoding)] {
      if (self->up && self->events.received) self->events.received(frame);
    });
  }
  bool congested() const override { return false; }
  void close(const Fault& reason) override {
    send(FaultReport{reason, 0, {}, Duration{0}});
    hang_up(to_string(reason));
  }
  void finish() override { hang_up("goodbye"); }

  void hang_up(const std::string& reason) {
    loop.post([self = shared_from_this(), reason] {
      if (!std::exchange(self->up, false)) return;
      if (self->conversation) self->conversation->disconnected();
      if (self->events.closed) self->events.closed(reason);
    });
  }

  VirtualLoop& loop;
  SessionWorld& world;
  const Rights rights;
  const Encoding encoding;
  Events events;
  std::shared_ptr<Conversation> conversation;
  bool up = false;
};

LoopLink::LoopLink(VirtualLoop& loop, SessionWorld& world, Rights rights, Encoding encoding)
    : wire_(std::make_shared<Wire>(loop, world, rights, encoding)) {}

LoopLink::~LoopLink() {
  wire_->up = false;
  wire_->events = {};
  wire_->conversation.reset();
}

void LoopLink::open(Events events) {
  wire_->events = std::move(events);
  wire_->loop.post([wire = wire_] {
    wire->up = true;
    const Post post = [wire_weak = std::weak_ptr(wire)](std::function<void()> task) {
      if (const auto held = wire_weak.lock()) held->loop.post(std::move(task));
    };
    const Rights rights = wire->rights;
    wire->conversation =
        begin_conversation(wire->world, *wire, post, rights, [rights](std::string_view) { return Result<Rights>(rights); });
    if (wire->events.opened) wire->events.opened(wire->encoding);
  });
}

bool LoopLink::send(std::string frame) {
  wire_->loop.post([wire = wire_, frame = std::move(frame)] {
    if (!wire->up || !wire->conversation) return;
    auto message = decode_client_message(frame, wire->encoding);
    if (message)
      wire->conversation->receive(*std::move(message));
    else
      wire->conversation->receive(message.fault());
  });
  return true;
}

void LoopLink::close() {
  wire_->hang_up("closed by the phone");
}

}  // namespace wayfuse
