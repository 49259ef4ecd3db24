#include "proto/src/wire/decoder.hpp"

#include <algorithm>

namespace wayfuse::wire {
namespace {

const char* name_of(Kind kind) {
  switch (kind) {
    case Kind::kNull:
      return "null";
    case Kind::kFalse:
    case Kind::kTrue:
      return "true or false";
    case Kind::kInteger:
    case Kind::kReal:
      return "a number";
    case Kind::kText:
      return "a text";
    case Kind::kBytes:
      return "bytes";
    case Kind::kList:
      return "a list";
    case Kind::kMap:
      return "a map";
  }
  return "something else";
}

}  // namespace

std::uint32_t Decoder::search(std::string_view name) {
  std::uint32_t key = scope_.next;
  for (std::uint32_t pair = tree_.nodes[scope_.map].size; pair > 0; --pair) {
    if (key == scope_.end) key = scope_.map + 1;
    if (tree_.nodes[key].view() == name) return found(key);
    key = tree_.after(key + 1);
  }
  return 0;
}

void Decoder::wrong_type(std::uint32_t node, const char* wanted, const Step& at) {
  trail_.fail(at, FaultCode::kWrongType, std::string(wanted) + " is expected, not " + name_of(tree_.nodes[node].kind));
}

bool Decoder::real(std::uint32_t node, double& value, const Step& at) {
  const Node& found = tree_.nodes[node];
  if (found.kind == Kind::kInteger) {
    value = static_cast<double>(found.integer);
  } else if (found.kind == Kind::kReal) {
    value = found.real;
  } else {
    wrong_type(node, "a number", at);
    return false;
  }
  return true;
}

void Decoder::read(std::uint32_t node, double& value, const Real& kind, const Step& at) {
  double wire = 0.0;
  if (real(node, wire, at) && trail_.pass(at, refuse(wire, kind))) value = from_wire(wire, kind);
}

bool Decoder::whole(std::uint32_t node, std::int64_t& value, const Integer& kind, const Step& at) {
  const Node& found = tree_.nodes[node];
  if (found.kind == Kind::kInteger) {
    value = found.integer;
  } else {
    double wire = 0.0;
    if (!real(node, wire, at)) return false;
    const auto least = static_cast<double>(kind.least);
    const auto most = static_cast<double>(kind.most);
    if (!(wire >= least && wire <= most)) return trail_.pass(at, outside(wire, least, most));
    if (wire != std::floor(wire)) {
      trail_.fail(at, FaultCode::kWrongType, shown(wire) + " is not a whole number");
      return false;
    }
    value = static_cast<std::int64_t>(wire);
  }
  return trail_.pass(at, refuse(value, kind));
}

void Decoder::read(std::uint32_t node, bool& value, Flag, const Step& at) {
  const Kind kind = tree_.nodes[node].kind;
  if (kind != Kind::kTrue && kind != Kind::kFalse) return wrong_type(node, "true or false", at);
  value = kind == Kind::kTrue;
}

void Decoder::read(std::uint32_t node, std::string& value, const Text& kind, const Step& at) {
  const Node& found = tree_.nodes[node];
  if (found.kind != Kind::kText) return wrong_type(node, "a text", at);
  if (trail_.pass(at, refuse(found.view(), kind))) value = found.view();
}

void Decoder::read(std::uint32_t node, std::string& value, const Bytes& kind, const Step& at) {
  const Node& found = tree_.nodes[node];
  if (found.kind == Kind::kBytes) {
    if (trail_.pass(at, refuse_bytes(found.view(), kind))) value = found.view();
    return;
  }
  if (found.kind != Kind::kText) return wrong_type(node, "base64 text or bytes", at);
  if (!trail_.pass(at, refuse_count(found.size, 0, (kind.most + 2) / 3 * 4))) return;
  std::optional<std::string> bytes = from_base64(found.view());
  if (!bytes) return trail_.fail(at, FaultCode::kBadText, "is not base64");
  if (trail_.pass(at, refuse_bytes(*bytes, kind))) value = *std::move(bytes);
}

void Decoder::read(std::uint32_t node, Bssid& value, Address, const Step& at) {
  const Node& found = tree_.nodes[node];
  if (found.kind == Kind::kText) {
    const std::optional<Bssid> bssid = parse_bssid(found.view());
    if (!bssid) return trail_.fail(at, FaultCode::kBadText, quoted(found.view()) + " is no address like aa:bb:cc:dd:ee:ff");
    value = *bssid;
  } else if (found.kind == Kind::kBytes) {
    if (found.size != 6)
      return trail_.fail(at, FaultCode::kOutOfRange, std::to_string(found.size) + " bytes; an address has 6");
    value.value = 0;
    for (const char byte : found.view()) value.value = value.value << 8 | static_cast<unsigned char>(byte);
  } else {
    wrong_type(node, "an address", at);
  }
}

std::ptrdiff_t Decoder::choice(std::uint32_t node, const Choice& kind, const Step& at) {
  const Node& found = tree_.nodes[node];
  if (found.kind != Kind::kText) {
    wrong_type(node, "a text", at);
    return -1;
  }
  const auto name = std::ranges::find(kind.names, found.view());
  if (name != kind.names.end()) return name - kind.names.begin();
  std::string cause = quoted(found.view()) + " is none of";
  for (const std::string_view known : kind.names) cause.append(" ").append(known);
  trail_.fail(at, FaultCode::kUnknownName, std::move(cause));
  return -1;
}

}  // namespace wayfuse::wire
