#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "server/buildings/building_shelf.hpp"
#include "server/sessions/timeline.hpp"

namespace wayfuse {

/// What a session tracked with, so that it can be made again, to the bit, once the snapshot is retired.
struct TrackedWith {
  std::weak_ptr<const Building> snapshot;
  std::shared_ptr<const BuildingRecord> description;
  std::uint64_t map_version = 0;
  std::string pipeline;
  /// Snapshots made from either are alike.
  bool same_map(const TrackedWith& other) const {
    return map_version == other.map_version && (description == other.description || same_description(*description, *other.description));
  }
  static bool same_description(const BuildingRecord& a, const BuildingRecord& b) {
    return a.georeference == b.georeference && a.magnetic_field == b.magnetic_field && a.floors == b.floors;
  }
};

/// What happened to a session's timeline, in order. Doing the same again ends in the same bits.
struct TapeBegun {
  TrackedWith with;
  Random random;                     ///< its tracker was made with
};
struct TapeExchanged {
  TrackedWith with;
  Random random;
  std::uint64_t after;
};
struct TapeAnswered {                ///< the timeline caught up
  PhoneTime at;                      ///< the position was asked for this moment
  std::uint64_t applied_through = 0;
  std::optional<std::uint64_t> said; ///< digest of the position that the phone was told
};
using TapeEntry = std::variant<Sample, TapeBegun, TapeExchanged, TapeAnswered>;

/// A stretch of a tape that can be played without what came before.
struct TapePiece {
  std::shared_ptr<const Timeline> from;  ///< as it stood
  TrackedWith with;
  bool first = false;                    ///< `from` had seen nothing yet
  std::vector<TapeEntry> entries;
  std::size_t bytes = 0;                 ///< about, `from` included
  std::size_t from_bytes = 0;
  std::uint64_t samples = 0, answers = 0;
  UnixTime begun_at, ended_at;
};

/// One session's recording: pieces, the newest of which grows.
///
/// Thread: any; one mutex. The session writes, the shelf drops the oldest pieces, a replay reads copies.
class SessionTape {
 public:
  static constexpr std::size_t kPieceBytes = 256u << 10;   ///< of entries; then the next piece begins
  static constexpr Duration kPieceTime = std::chrono::minutes(5);

  /// Whether a piece must be begun before anything is written.
  bool wants_piece(UnixTime now) const;
  /// Answers the bytes it takes.
  std::size_t begin_piece(std::unique_ptr<Timeline> from, TrackedWith with, UnixTime now);
  /// What is written between two answers is of the session's one batch. Answers the bytes it took.
  std::size_t write(TapeEntry entry, UnixTime now);

  std::vector<std::shared_ptr<const TapePiece>> pieces() const;
  std::size_t bytes() const;
  std::optional<UnixTime> oldest_end() const;  ///< of the oldest piece; absent: there is none
  /// The bytes it held.
  std::size_t drop_oldest();
  std::uint64_t dropped() const;

 private:
  mutable std::mutex mutex_;
  std::deque<std::shared_ptr<TapePiece>> pieces_;
  std::size_t bytes_ = 0;
  std::uint64_t dropped_ = 0;
};

/// Of every bit of a position.
std::uint64_t digest(const FusedPosition& position);

}  // namespace wayfuse
