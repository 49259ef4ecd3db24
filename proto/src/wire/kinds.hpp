#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "wayfuse/proto/fault.hpp"
#include "wayfuse/proto/heading.hpp"
#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/time.hpp"

/// The kinds of field the wire knows. A field table (fields.hpp) gives each field its name and one of these; encoder, decoder,
/// checker and documentation all read the same table.
namespace wayfuse::wire {

/// A number: finite, least..most in the wire's unit. The wire's value is `scale` times ours, rounded to 1 / `grain`.
struct Real {
  double least;
  double most;
  std::string_view unit;
  double grain = 1e6;
  double scale = 1.0;
};
/// A whole number, also of a time or duration (microseconds), an id, a floor.
struct Integer {
  std::int64_t least;
  std::int64_t most;
  std::string_view unit = "";
};
/// A compass azimuth in degrees, 0..360, of a Heading or of an azimuth in radians.
struct Compass {};
struct Flag {};
/// A text without control characters; `key` = only [A-Za-z0-9._-].
struct Text {
  std::size_t least;
  std::size_t most;
  bool key = false;
};
/// Words for people from our own faults: whatever they hold is made fit and cut to `most` when encoded.
struct Cause {
  std::size_t most;
};
/// One of a closed set, in the order of the enumerators.
struct Choice {
  std::span<const std::string_view> names;
};
/// A transmitter's address: text in JSON, six bytes in CBOR.
struct Address {};
/// Opaque bytes: base64 in JSON.
struct Bytes {
  std::size_t most;
};
/// A map with the field table of its type.
struct Object {};
template <typename Element>
struct List {
  std::size_t least;
  std::size_t most;
  Element element;
};
template <typename Element>
List(std::size_t, std::size_t, Element) -> List<Element>;

// ---------------------------------------------------------------- between our types and the wire's numbers

template <typename T>
std::int64_t to_whole(const T& value) {
  if constexpr (std::is_enum_v<T>) {
    return static_cast<std::int64_t>(value);
  } else if constexpr (std::is_integral_v<T>) {
    constexpr auto kMost = std::numeric_limits<std::int64_t>::max();
    return std::cmp_greater(value, kMost) ? kMost : static_cast<std::int64_t>(value);
  } else if constexpr (requires { value.time_since_epoch(); }) {
    return value.time_since_epoch().count();
  } else if constexpr (requires { value.count(); }) {
    return value.count();
  } else {
    return to_whole(value.value);  // BuildingId, FloorOrdinal
  }
}

template <typename T>
void from_whole(std::int64_t whole, T& value) {
  if constexpr (std::is_enum_v<T> || std::is_integral_v<T>) {
    value = static_cast<T>(whole);
  } else if constexpr (requires { value.time_since_epoch(); }) {
    value = T(Duration(whole));
  } else if constexpr (requires { value.count(); }) {
    value = T(whole);
  } else {
    from_whole(whole, value.value);
  }
}

inline constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

/// Rounded to a multiple of 1 / grain, so that the shortest decimal is short.
inline double rounded(double value, double grain) {
  const double scaled = value * grain;
  return std::fabs(scaled) < 9e15 ? std::nearbyint(scaled) / grain : value;
}
inline double to_wire(double value, const Real& kind) {
  return rounded(value * kind.scale, kind.grain);
}
inline double from_wire(double wire, const Real& kind) {
  return wire / kind.scale;
}

inline double azimuth_deg(double azimuth_rad) {
  const double degrees = rounded(azimuth_rad * kDegreesPerRadian, 1e6);
  return degrees >= 360.0 ? degrees - 360.0 : degrees;
}
inline double to_wire(const Heading& heading, Compass) {
  return azimuth_deg(heading.azimuth_rad());
}
inline double to_wire(double azimuth_rad, Compass) {
  return azimuth_deg(azimuth_rad);
}
inline void from_wire(double degrees, Heading& heading) {
  heading = Heading::from_azimuth(degrees / kDegreesPerRadian);
}
inline void from_wire(double degrees, double& azimuth_rad) {
  azimuth_rad = degrees / kDegreesPerRadian;
}

// ---------------------------------------------------------------- gates: the same for what was decoded and what is to be sent

struct Refusal {
  FaultCode code;
  std::string cause;
};
Refusal outside(double wire, double least, double most);
Refusal outside(std::int64_t wire, const Integer& kind);
Refusal wrong_count(std::size_t count, std::size_t least, std::size_t most);

inline constexpr Real kCompassRange{0.0, 360.0, "deg"};

inline std::optional<Refusal> refuse(double wire, const Real& kind) {
  if (wire >= kind.least && wire <= kind.most) return std::nullopt;  // false for NaN
  return outside(wire, kind.least, kind.most);
}
inline std::optional<Refusal> refuse(std::int64_t wire, const Integer& kind) {
  if (wire >= kind.least && wire <= kind.most) return std::nullopt;
  return outside(wire, kind);
}
inline std::optional<Refusal> refuse_count(std::size_t count, std::size_t least, std::size_t most) {
  if (count >= least && count <= most) return std::nullopt;
  return wrong_count(count, least, most);
}
/// Precondition of the two: `text` is UTF-8 where it came through a parser; texts of our own callers are tested here too.
std::optional<Refusal> refuse(std::string_view text, const Text& kind);
std::optional<Refusal> refuse_bytes(std::string_view bytes, const Bytes& kind);

}  // namespace wayfuse::wire
