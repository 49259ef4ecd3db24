#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <utility>

#include "server/sessions/session.hpp"
#include "server/sessions/session_world.hpp"
#include "wayfuse/proto/codec.hpp"
#include "wayfuse/sdk/link.hpp"

namespace wayfuse {

/// A phone and a server that share one virtual clock: what is due runs in order of time, then of being asked for. Time
/// stands still while anything is due, so the network between them costs none.
///
/// Thread: confined to its owner.
class VirtualLoop {
 public:
  explicit VirtualLoop(PhoneTime begin);
  VirtualLoop(const VirtualLoop&) = delete;
  VirtualLoop& operator=(const VirtualLoop&) = delete;

  Scheduler& phone() { return phone_; }
  const Clock& server() const { return server_; }
  /// Runs a task at the present time, after what is due already.
  void post(std::function<void()> task) { add(now_, std::move(task)); }
  /// Lets time pass: everything due by `time` has run when this returns.
  void run_until(PhoneTime time);
  PhoneTime now() const { return now_; }

 private:
  class PhoneSide final : public Scheduler {
   public:
    explicit PhoneSide(VirtualLoop& loop) : loop_(loop) {}
    PhoneTime now() const override { return loop_.now_; }
    std::uint64_t after(Duration delay, std::function<void()> task) override {
      return loop_.add(loop_.now_ + delay, std::move(task));
    }
    void cancel(std::uint64_t timer) override;

   private:
    VirtualLoop& loop_;
  };
  class ServerSide final : public Clock {
   public:
    explicit ServerSide(const VirtualLoop& loop) : loop_(loop) {}
    ServerTime now() const override { return ServerTime(loop_.now_.time_since_epoch()); }
    UnixTime wall_now() const override { return UnixTime(loop_.now_.time_since_epoch()); }

   private:
    const VirtualLoop& loop_;
  };
  using Key = std::pair<PhoneTime, std::uint64_t>;

  std::uint64_t add(PhoneTime time, std::function<void()> task);

  PhoneTime now_;
  std::uint64_t next_ = 1;
  std::map<Key, std::function<void()>> due_;
  std::map<std::uint64_t, PhoneTime> timers_;
  PhoneSide phone_{*this};
  ServerSide server_{*this};
};

/// The phone's end of a connection to a conversation in the same loop. Every message is encoded and decoded on its way, as
/// on a socket.
class LoopLink final : public Link {
 public:
  LoopLink(VirtualLoop& loop, SessionWorld& world, Rights rights, Encoding encoding);
  ~LoopLink() override;
  void open(Events events) override;
  bool send(std::string frame) override;
  void close() override;

 private:
  struct Wire;
  std::shared_ptr<Wire> wire_;
};

}  // namespace wayfuse
