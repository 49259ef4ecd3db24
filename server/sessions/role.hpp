#pragma once

#include <memory>

#include "server/sessions/session.hpp"
#include "server/sessions/session_world.hpp"

namespace wayfuse {

/// What a conversation does once its hello said what it is for. Thread: the connection's strand.
class RoleConversation {
 public:
  virtual ~RoleConversation() = default;
  /// False = a message that does not belong in this role.
  virtual bool receive(ClientMessage& message) = 0;
  virtual void tick() = 0;
  virtual Duration tick_interval() const { return std::chrono::seconds(1); }
  /// Whether silence ends it [SAFETY C11]: observers have nothing to say.
  virtual bool must_speak() const { return true; }
  virtual void goodbye() = 0;
  virtual void disconnected() = 0;
};

/// What a role is made with.
struct RoleSeat {
  SessionWorld& world;
  SessionOutput& output;
  Post post;
  Rights rights;
};

/// Each answers with `welcome` on success; on a fault nothing was said yet.
Result<std::shared_ptr<RoleConversation>> begin_tracking(RoleSeat seat, const Hello& hello);
Result<std::shared_ptr<RoleConversation>> begin_surveying(RoleSeat seat, const Hello& hello);
Result<std::shared_ptr<RoleConversation>> begin_observing(RoleSeat seat, const Hello& hello);

/// A fault that does not end the connection.
inline FaultReport report(Fault fault, std::uint64_t sequence = 0, std::string idempotency_key = {},
                          Duration retry_after = Duration{0}) {
  return {std::move(fault), sequence, std::move(idempotency_key), retry_after};
}

/// What every welcome says; `building` may be null.
Welcome welcome_from(const SessionWorld& world, const Building* building, std::optional<UnixTime> expires_at);
/// What is left until then; 0 = no expiry.
Duration time_left(const SessionWorld& world, std::optional<UnixTime> expires_at);

}  // namespace wayfuse
