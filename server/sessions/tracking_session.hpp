#pragma once

#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <variant>

#include "server/buildings/building_shelf.hpp"
#include "server/sessions/explanation.hpp"
#include "server/sessions/kept_scan.hpp"
#include "server/sessions/recording_shelf.hpp"
#include "server/sessions/timeline.hpp"
#include "wayfuse/proto/message.hpp"

namespace wayfuse {

/// What a tracking session is begun with.
struct SessionRequest {
  std::uint64_t key_id = 0;
  BuildingId only;                           ///< the only building the key covers; 0 = any
  std::shared_ptr<const Building> building;  ///< null = resolve from the first scans
  std::string pipeline;                      ///< empty = the building's own
  std::string device_model;
  std::string app;
  std::uint64_t begins_after = 0;  ///< the first sample's number less one
  RecordingShelf* recordings = nullptr;  ///< where what it is fed is written down, while an operator wants that; null = nowhere
  /// SessionWorld::prepare; null or empty = pipelines are made where they are asked for. Outlives the session.
  const std::function<void(std::shared_ptr<const Building>, const std::string&)>* prepare = nullptr;
  UnixTime since;
};

/// How long ago evidence was taken, without trusting anybody's wall clock: the smallest difference between the server's
/// monotonic clock at arrival and the phone's stamp is taken for the offset between the two clocks.
class ClockOffset {
 public:
  void note(PhoneTime sent, ServerTime arrived) {
    const Duration offset = arrived.time_since_epoch() - sent.time_since_epoch();
    if (!least_ || offset < *least_) least_ = offset;
  }
  /// 0 before the first note.
  Duration age(PhoneTime taken, ServerTime now) const {
    return least_ ? now.time_since_epoch() - taken.time_since_epoch() - *least_ : Duration{0};
  }

 private:
  std::optional<Duration> least_;
};

/// One phone's walk: sample numbers, the building's snapshot, the tracker. It outlives its connections.
///
/// It follows its building: when a batch arrives and the shelf has another snapshot (a newer map, a rollback, new walls, another
/// pipeline where the phone asked for none), the walk goes on in that one from the newest evidence on (Timeline::exchange). The older
/// one is let go as soon as no straggler can ask for it.
/// The connection that attached last owns it; an older one finds out by its generation. Thread: any; one mutex, never
/// contended but for a takeover.
class TrackingSession {
 public:
  /// What one batch did.
  struct Outcome {
    bool owner = true;  ///< false: another connection took the session over; nothing was done
    std::uint64_t applied_through = 0;
    std::uint32_t applied = 0;
    std::uint32_t duplicates = 0;
    std::uint32_t late = 0;
    std::uint64_t first_late = 0;
    std::uint64_t rewinds = 0;
    std::optional<std::uint64_t> gap_at;  ///< this number came although applied_through + 1 was due
    PhoneTime at;                         ///< of the newest evidence
    /// Absent: no evidence in this session yet, or the phone rests and its position was said a moment ago.
    std::variant<std::monostate, FusedPosition, Fault> answer;
    bool unsound = false;           ///< the tracker gave a position that is not finite; it was withheld
    bool building_changed = false;  ///< resolved by this batch, or a newer snapshot taken
  };

  TrackingSession(SessionRequest request, std::string name, std::string tracked, std::uint64_t seed,
                  const BuildingShelf& buildings, ServerTime now);

  const std::string& name() const { return name_; }
  const std::string& tracked() const { return tracked_; }
  std::uint64_t key_id() const { return request_.key_id; }
  UnixTime since() const { return request_.since; }
  const std::string& device_model() const { return request_.device_model; }
  const std::string& app() const { return request_.app; }

  /// The caller's connection owns the session from here on; answers its generation.
  std::uint64_t attach();
  bool owned_by(std::uint64_t generation) const;
  /// Ignored unless that generation still owns it.
  void detach(std::uint64_t generation, ServerTime now);
  std::optional<ServerTime> disconnected_since() const;

  Outcome apply(std::uint64_t generation, const SampleBatch& batch, Duration still_interval);

  std::uint64_t applied_through() const;
  std::shared_ptr<const Building> building() const;  ///< null = not resolved
  std::string pipeline() const;                      ///< in force; empty = not resolved
  /// What it is fed is written down, or will be from its next batch on.
  bool is_recorded() const;
  /// Why the newest position is where it is; a fault: why there is none. Changes nothing.
  Result<Explanation> explain() const;

 private:
  static constexpr std::size_t kHeldMost = 256;
  static constexpr std::uint32_t kLateInARowMost = 64;
  static constexpr Duration kHeardWithin = std::chrono::seconds(10);

  bool take(const Sample& sample);
  void hold(const Sample& sample);
  void settle();
  void follow();
  bool resolve();
  using FactoryAnswer = Result<std::shared_ptr<const TrackerFactory>>;
  std::optional<FactoryAnswer> pipeline_in(const std::shared_ptr<const Building>& building) const;
  void track_in(std::shared_ptr<const Building> building);
  void answer(Outcome& outcome, Duration still_interval);
  void find_tape();
  void write(TapeEntry entry);
  TrackedWith tracked_with() const;

  SessionRequest request_;
  const std::string name_;
  const std::string tracked_;
  const BuildingShelf& buildings_;
  std::atomic<std::int64_t> disconnected_since_us_;  ///< kConnected while attached

  const std::uint64_t seed_;

  mutable std::mutex mutex_;
  Random random_;
  std::uint64_t generation_ = 0;
  std::uint64_t applied_through_;
  std::shared_ptr<const Building> building_;
  std::shared_ptr<const TrackerFactory> factory_;
  std::optional<Fault> cannot_track_;  ///< the pipeline asked for does not exist in the resolved building
  std::optional<Timeline> timeline_;
  std::optional<PhoneTime> newest_;
  std::optional<KeptScan> newest_scan_;  ///< that the tracker took
  std::deque<Sample> held_;  ///< until the first position: a newer map may still place it
  bool placed_ = false;
  bool at_rest_ = false;
  std::uint32_t late_in_a_row_ = 0;
  std::optional<FusedPosition> said_;  ///< the last position given to this connection
  std::shared_ptr<RecordedSession> tape_;  ///< null: nothing is recorded
  std::size_t written_ = 0;            ///< bytes of this batch
};

}  // namespace wayfuse
