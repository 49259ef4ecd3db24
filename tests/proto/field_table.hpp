#pragma once

#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "proto/src/wire/message_fields.hpp"
#include "proto/src/wire/text.hpp"

namespace wayfuse {

/// Names of the maps that stand inside messages, as proto/README.md calls them.
template <typename T>
inline constexpr std::string_view kPartName = wire::kWireName<T>;
// clang-format off
template <> inline constexpr std::string_view kPartName<Place> = "place";
template <> inline constexpr std::string_view kPartName<GeoPoint> = "geo point";
template <> inline constexpr std::string_view kPartName<Georeference> = "georeference";
template <> inline constexpr std::string_view kPartName<MagneticField> = "magnetic field";
template <> inline constexpr std::string_view kPartName<ScanReading> = "reading";
template <> inline constexpr std::string_view kPartName<ReferencePoint> = "reference point";
template <> inline constexpr std::string_view kPartName<Covariance> = "covariance";
template <> inline constexpr std::string_view kPartName<FloorProbability> = "floor probability";
template <> inline constexpr std::string_view kPartName<Contributions> = "contributions";
template <> inline constexpr std::string_view kPartName<FusedPosition> = "fused position";
template <> inline constexpr std::string_view kPartName<Fault> = "reason";
template <> inline constexpr std::string_view kPartName<Resume> = "resume";
template <> inline constexpr std::string_view kPartName<Sample> = "sample";
template <> inline constexpr std::string_view kPartName<WayPoint> = "way point";
template <> inline constexpr std::string_view kPartName<FloorName> = "floor name";
template <> inline constexpr std::string_view kPartName<Observed> = "observed";
// clang-format on

/// One row of a table of proto/README.md, without its last column, the meaning.
struct FieldRow {
  std::string name;
  std::string type;
  std::string range;
  std::string needed;
};
struct FieldTable {
  std::string title;
  std::vector<FieldRow> rows;
};

/// Visits the field tables of all messages, and of every map inside them, and writes them down once each.
class Documenter {
 public:
  static constexpr bool kReads = false;

  template <typename... Alternatives>
  void messages(const std::variant<Alternatives...>*) {
    (table(kPartName<Alternatives>, Alternatives{}), ...);
  }
  const std::vector<FieldTable>& tables() const { return tables_; }

  template <typename T, typename K>
  void required(std::string_view name, const T& value, const K& kind) {
    row(name, value, kind, "yes");
  }
  template <typename T, typename K>
  void optional(std::string_view name, const std::optional<T>&, const K& kind) {
    row(name, T{}, kind, "no");
  }
  template <typename T, typename K>
  void defaulted(std::string_view name, const T& value, const K& kind, const T& fallback = T{}) {
    std::string standard = "empty";
    if constexpr (std::is_same_v<T, bool>) {
      standard = fallback ? "true" : "false";
    } else if constexpr (std::is_same_v<K, wire::Real> || std::is_same_v<K, wire::Integer>) {
      standard = "0";
    } else if constexpr (std::is_same_v<K, wire::Object>) {
      standard = "zeros";
    }
    row(name, value, kind, "no: " + standard);
  }
  void information(std::string_view name, std::string_view) {
    here_.push_back({std::string(name), "text", "for people", "ignored"});
  }
  template <typename... Alternatives>
  void alternatives(std::string_view tag, const std::variant<Alternatives...>&) {
    std::string names;
    ((names.append(names.empty() ? "`" : ", `").append(kPartName<Alternatives>).append("`")), ...);
    here_.push_back({std::string(tag), "text", names, "yes"});
    (later(Alternatives{}), ...);
  }
  template <typename Test>
  void expect(std::string_view, FaultCode, const char*, const Test&) {}

 private:
  template <typename T>
  void table(std::string_view title, const T& value) {
    if (!seen_.insert(std::string(title)).second) return;
    std::vector<FieldRow> outer;
    std::swap(here_, outer);
    const std::size_t place = tables_.size();
    tables_.push_back({std::string(title), {}});
    wire::describe(*this, value);
    tables_[place].rows = std::move(here_);
    here_ = std::move(outer);
  }
  template <typename T>
  void later(const T& value) {
    table(kPartName<T>, value);
  }

