#include "server/sessions/session_tape.hpp"

#include <bit>

namespace wayfuse {
namespace {

std::size_t bytes_of(const TapeEntry& entry) {
  std::size_t bytes = sizeof(TapeEntry);
  if (const auto* sample = std::get_if<Sample>(&entry)) {
    if (const auto* scan = std::get_if<RssScan>(&sample->body)) bytes += scan->readings.capacity() * sizeof(ScanReading);
  }
  return bytes;
}

/// FNV-1a over 64-bit words.
class Digest {
 public:
  void take(std::uint64_t word) { sum_ = (sum_ ^ word) * 0x100000001b3ULL; sum_ ^= sum_ >> 29; }
  void take(double value) { take(std::bit_cast<std::uint64_t>(value)); }
  void take(Duration duration) { take(static_cast<std::uint64_t>(duration.count())); }
  std::uint64_t sum() const { return sum_; }

 private:
  std::uint64_t sum_ = 0xcbf29ce484222325ULL;
};

}  // namespace

bool SessionTape::wants_piece(UnixTime now) const {
  const std::lock_guard lock(mutex_);
  if (pieces_.empty()) return true;
  const TapePiece& newest = *pieces_.back();
  return newest.bytes >= newest.from_bytes + kPieceBytes || now - newest.begun_at >= kPieceTime;
}

std::size_t SessionTape::begin_piece(std::unique_ptr<Timeline> from, TrackedWith with, UnixTime now) {
  auto piece = std::make_shared<TapePiece>();
  piece->first = !from->newest();
  piece->bytes = piece->from_bytes = from->bytes();
  piece->from = std::move(from);
  piece->with = std::move(with);
  piece->begun_at = piece->ended_at = now;
  const std::lock_guard lock(mutex_);
  bytes_ += piece->bytes;
  pieces_.push_back(std::move(piece));
  return pieces_.back()->bytes;
}

std::size_t SessionTape::write(TapeEntry entry, UnixTime now) {
  const std::size_t bytes = bytes_of(entry);
  const std::lock_guard lock(mutex_);
  if (pieces_.empty()) return 0;  // dropped between two entries: the next batch begins anew
  // A reader may hold the piece: it goes on in a copy of its own.
  if (pieces_.back().use_count() > 1) pieces_.back() = std::make_shared<TapePiece>(*pieces_.back());
  TapePiece& piece = *pieces_.back();
  piece.samples += std::holds_alternative<Sample>(entry);
  piece.answers += std::holds_alternative<TapeAnswered>(entry);
  piece.entries.push_back(std::move(entry));
  piece.bytes += bytes;
  piece.ended_at = now;
  bytes_ += bytes;
  return bytes;
}

std::vector<std::shared_ptr<const TapePiece>> SessionTape::pieces() const {
  const std::lock_guard lock(mutex_);
  return {pieces_.begin(), pieces_.end()};
}

std::size_t SessionTape::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

std::optional<UnixTime> SessionTape::oldest_end() const {
  const std::lock_guard lock(mutex_);
  return pieces_.empty() ? std::nullopt : std::optional(pieces_.front()->ended_at);
}

std::size_t SessionTape::drop_oldest() {
  const std::lock_guard lock(mutex_);
  if (pieces_.empty()) return 0;
  const std::size_t bytes = pieces_.front()->bytes;
  pieces_.pop_front();
  bytes_ -= bytes;
  ++dropped_;
  return bytes;
}

std::uint64_t SessionTape::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

std::uint64_t digest(const FusedPosition& p) {
  Digest digest;
  digest.take(p.valid_at.time_since_epoch());
  digest.take(p.building.value);
  for (const double value : {p.place.point.x_m, p.place.point.y_m, p.covariance.xx_m2, p.covariance.xy_m2, p.covariance.yy_m2, p.radius68_m,
                             p.radius95_m, p.heading.radians(), p.heading_sigma_rad, p.speed_mps}) {
    digest.take(value);
  }
  digest.take(static_cast<std::uint64_t>(p.place.floor.value));
  if (p.geo) digest.take(p.geo->latitude_deg), digest.take(p.geo->longitude_deg);
  for (const FloorProbability& floor : p.floors) digest.take(static_cast<std::uint64_t>(floor.floor.value)), digest.take(floor.probability);
  digest.take(p.radio_map_version);
  digest.take(static_cast<std::uint64_t>(p.integrity));
  digest.take(p.from.scan_age);
  for (const int count : {p.from.transmitters_used, p.from.transmitters_unknown, p.from.steps_since_scan, p.from.gnss ? 1 : 0}) {
    digest.take(static_cast<std::uint64_t>(count));
  }
  return digest.sum();
}

}  // namespace wayfuse
