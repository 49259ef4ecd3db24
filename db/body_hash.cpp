#include "db/body_hash.hpp"

#include <sodium.h>

#include "db/packing.hpp"

namespace wayfuse {

constexpr std::size_t kHashBytes = 32;

struct BodyHash::State {
  crypto_generichash_state sodium;
};

BodyHash::BodyHash() : state_(std::make_unique<State>()) { crypto_generichash_init(&state_->sodium, nullptr, 0, kHashBytes); }
BodyHash::~BodyHash() = default;

void BodyHash::add(std::string_view bytes) {
  crypto_generichash_update(&state_->sodium, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
}

void BodyHash::add(const ReferencePoint& point) {
  Packer packer;
  packer.f64(point.place.point.x_m);
  packer.f64(point.place.point.y_m);
  packer.u32(static_cast<std::uint32_t>(point.place.floor.value));
  packer.f64(point.sigma_m);
  packer.text(point.device_model);
  packer.text(point.walk);
  packer.u64(static_cast<std::uint64_t>(point.surveyed_at.time_since_epoch().count()));
  packer.u32(static_cast<std::uint32_t>(point.scans.size()));
  add(packer.bytes());
}

void BodyHash::add(PhoneTime scan_time, std::string_view packed_readings) {
  Packer packer;
  packer.u64(static_cast<std::uint64_t>(scan_time.time_since_epoch().count()));
  packer.u32(static_cast<std::uint32_t>(packed_readings.size()));
  add(packer.bytes());
  add(packed_readings);
}

std::string BodyHash::finish() {
  std::string hash(kHashBytes, '\0');
  crypto_generichash_final(&state_->sodium, reinterpret_cast<unsigned char*>(hash.data()), hash.size());
  return hash;
}

}  // namespace wayfuse
