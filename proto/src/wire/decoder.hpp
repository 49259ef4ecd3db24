#pragma once

#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "proto/src/wire/message_fields.hpp"
#include "proto/src/wire/text.hpp"
#include "proto/src/wire/trail.hpp"
#include "proto/src/wire/tree.hpp"

namespace wayfuse::wire {

/// Visits a message's field tables and fills every field from a parsed frame. Fields the table does not know are ignored; a
/// null counts as absent.
class Decoder {
 public:
  static constexpr bool kReads = true;

  explicit Decoder(const Tree& tree) : tree_(tree), trail_("") {}

  template <typename Message>
  Result<Message> message() {
    Message message;
    read(0, message, Step{});
    if (trail_.failed()) return trail_.take_fault();
    return message;
  }

  template <typename T, typename K>
  [[gnu::always_inline]] void required(std::string_view name, T& value, const K& kind) {
    if (trail_.failed()) return;
    const std::uint32_t node = find(name);
    if (node == 0) return trail_.fail(step(name), FaultCode::kMissingField, "is required");
    read(node, value, kind, step(name));
  }
  template <typename T, typename K>
  [[gnu::always_inline]] void optional(std::string_view name, std::optional<T>& value, const K& kind) {
    if (trail_.failed()) return;
    if (const std::uint32_t node = find(name)) read(node, value.emplace(), kind, step(name));
  }
  template <typename T, typename K>
  [[gnu::always_inline]] void defaulted(std::string_view name, T& value, const K& kind, const T& = T{}) {
    if (trail_.failed()) return;
    if (const std::uint32_t node = find(name)) read(node, value, kind, step(name));
  }
  void information(std::string_view, std::string_view) {}

  template <typename... Alternatives>
  void alternatives(std::string_view tag, std::variant<Alternatives...>& variant) {
    if (trail_.failed()) return;
    const std::uint32_t node = find(tag);
    if (node == 0) return trail_.fail(step(tag), FaultCode::kMissingField, "is required");
    if (tree_.nodes[node].kind != Kind::kText) return wrong_type(node, "a text", step(tag));
    const std::string_view name = tree_.nodes[node].view();
    const bool known =
        ((name == kWireName<Alternatives> && (describe(*this, variant.template emplace<Alternatives>()), true)) || ...);
    if (known) return;
    std::string cause = quoted(name) + " is none of";
    ((cause.append(" ").append(kWireName<Alternatives>)), ...);
    trail_.fail(step(tag), tag == "type" ? FaultCode::kUnknownType : FaultCode::kUnknownName, std::move(cause));
  }
  template <typename Test>
  void expect(std::string_view name, FaultCode code, const char* cause, const Test& test) {
    if (!trail_.failed() && !test()) trail_.fail(step(name), code, cause);
  }

 private:
  /// The map being read, and where in it the next field is looked for first: the order of the tables costs nothing.
  struct Scope {
    const Step* step = nullptr;
    std::uint32_t map = 0;
    std::uint32_t next = 0;
    std::uint32_t end = 0;
    std::uint32_t left = 0;  ///< pairs no field has asked for yet; a table asks for each name once
  };

  Step step(std::string_view name) const { return Step{scope_.step, name}; }

  /// Node of the field's value; 0 = absent or null.
  [[gnu::always_inline]] std::uint32_t find(std::string_view name) {
    // Inlined with the name a constant, the comparison is a few instructions: peers that keep the tables' order pay no search.
    if (scope_.left == 0) return 0;
    const std::uint32_t key = scope_.next;
    if (key == scope_.end) return search(name);
    const Node& node = tree_.nodes[key];
    return node.size == name.size() && std::memcmp(node.text, name.data(), name.size()) == 0 ? found(key) : search(name);
  }
  std::uint32_t found(std::uint32_t key) {
    --scope_.left;
    scope_.next = tree_.after(key + 1);
    return tree_.nodes[key + 1].kind == Kind::kNull ? 0 : key + 1;
  }
  std::uint32_t search(std::string_view name);

  void wrong_type(std::uint32_t node, const char* wanted, const Step& at);
  bool real(std::uint32_t node, double& value, const Step& at);
  void read(std::uint32_t node, double& value, const Real& kind, const Step& at);
  bool whole(std::uint32_t node, std::int64_t& value, const Integer& kind, const Step& at);
  void read(std::uint32_t node, bool& value, Flag, const Step& at);
  void read(std::uint32_t node, std::string& value, const Text& kind, const Step& at);
  void read(std::uint32_t node, std::string& value, const Cause& kind, const Step& at) {
    read(node, value, Text{0, kind.most}, at);
  }
  void read(std::uint32_t node, std::string& value, const Bytes& kind, const Step& at);
  void read(std::uint32_t node, Bssid& value, Address, const Step& at);
  std::ptrdiff_t choice(std::uint32_t node, const Choice& kind, const Step& at);

  template <typename T>
  void read(std::uint32_t node, T& value, const Integer& kind, const Step& at) {
    std::int64_t number = 0;
    if (whole(node, number, kind, at)) from_whole(number, value);
  }
  template <typename T>
  void read(std::uint32_t node, T& value, Compass, const Step& at) {
    double degrees = 0.0;
    if (real(node, degrees, at) && trail_.pass(at, refuse(degrees, kCompassRange))) from_wire(degrees, value);
  }
  template <typename T>
  void read(std::uint32_t node, T& value, const Choice& kind, const Step& at) {
    const std::ptrdiff_t index = choice(node, kind, at);
    if (index >= 0) value = static_cast<T>(index);
  }
  template <typename T>
  void read(std::uint32_t node, T& value, Object, const Step& at) {
    if (tree_.nodes[node].kind != Kind::kMap) return wrong_type(node, "a map", at);
    const Scope outer = std::exchange(scope_, Scope{&at, node, node + 1, tree_.nodes[node].end, tree_.nodes[node].size});
    describe(*this, value);
    scope_ = outer;
  }
  /// A whole message.
  template <typename... Alternatives>
  void read(std::uint32_t node, std::variant<Alternatives...>& message, const Step& at) {
    if (tree_.nodes[node].kind != Kind::kMap) return wrong_type(node, "a map", at);
    scope_ = Scope{&at, node, node + 1, tree_.nodes[node].end, tree_.nodes[node].size};
    alternatives("type", message);
  }
  template <typename T, typename K>
  void read(std::uint32_t node, std::vector<T>& values, const List<K>& kind, const Step& at) {
    const Node& list = tree_.nodes[node];
    if (list.kind != Kind::kList) return wrong_type(node, "a list", at);
    if (!trail_.pass(at, refuse_count(list.size, kind.least, kind.most))) return;
    values.resize(list.size);
    Step element = at;
    std::uint32_t member = node + 1;
    for (T& value : values) {
      ++element.index;
      read(member, value, kind.element, element);
      if (trail_.failed()) return;
      member = tree_.after(member);
    }
  }

  const Tree& tree_;
  Trail trail_;
  Scope scope_;
};

}  // namespace wayfuse::wire
