#include "tests/evaluation/walks/replay.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>

#include "server/quality/walk_quality.hpp"
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

namespace {

// A pipeline that is no preset: for comparing settings.
Result<PipelineSpec> from_file(const std::string& path) {
  std::ifstream file(path);
  if (!file) return Fault{FaultCode::kNotFound, path, "cannot be read"};
  return parse_pipeline(std::string(std::istreambuf_iterator<char>(file), {}));
}

// `default:filter.walkable=0+locator.learn=0`: a preset with these settings instead of its own.
Result<PipelineSpec> changed(const std::string& pipeline) {
  const std::size_t colon = pipeline.find(':');
  auto spec = preset(pipeline.substr(0, colon));
  if (!spec) return spec;
  std::istringstream changes(pipeline.substr(colon + 1));
  for (std::string change; std::getline(changes, change, '+');) {
    const std::size_t dot = change.find('.'), equals = change.find('=');
    const auto part = spec->parts.find(change.substr(0, dot));
    char* end = nullptr;
    const double value = equals == std::string::npos ? 0.0 : std::strtod(change.c_str() + equals + 1, &end);
    if (equals == std::string::npos || dot >= equals || part == spec->parts.end() || end == change.c_str() + equals + 1 || *end != '\0') {
      return Fault{FaultCode::kMalformed, pipeline, "`" + change + "` is not role.setting=number of a role the preset fills"};
    }
    part->second.settings[change.substr(dot + 1, equals - dot - 1)] = value;
  }
  return spec;
}

}  // namespace

Result<PipelineSpec> pipeline_named(const std::string& name) {
  if (name.ends_with(".json")) return from_file(name);
  return name.find(':') == std::string::npos ? preset(name) : changed(name);
}

Result<void> DirectReplay::prepare(const std::string& pipeline) {
  const auto spec = pipeline_named(pipeline);
  if (!spec) return spec.fault();
  const auto factory = assemble(*spec, site_);
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
