#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "tests/fuzz/promises.hpp"
#include "wayfuse/proto/codec.hpp"

/// What must hold for every frame, whatever its bytes: shared by the fuzz targets of the wire.
namespace wayfuse::fuzzing {

inline Result<ClientMessage> decode(std::string_view frame, Encoding encoding, const ClientMessage*) {
  return decode_client_message(frame, encoding);
}
inline Result<ServerMessage> decode(std::string_view frame, Encoding encoding, const ServerMessage*) {
  return decode_server_message(frame, encoding);
}

/// A message that passed can be sent on, and then stays what it is.
template <typename Message>
void message_is_stable(const Message& message) {
  const Result<void> checked = check(message);
  demand(checked.has_value(), "what was decoded passes the checks", checked ? "" : to_string(checked.fault()));
  for (const Encoding encoding : {Encoding::kJson, Encoding::kCbor}) {
    const std::string frame = encode(message, encoding);
    if (frame.size() > Limits::kMessageBytes) continue;  // CBOR of the full size is longer in JSON
    const Result<Message> once = decode(frame, encoding, static_cast<const Message*>(nullptr));
    demand(once.has_value(), "what was encoded is decoded", once ? "" : to_string(once.fault()) + " in " + frame);
    const Result<Message> twice = decode(encode(*once, encoding), encoding, static_cast<const Message*>(nullptr));
    demand(twice.has_value() && *once == *twice, "a second round changes nothing", frame);
  }
}

template <typename Message>
int run(const std::uint8_t* data, std::size_t size, Encoding encoding) {
  const Result<Message> message = decode(as_text(data, size), encoding, static_cast<const Message*>(nullptr));
  if (message) {
    message_is_stable(*message);
  } else {
    fault_is_presentable(message.fault());
  }
  return 0;
}

}  // namespace wayfuse::fuzzing
