#pragma once

#include <compare>
#include <deque>
#include <memory>
#include <optional>
#include <variant>

#include "server/pipeline/tracker.hpp"
#include "server/sessions/kept_scan.hpp"
#include "wayfuse/proto/message.hpp"

namespace wayfuse {

/// Feeds one tracker in the order of evidence, whatever the order of arrival.
///
/// Evidence is applied at once, so nothing waits for stragglers. A straggler within `window` of the newest evidence makes
/// the tracker go back to a copy taken before it and apply the rest again: the final state is the same for every order of
/// arrival inside the window, bit for bit [SAFETY C15, R16]. Older evidence is refused.
/// Thread: confined to its session. Memory: at most three copies of the tracker and the evidence of about four seconds; a
/// flood beyond kReadingsMost in that time shortens the window instead.
class Timeline {
 public:
  static constexpr Duration kWindow = std::chrono::seconds(2);
  static constexpr Duration kCopyEvery = std::chrono::seconds(2);
  static constexpr std::size_t kReadingsMost = 16384;  ///< kept for a rewind; a motion report counts as one

  explicit Timeline(std::unique_ptr<Tracker> tracker, Duration window = kWindow);

  /// False = later than the window, not taken.
  bool take(const Sample& sample);
  /// Applies what was taken; the tracker then stands at newest().
  void catch_up();
  /// From the newest evidence on `newer` tracks in the tracker's place (go_on). It happens at that moment of evidence whatever arrives
  /// when: an older straggler is still applied by the tracker of its time. `after`: the newest number taken. Only after the first take().
  void exchange(std::shared_ptr<const TrackerFactory> newer, Random random, std::uint64_t after);

  /// As it stands, with all it could go back to.
  std::unique_ptr<Timeline> clone() const;
  /// Memory it holds, about.
  std::size_t bytes() const;

  const Tracker& tracker() const { return *tracker_; }
  /// Time of the newest evidence taken; absent before the first.
  std::optional<PhoneTime> newest() const { return newest_; }
  std::uint64_t rewinds() const { return rewinds_; }

 private:
  struct Exchange {
    std::shared_ptr<const TrackerFactory> newer;
    Random random;
  };
  /// Order of application: by time, then motion before scans before GNSS before an exchange, then by number.
  struct Key {
    PhoneTime time = PhoneTime::min();
    std::size_t kind = 0;
    std::uint64_t sequence = 0;
    auto operator<=>(const Key&) const = default;
  };
  using Kept = std::variant<MotionReport, KeptScan, GnssFix, Exchange>;
  struct Evidence {
    Key key;
    Kept body;
  };
  struct Copy {
    Key applied;
    std::unique_ptr<Tracker> tracker;
  };

  void insert(const Key& key, Kept body);
  void apply(const Evidence& evidence);
  void rewind_before(const Key& key);
  static std::size_t readings_in(const Evidence& evidence);
  void forget();

  Duration window_;
  std::unique_ptr<Tracker> tracker_;
  Key applied_;  ///< everything up to here is in tracker_
  std::optional<PhoneTime> newest_;
  std::deque<Evidence> evidence_;  ///< ascending; what a rewind may need again, then what is not applied yet
  std::deque<Copy> copies_;        ///< ascending; the first is old enough for every straggler the window lets in
  std::size_t readings_ = 0;       ///< in evidence_, a report counts as one
  std::uint64_t rewinds_ = 0;
};

/// When the evidence was taken.
PhoneTime time_of(const SampleBody& body);

}  // namespace wayfuse
