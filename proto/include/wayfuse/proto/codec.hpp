#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "wayfuse/proto/message.hpp"
#include "wayfuse/proto/result.hpp"

namespace wayfuse {

/// Both spell the same messages with the same field names.
enum class Encoding : std::uint8_t { kJson, kCbor };

/// WebSocket subprotocols, in the server's order of preference.
inline constexpr std::string_view kSubprotocolCbor = "wayfuse.v1.cbor";
inline constexpr std::string_view kSubprotocolJson = "wayfuse.v1.json";
std::string_view subprotocol(Encoding encoding);
std::optional<Encoding> encoding_of(std::string_view subprotocol);

/// Encodes a message; JSON is a text frame, CBOR [RFC 8949] a binary one. Precondition: the message keeps the limits.
std::string encode(const ClientMessage& message, Encoding encoding);
std::string encode(const ServerMessage& message, Encoding encoding);

/// Decodes and checks one frame. Never throws on any input; a fault names field and cause. Unknown fields are ignored.
Result<ClientMessage> decode_client_message(std::string_view frame, Encoding encoding);
Result<ServerMessage> decode_server_message(std::string_view frame, Encoding encoding);

/// The same gate for values that did not come over the wire (the SDK's callers, imports): ranges, finiteness, text.
Result<void> check(const MotionReport& motion, std::string_view path);
Result<void> check(const RssScan& scan, std::string_view path);
Result<void> check(const ReferencePoint& point, std::string_view path);
Result<void> check(const GnssFix& fix, std::string_view path);
/// Also what a server holds against its own trackers before it says anything [SAFETY C16].
Result<void> check(const FusedPosition& position, std::string_view path);
/// Of whole messages, before they are encoded: ranges, counts, texts, consecutive sample numbers (not the encoded size).
Result<void> check(const ClientMessage& message);
Result<void> check(const ServerMessage& message);

}  // namespace wayfuse
