#include "wayfuse/proto/codec.hpp"

#include "proto/src/wire/cbor_writer.hpp"
#include "proto/src/wire/checker.hpp"
#include "proto/src/wire/decoder.hpp"
#include "proto/src/wire/encoder.hpp"
#include "proto/src/wire/json_writer.hpp"

namespace wayfuse {
namespace {

template <typename Message>
std::string encode_message(const Message& message, Encoding encoding) {
  if (encoding == Encoding::kJson) return wire::Encoder<wire::JsonWriter>().message(message);
  return wire::Encoder<wire::CborWriter>().message(message);
}

template <typename Message>
Result<Message> decode_message(std::string_view frame, Encoding encoding) {
  if (frame.size() > Limits::kMessageBytes) {
    return Fault{FaultCode::kTooLarge, "",
                 std::to_string(frame.size()) + " bytes, at most " + std::to_string(Limits::kMessageBytes)};
  }
  const Result<wire::Tree> tree = encoding == Encoding::kJson ? wire::parse_json(frame) : wire::parse_cbor(frame);
  if (!tree) return tree.fault();
  return wire::Decoder(*tree).message<Message>();
}

}  // namespace

std::string_view subprotocol(Encoding encoding) {
  return encoding == Encoding::kJson ? kSubprotocolJson : kSubprotocolCbor;
}

std::optional<Encoding> encoding_of(std::string_view subprotocol) {
  if (subprotocol == kSubprotocolJson) return Encoding::kJson;
  if (subprotocol == kSubprotocolCbor) return Encoding::kCbor;
  return std::nullopt;
}

std::string encode(const ClientMessage& message, Encoding encoding) {
  return encode_message(message, encoding);
}
std::string encode(const ServerMessage& message, Encoding encoding) {
  return encode_message(message, encoding);
}

Result<ClientMessage> decode_client_message(std::string_view frame, Encoding encoding) {
  return decode_message<ClientMessage>(frame, encoding);
}
Result<ServerMessage> decode_server_message(std::string_view frame, Encoding encoding) {
  return decode_message<ServerMessage>(frame, encoding);
}

Result<void> check(const MotionReport& motion, std::string_view path) {
  return wire::Checker(path).check(motion);
}
Result<void> check(const RssScan& scan, std::string_view path) {
  return wire::Checker(path).check(scan);
}
Result<void> check(const ReferencePoint& point, std::string_view path) {
  return wire::Checker(path).check(point);
}
Result<void> check(const GnssFix& fix, std::string_view path) {
  return wire::Checker(path).check(fix);
}
Result<void> check(const FusedPosition& position, std::string_view path) { return wire::Checker(path).check(position); }
Result<void> check(const ClientMessage& message) {
  return wire::Checker("").check(message);
}
Result<void> check(const ServerMessage& message) {
  return wire::Checker("").check(message);
}

}  // namespace wayfuse
