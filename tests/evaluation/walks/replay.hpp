#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "server/pipeline/tracker.hpp"
#include "tests/evaluation/walks/walk_score.hpp"

namespace wayfuse {

/// What came back on one walk.
struct WalkReply {
  Answers at;                         ///< one entry an instant: the newest position that was there by then
  std::optional<double> first_fix_s;  ///< after the first thing the phone sensed
  std::size_t refused = 0;            ///< samples the protocol does not take; as an application's, they are left out
  std::optional<Fault> refusal;       ///< the first one's

  /// Counts it, if it is about a sample's values; false: the fault is another one.
  bool leaves_out(const Fault& fault);
};

/// The way a walk's data take from the phone's sensors to positions. Thread: any; run() may be called at once from several.
class WalkReplay {
 public:
  virtual ~WalkReplay() = default;
  virtual std::string_view path() const = 0;
  virtual Result<WalkReply> run(const RecordedWalk& walk, std::span<const Instant> instants, const std::string& pipeline,
                                std::uint64_t seed) const = 0;
};

/// Straight from the motion tracker into the pipeline: no client, codec, session or store. For baselines that need the true
/// start (`dead-reckoning`), and for quick looks.
class DirectReplay final : public WalkReplay {
 public:
  explicit DirectReplay(std::shared_ptr<const Site> site) : site_(std::move(site)) {}
  /// Prepares a pipeline before the threads begin, by assemble_named().
  Result<void> prepare(const std::string& pipeline);
  std::string_view path() const override { return "direct"; }
  Result<WalkReply> run(const RecordedWalk& walk, std::span<const Instant> instants, const std::string& pipeline,
                        std::uint64_t seed) const override;

 private:
  std::shared_ptr<const Site> site_;
  std::map<std::string, std::shared_ptr<const TrackerFactory>> factories_;
};

/// What happens on a phone during a walk, in time order: samples before scans before the question, at equal times.
struct PhoneEvents {
  std::function<void(const MargSample&)> sample;
  std::function<void(const RssScan&)> scan;
  std::function<void(std::size_t instant)> ask;
};
void play(const RecordedWalk& walk, std::span<const Instant> instants, const PhoneEvents& events);
/// When the first of these happens.
PhoneTime begin_of(const RecordedWalk& walk);

}  // namespace wayfuse
