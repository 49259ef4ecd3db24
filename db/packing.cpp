#include "db/packing.hpp"

#include <bit>
#include <cmath>

namespace wayfuse {
namespace {

constexpr std::uint8_t kExactRss = 1;   // rss_dbm as f64 instead of i8
constexpr std::uint8_t kRange = 2;
constexpr std::uint8_t kRangeSigma = 4;
constexpr std::uint8_t kKnownFlags = kExactRss | kRange | kRangeSigma;
constexpr Duration kOldest = std::chrono::seconds(600);
constexpr std::uint64_t kBssidMost = (std::uint64_t{1} << 48) - 1;

class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : bytes_(bytes) {}
  std::uint64_t take(std::size_t bytes) {
    if (bytes_.size() < bytes) {
      broken_ = true;
      bytes_ = {};
      return 0;
    }
    std::uint64_t value = 0;
    for (std::size_t i = bytes; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes_[i]);
    bytes_.remove_prefix(bytes);
    return value;
  }
  double f64() { return std::bit_cast<double>(take(8)); }
  bool at_end() const { return bytes_.empty(); }
  bool broken() const { return broken_; }
  // How many items of at least `bytes` each can still follow: checked before reserving.
  bool holds(std::uint64_t items, std::size_t bytes) const { return items <= bytes_.size() / bytes; }

 private:
  std::string_view bytes_;
  bool broken_ = false;
};

bool within(double value, double least, double most) { return value >= least && value <= most; }  // false for NaN

Fault out_of_range(std::string_view path, std::size_t reading, const char* field, std::string cause) {
  return {FaultCode::kOutOfRange, std::string(path) + ".readings[" + std::to_string(reading) + "]." + field, std::move(cause)};
}

Result<void> check_reading(const ScanReading& reading, std::string_view path, std::size_t index) {
  if (reading.bssid.value > kBssidMost) return out_of_range(path, index, "bssid", "longer than 48 bits");
  if (!within(reading.rss_dbm, -120, 0)) return out_of_range(path, index, "rss_dbm", std::to_string(reading.rss_dbm) + " is outside -120..0");
  if (reading.age < Duration{0} || reading.age > kOldest) return out_of_range(path, index, "age", std::to_string(seconds(reading.age)) + " s is outside 0..600");
  if (reading.range_m && !within(*reading.range_m, -1e4, 1e6)) return out_of_range(path, index, "range_m", std::to_string(*reading.range_m) + " is outside -10000..1000000");
  if (reading.range_sigma_m && !within(*reading.range_sigma_m, 0, 1e6)) return out_of_range(path, index, "range_sigma_m", std::to_string(*reading.range_sigma_m) + " is outside 0..1000000");
  return {};
}

void pack_reading(const ScanReading& reading, Packer& into) {
  const auto whole = static_cast<std::int8_t>(reading.rss_dbm);
  const bool exact = std::bit_cast<std::uint64_t>(static_cast<double>(whole)) != std::bit_cast<std::uint64_t>(reading.rss_dbm);
  into.u8(static_cast<std::uint8_t>((exact ? kExactRss : 0) | (reading.range_m ? kRange : 0) | (reading.range_sigma_m ? kRangeSigma : 0)));
  into.u8(static_cast<std::uint8_t>(whole));
  into.u16(reading.frequency_mhz);
  into.u32(static_cast<std::uint32_t>(reading.age.count()));
  into.u48(reading.bssid.value);
  if (exact) into.f64(reading.rss_dbm);
  if (reading.range_m) into.f64(*reading.range_m);
  if (reading.range_sigma_m) into.f64(*reading.range_sigma_m);
}

Fault corrupt(const char* what) { return {FaultCode::kStoreCorrupt, what, "a stored blob does not follow its layout"}; }

}  // namespace

void Packer::f64(double value) { u64(std::bit_cast<std::uint64_t>(value)); }

void Packer::text(std::string_view value) {
  u32(static_cast<std::uint32_t>(value.size()));
  bytes_ += value;
}

void Packer::little_endian(std::uint64_t value, int bytes) {
  char spelled[8];
  for (int i = 0; i < bytes; ++i) spelled[i] = static_cast<char>(value >> (8 * i));
  bytes_.append(spelled, static_cast<std::size_t>(bytes));
}

Result<std::string> pack_readings(const std::vector<ScanReading>& readings, std::string_view path) {
  Packer packer;
  packer.reserve(readings.size() * 14);
  for (std::size_t i = 0; i < readings.size(); ++i) {
    if (Result<void> good = check_reading(readings[i], path, i); !good) return good.fault();
    pack_reading(readings[i], packer);
  }
  return packer.take();
}

Result<std::vector<ScanReading>> unpack_readings(std::string_view blob) {
  Unpacker from(blob);
  std::vector<ScanReading> readings;
  readings.reserve(blob.size() / 14);
  while (!from.at_end()) {
    ScanReading reading;
    const auto flags = static_cast<std::uint8_t>(from.take(1));
    reading.rss_dbm = static_cast<std::int8_t>(from.take(1));
    reading.frequency_mhz = static_cast<std::uint16_t>(from.take(2));
    reading.age = Duration(static_cast<std::int64_t>(from.take(4)));
    reading.bssid.value = from.take(6);
    if (flags & kExactRss) reading.rss_dbm = from.f64();
    if (flags & kRange) reading.range_m = from.f64();
    if (flags & kRangeSigma) reading.range_sigma_m = from.f64();
    if (from.broken() || (flags & ~kKnownFlags) != 0) return corrupt("scan.readings");
    readings.push_back(reading);
  }
  return readings;
}

std::string pack_polygons(const std::vector<Polygon>& polygons) {
  Packer packer;
  packer.u32(static_cast<std::uint32_t>(polygons.size()));
  for (const Polygon& polygon : polygons) {
    packer.u32(static_cast<std::uint32_t>(polygon.rings.size()));
    for (const Ring& ring : polygon.rings) {
      packer.u32(static_cast<std::uint32_t>(ring.size()));
      for (const BuildingPoint& point : ring) {
        packer.f64(point.x_m);
        packer.f64(point.y_m);
      }
    }
  }
  return packer.take();
}

Result<std::vector<Polygon>> unpack_polygons(std::string_view blob) {
  Unpacker from(blob);
  const std::uint64_t count = from.take(4);
  if (!from.holds(count, 4)) return corrupt("floor");
  std::vector<Polygon> polygons(count);
  for (Polygon& polygon : polygons) {
    const std::uint64_t rings = from.take(4);
    if (!from.holds(rings, 4)) return corrupt("floor");
    polygon.rings.resize(rings);
    for (Ring& ring : polygon.rings) {
      const std::uint64_t points = from.take(4);
      if (!from.holds(points, 16)) return corrupt("floor");
      ring.resize(points);
      for (BuildingPoint& point : ring) {
        point.x_m = from.f64();
        point.y_m = from.f64();
      }
    }
  }
  if (from.broken() || !from.at_end()) return corrupt("floor");
  return polygons;
}

}  // namespace wayfuse
