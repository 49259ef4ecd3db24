#include "tests/evaluation/walks/replay.hpp"

#include <algorithm>

#include "server/quality/walk_quality.hpp"
#include "tests/evaluation/named_parts.hpp"
#include "wayfuse/sdk/motion_tracker.hpp"

namespace wayfuse {

void play(const RecordedWalk& walk, std::span<const Instant> instants, const PhoneEvents& events) {
  std::size_t sample = 0;
  std::size_t scan = 0;
  const auto play_through = [&](PhoneTime time) {
    for (;;) {
      const bool sample_due = sample < walk.motion.size() && walk.motion[sample].time <= time;
      const bool scan_due = scan < walk.scans.size() && walk.scans[scan].time <= time;
      if (sample_due && (!scan_due || walk.motion[sample].time <= walk.scans[scan].time))
        events.sample(walk.motion[sample++]);
      else if (scan_due)
        events.scan(walk.scans[scan++]);
      else
        return;
    }
  };
  for (std::size_t i = 0; i < instants.size(); ++i) {
    play_through(instants[i].time);
    events.ask(i);
  }
}

PhoneTime begin_of(const RecordedWalk& walk) {
  PhoneTime begin = walk.way_points.front().time;
  if (!walk.motion.empty()) begin = std::min(begin, walk.motion.front().time);
  if (!walk.scans.empty()) begin = std::min(begin, walk.scans.front().time);
  return begin;
}

bool WalkReply::leaves_out(const Fault& fault) {
  if (fault.code != FaultCode::kOutOfRange) return false;
  if (refused++ == 0) refusal = fault;
  return true;
}

Result<void> DirectReplay::prepare(const std::string& pipeline) {
  const auto factory = assemble_named(pipeline, site_);
  if (!factory) return factory.fault();
  factories_[pipeline] = *factory;
  return {};
}

Result<WalkReply> DirectReplay::run(const RecordedWalk& walk, std::span<const Instant> instants, const std::string& pipeline,
                                    std::uint64_t seed) const {
  auto motion = MotionTracker::create({});
  if (!motion) return motion.fault();
  motion->expect(site_->magnetic_field);
  std::optional<KnownStart> start;
  if (pipeline == "dead-reckoning") start = KnownStart{{walk.way_points.front().point, walk.floor}, 0.5, std::nullopt};
  RecordedTrack track;
  std::vector<PhoneTime> times;
  PhoneEvents events;
  events.sample = [&](const MargSample& sample) {
    if (const auto report = motion->feed(sample)) {
      track.evidence.push_back(*report);
      times.push_back(sample.time);
    }
  };
  events.scan = [&](const RssScan& scan) {
    track.evidence.push_back(scan);
    times.push_back(scan.time);
  };
  events.ask = [&](std::size_t i) { times.push_back(instants[i].time); };
  play(walk, instants, events);
  const auto answers = replay(*factories_.at(pipeline), track, times, Random(seed), start);

  WalkReply reply;
  const auto first = std::ranges::find_if(answers, [](const TrackAnswer& answer) { return answer.position.has_value(); });
  if (first != answers.end()) reply.first_fix_s = seconds(first->time - begin_of(walk));
  for (const Instant& instant : instants) {
    // The last answer at that time: everything up to then is in it.
    const auto after = std::ranges::upper_bound(answers, instant.time, {}, &TrackAnswer::time);
    reply.at.push_back((after - 1)->position);
  }
  return reply;
}

}  // namespace wayfuse
