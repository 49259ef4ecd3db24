#pragma once

#include <cassert>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "proto/src/wire/message_fields.hpp"
#include "proto/src/wire/text.hpp"

namespace wayfuse::wire {

/// Visits a message's field tables and spells every field through a writer. Precondition: check() passes.
template <typename Writer>
class Encoder {
 public:
  static constexpr bool kReads = false;

  template <typename... Alternatives>
  std::string message(const std::variant<Alternatives...>& message) {
    writer_.begin_map();
    alternatives("type", message);
    writer_.end_map();
    return writer_.take();
  }

  template <typename T, typename K>
  void required(std::string_view name, const T& value, const K& kind) {
    writer_.key(name);
    write(value, kind);
  }
  template <typename T, typename K>
  void optional(std::string_view name, const std::optional<T>& value, const K& kind) {
    if (value) required(name, *value, kind);
  }
  template <typename T, typename K>
  void defaulted(std::string_view name, const T& value, const K& kind, const T& fallback = T{}) {
    if (!(value == fallback)) required(name, value, kind);
  }
  void information(std::string_view name, std::string_view text) {
    writer_.key(name);
    writer_.text(text);
  }
  template <typename... Alternatives>
  void alternatives(std::string_view tag, const std::variant<Alternatives...>& variant) {
    std::visit(
        [&]<typename T>(const T& alternative) {
          writer_.key(tag);
          writer_.text(kWireName<T>);
          describe(*this, alternative);
        },
        variant);
  }
  template <typename Test>
  void expect(std::string_view, FaultCode, const char*, const Test& test) {
    assert(test());
    static_cast<void>(test);
  }

 private:
  void write(double value, const Real& kind) {
    assert(std::isfinite(value));
    writer_.real(to_wire(value, kind));
  }
  template <typename T>
  void write(const T& value, const Integer&) {
    writer_.integer(to_whole(value));
  }
  template <typename T>
  void write(const T& value, Compass kind) {
    writer_.real(to_wire(value, kind));
  }
  void write(bool value, Flag) { writer_.flag(value); }
  void write(const std::string& value, const Text&) { writer_.text(value); }
  void write(const std::string& value, const Cause& kind) { writer_.text(clipped(value, kind.most)); }
  template <typename T>
  void write(const T& value, const Choice& kind) {
    writer_.text(kind.names[static_cast<std::size_t>(value)]);
  }
  void write(Bssid value, Address) { writer_.address(value); }
  void write(const std::string& value, const Bytes&) { writer_.bytes(value); }
  template <typename T>
  void write(const T& value, Object) {
    writer_.begin_map();
    describe(*this, value);
    writer_.end_map();
  }
  template <typename T, typename K>
  void write(const std::vector<T>& values, const List<K>& kind) {
    writer_.begin_list(values.size());
    for (const T& value : values) write(value, kind.element);
    writer_.end_list();
  }

  Writer writer_;
};

}  // namespace wayfuse::wire
