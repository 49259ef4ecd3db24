#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "proto/src/wire/message_fields.hpp"
#include "proto/src/wire/trail.hpp"

namespace wayfuse::wire {

/// Visits a value's field tables and puts every field through the gates that decoding uses.
class Checker {
 public:
  static constexpr bool kReads = false;

  explicit Checker(std::string_view root) : trail_(root) {}

  template <typename T>
  Result<void> check(const T& value) {
    describe(*this, value);
    return result();
  }
  template <typename... Alternatives>
  Result<void> check(const std::variant<Alternatives...>& message) {
    alternatives("type", message);
    return result();
  }

  template <typename T, typename K>
  void required(std::string_view name, const T& value, const K& kind) {
    if (!trail_.failed()) test(value, kind, Step{outer_, name});
  }
  template <typename T, typename K>
  void optional(std::string_view name, const std::optional<T>& value, const K& kind) {
    if (value) required(name, *value, kind);
  }
  template <typename T, typename K>
  void defaulted(std::string_view name, const T& value, const K& kind, const T& fallback = T{}) {
    if (!(value == fallback)) required(name, value, kind);
  }
  void information(std::string_view, std::string_view) {}
  template <typename... Alternatives>
  void alternatives(std::string_view, const std::variant<Alternatives...>& variant) {
    std::visit([&](const auto& alternative) { describe(*this, alternative); }, variant);
  }
  template <typename Test>
  void expect(std::string_view name, FaultCode code, const char* cause, const Test& test) {
    if (!trail_.failed() && !test()) trail_.fail(Step{outer_, name}, code, cause);
  }

 private:
  Result<void> result() {
    if (trail_.failed()) return trail_.take_fault();
    return {};
  }

  void test(double value, const Real& kind, const Step& at) { trail_.pass(at, refuse(to_wire(value, kind), kind)); }
  template <typename T>
  void test(const T& value, const Integer& kind, const Step& at) {
    trail_.pass(at, refuse(to_whole(value), kind));
  }
  template <typename T>
  void test(const T& value, Compass kind, const Step& at) {
    trail_.pass(at, refuse(to_wire(value, kind), kCompassRange));
  }
  void test(bool, Flag, const Step&) {}
  void test(const std::string& value, const Text& kind, const Step& at) { trail_.pass(at, refuse(value, kind)); }
  void test(const std::string&, const Cause&, const Step&) {}
  template <typename T>
  void test(const T& value, const Choice& kind, const Step& at) {
    trail_.pass(at, refuse(to_whole(value), Integer{0, static_cast<std::int64_t>(kind.names.size()) - 1}));
  }
  void test(Bssid value, Address, const Step& at) {
    if (value.value >> 48 != 0) trail_.fail(at, FaultCode::kOutOfRange, "an address has 48 bits");
  }
  void test(const std::string& value, const Bytes& kind, const Step& at) { trail_.pass(at, refuse_bytes(value, kind)); }
  template <typename T>
  void test(const T& value, Object, const Step& at) {
    const Step* const outer = std::exchange(outer_, &at);
    describe(*this, value);
    outer_ = outer;
  }
  template <typename T, typename K>
  void test(const std::vector<T>& values, const List<K>& kind, const Step& at) {
    if (!trail_.pass(at, refuse_count(values.size(), kind.least, kind.most))) return;
    Step element = at;
    for (element.index = 0; element.index < std::ssize(values) && !trail_.failed(); ++element.index) {
      test(values[static_cast<std::size_t>(element.index)], kind.element, element);
    }
  }

  Trail trail_;
  const Step* outer_ = nullptr;
};

}  // namespace wayfuse::wire