  template <typename T, typename K>
  void row(std::string_view name, const T& value, const K& kind, std::string needed) {
    here_.push_back({std::string(name), type(value, kind), range(kind), std::move(needed)});
    nested(value, kind);
  }

  static std::string with_unit(std::string text, std::string_view unit) {
    return unit.empty() ? text : text.append(", ").append(unit);
  }
  template <typename T>
  static std::string type(const T&, const wire::Real& kind) {
    return with_unit("number", kind.unit);
  }
  template <typename T>
  static std::string type(const T&, const wire::Integer& kind) {
    return with_unit("integer", kind.unit);
  }
  template <typename T>
  static std::string type(const T&, wire::Compass) {
    return "number, deg";
  }
  template <typename T>
  static std::string type(const T&, wire::Flag) {
    return "true or false";
  }
  template <typename T>
  static std::string type(const T&, const wire::Text& kind) {
    return kind.key ? "key" : "text";
  }
  template <typename T>
  static std::string type(const T&, const wire::Cause&) {
    return "text";
  }
  template <typename T>
  static std::string type(const T&, const wire::Choice&) {
    return "text";
  }
  template <typename T>
  static std::string type(const T&, wire::Address) {
    return "address";
  }
  template <typename T>
  static std::string type(const T&, const wire::Bytes&) {
    return "bytes";
  }
  template <typename T>
  static std::string type(const T&, wire::Object) {
    return "map: " + std::string(kPartName<T>);
  }
  template <typename T, typename K>
  static std::string type(const std::vector<T>&, const wire::List<K>& kind) {
    const std::string element = type(T{}, kind.element);
    return "list of " + (element.starts_with("map: ") ? element.substr(5) : element);
  }

  static std::string between(std::int64_t least, std::int64_t most) {
    const std::string end = most == Limits::kLargestInteger ? "2^53-1" : std::to_string(most);
    return (least == -Limits::kLargestInteger ? "-(2^53-1)" : std::to_string(least)) + ".." + end;
  }
  static std::string range(const wire::Real& kind) { return wire::shown(kind.least) + ".." + wire::shown(kind.most); }
  static std::string range(const wire::Integer& kind) { return between(kind.least, kind.most); }
  static std::string range(wire::Compass) { return "0..360"; }
  static std::string range(wire::Flag) { return ""; }
  static std::string range(const wire::Text& kind) {
    return std::to_string(kind.least) + ".." + std::to_string(kind.most) + " bytes";
  }
  static std::string range(const wire::Cause& kind) { return "0.." + std::to_string(kind.most) + " bytes"; }
  static std::string range(const wire::Choice& kind) {
    std::string names;
    for (const std::string_view name : kind.names) names.append(names.empty() ? "`" : ", `").append(name).append("`");
    return names;
  }
  static std::string range(wire::Address) { return "48 bits"; }
  static std::string range(const wire::Bytes& kind) { return "0.." + std::to_string(kind.most) + " bytes"; }
  static std::string range(wire::Object) { return ""; }
  template <typename K>
  static std::string range(const wire::List<K>& kind) {
    const std::string count = std::to_string(kind.least) + ".." + std::to_string(kind.most);
    const std::string element = range(kind.element);
    return element.empty() ? count : count + " of " + element;
  }

  template <typename T, typename K>
  void nested(const T&, const K&) {}
  template <typename T>
  void nested(const T& value, wire::Object) {
    later(value);
  }
  template <typename T>
  void nested(const std::vector<T>&, const wire::List<wire::Object>&) {
    later(T{});
  }

  std::set<std::string> seen_;
  std::vector<FieldRow> here_;
  std::vector<FieldTable> tables_;
};

inline std::vector<FieldTable> all_field_tables() {
  Documenter documenter;
  documenter.messages(static_cast<const ClientMessage*>(nullptr));
  documenter.messages(static_cast<const ServerMessage*>(nullptr));
  return documenter.tables();
}

}  // namespace wayfuse
