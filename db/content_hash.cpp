#include "db/content_hash.hpp"

#include <sodium.h>

#include "db/body_hash.hpp"
#include "db/packing.hpp"

namespace wayfuse {

std::string sha256(std::string_view content) {
  std::string hash(crypto_hash_sha256_BYTES, '\0');
  crypto_hash_sha256(reinterpret_cast<unsigned char*>(hash.data()), reinterpret_cast<const unsigned char*>(content.data()), content.size());
  return hash;
}

std::string hex(std::string_view bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

std::string hash_of_points(std::span<const ReferencePoint> points) {
  BodyHash hash;
  for (const ReferencePoint& point : points) {
    hash.add(point);
    for (const RssScan& scan : point.scans) hash.add(scan.time, pack_readings(scan.readings, "readings").value());
  }
  return hash.finish();
}

}  // namespace wayfuse
