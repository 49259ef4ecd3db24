#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "proto/src/wire/message_fields.hpp"
#include "wayfuse/proto/random.hpp"

namespace wayfuse {

/// Fills messages with random values inside every limit, from the field tables; edges of ranges come up often.
class RandomFiller {
 public:
  static constexpr bool kReads = true;

  explicit RandomFiller(Random& random, std::size_t longest_list = 5) : random_(random), longest_list_(longest_list) {}

  template <typename Message>
  Message message() {
    Message message;
    alternatives("type", message);
    return message;
  }
  /// The alternative with this index, so that a test can cover all.
  template <typename Message>
  Message message(std::size_t index) {
    Message message;
    emplace(message, index, std::make_index_sequence<std::variant_size_v<Message>>{});
    return message;
  }

  template <typename T, typename K>
  void required(std::string_view, T& value, const K& kind) {
    fill(value, kind);
  }
  template <typename T, typename K>
  void optional(std::string_view, std::optional<T>& value, const K& kind) {
    if (random_.below(2) == 0) fill(value.emplace(), kind);
  }
  template <typename T, typename K>
  void defaulted(std::string_view, T& value, const K& kind, const T& = T{}) {
    if (random_.below(3) != 0) fill(value, kind);
  }
  void information(std::string_view, std::string_view) {}
  template <typename... Alternatives>
  void alternatives(std::string_view, std::variant<Alternatives...>& variant) {
    emplace(variant, random_.below(sizeof...(Alternatives)), std::index_sequence_for<Alternatives...>{});
  }
  template <typename Test>
  void expect(std::string_view, FaultCode, const char*, const Test&) {}

 private:
  template <typename Variant, std::size_t... I>
  void emplace(Variant& variant, std::size_t index, std::index_sequence<I...>) {
    static_cast<void>(((I == index && (wire::describe(*this, variant.template emplace<I>()), true)) || ...));
  }

  double real_in(double least, double most, double grain) {
    switch (random_.below(8)) {
      case 0:
        return least;
      case 1:
        return most;
      case 2:
        return std::trunc(least + (most - least) * random_.uniform());
      default:
        return wire::rounded(least + (most - least) * random_.uniform(), grain);
    }
  }
  std::string text(std::size_t least, std::size_t most, bool key) {
    static const std::vector<std::string> kPieces = {"a",  "Z", "0", "-", "_", ".",      " ", "\"",
                                                     "\\", "/", "é", "→", "𝄞", "\u2028", "{"};
    const std::size_t wanted =
        random_.below(6) == 0 ? most : least + random_.below(std::min<std::size_t>(20, most - least) + 1);
    std::string text;
    while (text.size() < wanted) {
      const std::string& piece = kPieces[random_.below(key || text.size() + 4 > wanted ? 6 : kPieces.size())];
      text += piece;
    }
    return text;
  }

  void fill(double& value, const wire::Real& kind) {
    value = wire::from_wire(real_in(kind.least, kind.most, kind.grain), kind);
  }
  template <typename T>
  void fill(T& value, const wire::Integer& kind) {
    const auto span = static_cast<std::uint64_t>(kind.most - kind.least);
    std::int64_t whole = kind.least + static_cast<std::int64_t>(random_.below(span + 1));
    if (random_.below(8) == 0) whole = kind.least;
    if (random_.below(8) == 0) whole = kind.most;
    wire::from_whole(whole, value);
  }
  template <typename T>
  void fill(T& value, wire::Compass) {
    const double degrees = real_in(0.0, 360.0, 1e6);
    wire::from_wire(degrees == 360.0 ? 0.0 : degrees, value);
  }
  void fill(bool& value, wire::Flag) { value = random_.below(2) == 0; }
  void fill(std::string& value, const wire::Text& kind) { value = text(kind.least, kind.most, kind.key); }
  void fill(std::string& value, const wire::Cause& kind) { value = text(0, kind.most, false); }
  template <typename T>
  void fill(T& value, const wire::Choice& kind) {
    value = static_cast<T>(random_.below(kind.names.size()));
  }
  void fill(Bssid& value, wire::Address) { value.value = random_.bits() >> 16; }
  void fill(std::string& value, const wire::Bytes& kind) {
    value.resize(random_.below(std::min<std::size_t>(kind.most, 64) + 1));
    for (char& c : value) c = static_cast<char>(random_.below(256));
  }
  template <typename T>
  void fill(T& value, wire::Object) {
    wire::describe(*this, value);
  }
  template <typename T, typename K>
  void fill(std::vector<T>& values, const wire::List<K>& kind) {
    const std::size_t most = std::min(kind.most, std::max(kind.least, longest_list_));
    values.resize(kind.least + random_.below(most - kind.least + 1));
    for (T& value : values) fill(value, kind.element);
    if constexpr (requires(T t) { t.time <=> t.time; }) std::ranges::sort(values, {}, &T::time);
  }

  Random& random_;
  std::size_t longest_list_;
};

}  // namespace wayfuse
