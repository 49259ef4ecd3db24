#include "server/recordings/replay.hpp"

#include <algorithm>

#include "server/sessions/explanation.hpp"

namespace wayfuse {
namespace {

struct Scene {
  std::shared_ptr<const Building> building;
  std::shared_ptr<const TrackerFactory> factory;
};

class Replay {
 public:
  Replay(std::uint64_t seed, const ReplayStage& stage, const ReplayQuestion& question, bool as_it_was)
      : seed_(seed), stage_(stage), question_(question) {
    answer_.as_it_was = as_it_was;
  }

  Result<void> begin(const TapePiece& piece) {
    if (const auto set = enter(piece.with); !set) return set;
    if (answer_.as_it_was) {
      timeline_ = piece.from->clone();
    } else if (piece.first) {
      timeline_ = std::make_unique<Timeline>(scene_.factory->make_tracker(Random(seed_).split()));
    } else {
      timeline_ = std::make_unique<Timeline>(
          go_on(*scene_.factory, piece.from->tracker(), piece.from->newest().value_or(PhoneTime{}), Random(seed_).split()));
    }
    return {};
  }
  Result<void> play(const TapeEntry& entry) {
    return std::visit([this](const auto& each) { return play(each); }, entry);
  }
  ReplayAnswer finish() {
    answer_.pipeline = scene_.factory->spec().name;
    for (std::string& remark : scene_.factory->remarks()) answer_.remarks.push_back(std::move(remark));
    return std::move(answer_);
  }

 private:
  Result<void> enter(const TrackedWith& with) {
    const auto found = std::ranges::find_if(stage_.buildings, [&](const auto& each) { return each.first.same_map(with); });
    scene_.building = stage_.instead ? stage_.instead : found != stage_.buildings.end() ? found->second : nullptr;
    if (!scene_.building) return Fault{FaultCode::kInternal, "", "a map of the recording is not at hand"};
    const auto factory = scene_.building->pipeline(question_.pipeline.empty() ? with.pipeline : question_.pipeline);
    if (!factory) return factory.fault();
    scene_.factory = *factory;
    return {};
  }

  Result<void> play(const Sample& sample) {
    const auto* scan = std::get_if<RssScan>(&sample.body);
    if (timeline_->take(sample) && scan && scan->time >= newest_scan_.time) newest_scan_ = *scan;
    return {};
  }
  Result<void> play(const TapeBegun& begun) {
    if (const auto set = enter(begun.with); !set) return set;
    timeline_ = std::make_unique<Timeline>(scene_.factory->make_tracker(begun.random));
    newest_scan_ = {};
    return {};
  }
  Result<void> play(const TapeExchanged& exchanged) {
    if (const auto set = enter(exchanged.with); !set) return set;
    // On one map for all, and in one pipeline, there is nothing to exchange.
    if (!(stage_.instead && !question_.pipeline.empty())) timeline_->exchange(scene_.factory, exchanged.random, exchanged.after);
    return {};
  }
  Result<void> play(const TapeAnswered& answered) {
    timeline_->catch_up();
    ++answer_.steps;
    auto position = timeline_->tracker().position(answered.at);
    ReplayStep step;
    step.said = answered.said.has_value();
    if (answer_.as_it_was && answered.said) {
      step.as_live = position && digest(*position) == *answered.said;
      answer_.differing += !*step.as_live;
    }
    if (answer_.steps <= question_.after || answer_.page.size() >= question_.most) return {};
    step.number = answer_.steps;
    step.at = answered.at;
    step.applied_through = answered.applied_through;
    step.map_version = position ? position->radio_map_version : scene_.building->map_version();
    if (position) {
      step.explanation = explain(*scene_.building, grounds_of(timeline_->tracker(), *std::move(position), newest_scan_, question_.particles));
      step.explanation->pipeline = scene_.factory->spec().name;
    } else {
      step.no_position = timeline_->tracker().why_no_fix();
    }
    answer_.page.push_back(std::move(step));
    return {};
  }

  const std::uint64_t seed_;
  const ReplayStage& stage_;
  const ReplayQuestion& question_;
  ReplayAnswer answer_;
  Scene scene_;
  std::unique_ptr<Timeline> timeline_;
  RssScan newest_scan_;
};

}  // namespace

std::vector<TrackedWith> tracked_with(const TapePieces& pieces) {
  std::vector<TrackedWith> all;
  const auto note = [&](const TrackedWith& with) {
    if (std::ranges::none_of(all, [&](const TrackedWith& each) { return each.same_map(with) && each.pipeline == with.pipeline; })) all.push_back(with);
  };
  for (const auto& piece : pieces) {
    if (piece == pieces.front()) note(piece->with);
    for (const TapeEntry& entry : piece->entries) {
      if (const auto* begun = std::get_if<TapeBegun>(&entry)) note(begun->with);
      if (const auto* exchanged = std::get_if<TapeExchanged>(&entry)) note(exchanged->with);
    }
  }
  return all;
}

Result<ReplayAnswer> replay(const TapePieces& pieces, std::uint64_t seed, const ReplayStage& stage, const ReplayQuestion& question) {
  if (pieces.empty()) return Fault{FaultCode::kNotFound, "recording", "nothing of it is left"};
  const auto with = tracked_with(pieces);
  const bool as_it_was = std::ranges::all_of(with, [&](const TrackedWith& each) {
    return (question.pipeline.empty() || question.pipeline == each.pipeline) && (!question.map_version || *question.map_version == each.map_version);
  });
  Replay again(seed, stage, question, as_it_was && !stage.instead);
  if (const auto begun = again.begin(*pieces.front()); !begun) return begun.fault();
  for (const auto& piece : pieces) {
    for (const TapeEntry& entry : piece->entries) {
      if (const auto played = again.play(entry); !played) return played.fault();
    }
  }
  return again.finish();
}

}  // namespace wayfuse
