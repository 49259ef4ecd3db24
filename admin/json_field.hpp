#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "wayfuse/proto/fault.hpp"
#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/result.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// A value of a JSON document that somebody sent, read together with its path: what does not serve is a fault that names it,
/// like `floors[1].outline[0][3]: a point is [x_m, y_m]`.
///
/// Reading stops at the first fault, which travels as `Broken` up to reading(). Numbers are finite and within their range,
/// texts are UTF-8 without control characters. Thread: confined. Copies share the document.
class JsonField {
 public:
  struct Broken {
    Fault fault;
  };

  /// The whole document, which must be an object. Throws Broken.
  static JsonField object_in(std::string_view json);
  /// Calls `read` and hands on its value or the fault it stopped at.
  template <typename Read>
  static auto reading(Read&& read) -> Result<decltype(read())> {
    try {
      return read();
    } catch (const Broken& stop) {
      return stop.fault;
    }
  }
  [[noreturn]] void refuse(FaultCode code, std::string cause) const { throw Broken{{code, path_, std::move(cause)}}; }

  const std::string& path() const { return path_; }
  bool is_null() const;
  bool is_text() const;
  /// Of an object; kMissingField if it is not there.
  JsonField member(const char* name) const;
  bool has(const char* name) const;
  /// Absent or null = nothing.
  std::optional<JsonField> maybe(const char* name) const;
  void must_be_object() const;

  double number(double least, double most) const;
  std::int64_t whole(std::int64_t least, std::int64_t most) const;
  std::string text(std::size_t most_bytes) const;
  bool flag() const;
  std::vector<JsonField> list(std::size_t most) const;

  double number(const char* name, double standard, double least, double most) const;
  std::string text(const char* name, std::string standard, std::size_t most_bytes) const;
  bool flag(const char* name, bool standard) const;

  FloorOrdinal floor() const { return {static_cast<std::int32_t>(whole(-100, 300))}; }
  GeoPoint geo_point() const;      ///< `{"latitude_deg": .., "longitude_deg": ..}`
  Ring ring() const;               ///< `[[x_m, y_m], ..]`; a repeated last point is left out
  Polyline line() const;
  Polygon polygon() const;         ///< rings, the outer first
  std::vector<Polygon> polygons() const;

 private:
  JsonField(std::shared_ptr<const void> document, const void* value, std::string path)
      : document_(std::move(document)), value_(value), path_(std::move(path)) {}
  JsonField below(const void* value, std::string path) const { return {document_, value, std::move(path)}; }
  std::vector<BuildingPoint> points() const;

  std::shared_ptr<const void> document_;
  const void* value_;
  std::string path_;
};

}  // namespace wayfuse
