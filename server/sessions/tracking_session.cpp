#include "server/sessions/tracking_session.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "wayfuse/proto/codec.hpp"

namespace wayfuse {
namespace {

constexpr std::int64_t kConnected = std::numeric_limits<std::int64_t>::max();
constexpr double kStillWithin_m = 0.05;

Fault no_building_matches() {
  return {FaultCode::kNoBuildingMatches, "", "the access points heard so far speak for no building clearly"};
}

// The session is there, its position is not: another answer than that of a name nobody has.
Fault no_position(const Fault& reason) { return {FaultCode::kConflict, "position", "there is none: " + reason.cause}; }

}  // namespace

TrackingSession::TrackingSession(SessionRequest request, std::string name, std::string tracked, std::uint64_t seed,
                                 const BuildingShelf& buildings, ServerTime now)
    : request_(std::move(request)),
      name_(std::move(name)),
      tracked_(std::move(tracked)),
      buildings_(buildings),
      disconnected_since_us_(now.time_since_epoch().count()),
      seed_(seed),
      random_(seed),
      applied_through_(request_.begins_after) {
  if (request_.building) track_in(std::exchange(request_.building, nullptr));  // it is let go with the walk's first map
}

std::uint64_t TrackingSession::attach() {
  const std::lock_guard lock(mutex_);
  disconnected_since_us_ = kConnected;
  said_.reset();
  return ++generation_;
}

bool TrackingSession::owned_by(std::uint64_t generation) const {
  const std::lock_guard lock(mutex_);
  return generation == generation_;
}

void TrackingSession::detach(std::uint64_t generation, ServerTime now) {
  const std::lock_guard lock(mutex_);
  if (generation == generation_) disconnected_since_us_ = now.time_since_epoch().count();
}

std::optional<ServerTime> TrackingSession::disconnected_since() const {
  const std::int64_t since_us = disconnected_since_us_;
  return since_us == kConnected ? std::nullopt : std::optional(ServerTime(Duration(since_us)));
}

std::uint64_t TrackingSession::applied_through() const {
  const std::lock_guard lock(mutex_);
  return applied_through_;
}

std::shared_ptr<const Building> TrackingSession::building() const {
  const std::lock_guard lock(mutex_);
  return building_;
}

std::string TrackingSession::pipeline() const {
  const std::lock_guard lock(mutex_);
  return factory_ ? factory_->spec().name : std::string();
}

TrackingSession::Outcome TrackingSession::apply(std::uint64_t generation, const SampleBatch& batch, Duration still_interval) {
  const std::lock_guard lock(mutex_);
  Outcome outcome;
  outcome.owner = generation == generation_;
  if (!outcome.owner) return outcome;
  const std::uint64_t rewinds_before = timeline_ ? timeline_->rewinds() : 0;
  const auto building_before = building_;
  find_tape();
  follow();
  for (const Sample& sample : batch.samples) {
    if (sample.sequence <= applied_through_) {
      ++outcome.duplicates;
      continue;
    }
    if (sample.sequence != applied_through_ + 1) {
      outcome.gap_at = sample.sequence;
      break;
    }
    applied_through_ = sample.sequence;
    ++outcome.applied;
    if (!take(sample) && ++outcome.late == 1) outcome.first_late = sample.sequence;
    if (!timeline_ && std::holds_alternative<RssScan>(sample.body)) settle();
  }
  if (outcome.applied > 0) {
    settle();
    if (timeline_) timeline_->catch_up();
    answer(outcome, still_interval);
    const auto* said = std::get_if<FusedPosition>(&outcome.answer);
    if (timeline_) write(TapeAnswered{outcome.at, applied_through_, said ? std::optional(digest(*said)) : std::nullopt});
  }
  if (tape_) request_.recordings->grown(*tape_, std::exchange(written_, 0), false);
  outcome.building_changed = building_ != building_before;
  if (timeline_ && timeline_->rewinds() > rewinds_before) outcome.rewinds = timeline_->rewinds() - rewinds_before;
  outcome.applied_through = applied_through_;
  return outcome;
}

// False = too late to count.
bool TrackingSession::take(const Sample& sample) {
  if (!placed_) hold(sample);
  if (timeline_) write(sample);
  if (timeline_ && !timeline_->take(sample)) {
    if (++late_in_a_row_ < kLateInARowMost) return false;
    // One absurd stamp, or a phone that restarted its clock, must not silence the session for good.
    track_in(building_);
    write(sample);
    if (!timeline_->take(sample)) return false;
    newest_.reset();
  }
  late_in_a_row_ = 0;
  const auto* scan = std::get_if<RssScan>(&sample.body);
  if (scan && (!newest_ || !newest_scan_ || scan->time >= newest_scan_->time())) newest_scan_.emplace(*scan);
  const PhoneTime time = time_of(sample.body);
  if (!newest_ || time >= *newest_) {
    newest_ = time;
    if (const auto* motion = std::get_if<MotionReport>(&sample.body)) at_rest_ = motion->at_rest;
  }
  return true;
}

void TrackingSession::hold(const Sample& sample) {
  held_.push_back(sample);
  if (held_.size() > kHeldMost) held_.pop_front();
}

// A session that has no position yet moves to the building its scans speak for, or to a newer snapshot of its own, with all it heard.
void TrackingSession::settle() {
  if (placed_) return;
  if (!building_ && !resolve()) return;
  const auto newest = buildings_.find(building_->record().id);
  const bool newer = newest && newest != building_;
  if (timeline_ && !newer) return;
  track_in(newer ? newest : building_);
  if (!timeline_) return;
  for (const Sample& sample : held_) {
    write(sample);
    timeline_->take(sample);
  }
}

// A session that has a position goes on from it. A building that was removed is still tracked in.
void TrackingSession::follow() {
  if (!placed_ || !building_) return;
  auto newest = buildings_.find(building_->record().id);
  if (!newest || newest == building_) return;
  if (!timeline_ || !timeline_->newest()) return track_in(std::move(newest));
  const auto factory = pipeline_in(newest);
  if (!factory || !*factory) return;
  building_ = std::move(newest);
  factory_ = **factory;
  const Random random = random_.split();
  if (tape_) write(TapeExchanged{tracked_with(), random, applied_through_});
  timeline_->exchange(factory_, random, applied_through_);
}

bool TrackingSession::resolve() {
  if (!newest_) return false;
  std::vector<Bssid> heard;
  for (const Sample& sample : held_) {
    const auto* scan = std::get_if<RssScan>(&sample.body);
    if (!scan || *newest_ - scan->time > kHeardWithin) continue;
    for (const ScanReading& reading : scan->readings) heard.push_back(reading.bssid);
  }
  std::ranges::sort(heard);
  heard.erase(std::ranges::unique(heard).begin(), heard.end());
  const std::optional<BuildingId> found = buildings_.resolve(heard);
  if (!found || (request_.only.value != 0 && *found != request_.only)) return false;
  building_ = buildings_.find(*found);
  return building_ != nullptr;
}

// Absent: it is being made ready on a worker. A connection's thread learns no network.
std::optional<TrackingSession::FactoryAnswer> TrackingSession::pipeline_in(const std::shared_ptr<const Building>& building) const {
  if (!request_.prepare || !*request_.prepare) return building->pipeline(request_.pipeline);
  auto at_hand = building->pipeline_at_hand(request_.pipeline);
  if (!at_hand) (*request_.prepare)(building, request_.pipeline);
  return at_hand;
}

void TrackingSession::track_in(std::shared_ptr<const Building> building) {
  building_ = std::move(building);
  timeline_.reset();
  const auto factory = pipeline_in(building_);
  if (!factory || !*factory) {
    cannot_track_ = factory ? factory->fault() : Fault{FaultCode::kOverloaded, "pipeline", "it is being made ready; what the phone sends is kept"};
    return;
  }
  cannot_track_.reset();
  factory_ = **factory;
  const Random random = random_.split();
  if (tape_) write(TapeBegun{tracked_with(), random});
  timeline_.emplace(factory_->make_tracker(random));
}

// Before a batch: the tape, where one is wanted, and a piece to write on that begins with the tracker as it stands.
void TrackingSession::find_tape() {
  if (!request_.recordings || (request_.recordings->idle() && !tape_)) return;
  if (!timeline_ || !building_) return;  // nothing is tracked yet: the next batch is asked again
  tape_ = request_.recordings->tape_for(std::move(tape_), building_->record().id, tracked_, request_.device_model, request_.app, seed_);
  if (!tape_ || !tape_->tape.wants_piece(request_.recordings->now())) return;
  const std::size_t bytes = tape_->tape.begin_piece(timeline_->clone(), tracked_with(), request_.recordings->now());
  request_.recordings->grown(*tape_, bytes, true);
}

bool TrackingSession::is_recorded() const {
  if (!request_.recordings || request_.recordings->idle()) return false;
  const std::lock_guard lock(mutex_);
  return building_ && request_.recordings->records(tape_.get(), building_->record().id, tracked_);
}

void TrackingSession::write(TapeEntry entry) {
  if (tape_) written_ += tape_->tape.write(std::move(entry), request_.recordings->now());
}

TrackedWith TrackingSession::tracked_with() const {
  return {building_, request_.recordings->description_of(*building_), building_->map_version(), factory_->spec().name};
}

Result<Explanation> TrackingSession::explain() const {
  std::shared_ptr<const Building> building;
  std::shared_ptr<const TrackerFactory> factory;
  PositionGrounds grounds;
  {
    const std::lock_guard lock(mutex_);
    if (!newest_) return no_position({FaultCode::kNotFound, "", "the phone has sent nothing yet"});
    if (!timeline_ || !timeline_->newest()) return no_position(cannot_track_.value_or(no_building_matches()));
    const Tracker& tracker = timeline_->tracker();
    auto position = tracker.position(*timeline_->newest());
    if (!position) return no_position(tracker.why_no_fix());
    building = building_;
    factory = factory_;
    grounds = grounds_of(tracker, *std::move(position), newest_scan_ ? newest_scan_->scan() : RssScan{});
  }
  Explanation explanation = wayfuse::explain(*building, std::move(grounds));  // a pass over the survey: the phone does not wait for it
  explanation.tracked = tracked_;
  explanation.pipeline = factory->spec().name;
  explanation.remarks = factory->remarks();
  return explanation;
}

void TrackingSession::answer(Outcome& outcome, Duration still_interval) {
  if (!newest_) return;
  outcome.at = timeline_ && timeline_->newest() ? *timeline_->newest() : *newest_;
  if (!timeline_) {
    outcome.answer = cannot_track_.value_or(no_building_matches());
    return;
  }
  std::optional<FusedPosition> position = timeline_->tracker().position(outcome.at);
  if (position) {  // the same gate the phone will use: nothing that is not finite or not possible leaves [SAFETY C16]
    if (const auto sound = check(*position, "position"); !sound) {
      outcome.unsound = true;
      outcome.answer = Fault{FaultCode::kInternal, sound.fault().field, sound.fault().cause};
      return;
    }
  }
  if (!position) {
    outcome.answer = timeline_->tracker().why_no_fix();
    return;
  }
  placed_ = true;
  held_.clear();
  held_.shrink_to_fit();
  const bool said_lately = said_ && at_rest_ && outcome.at - said_->valid_at < still_interval &&
                           said_->place.floor == position->place.floor &&
                           distance_m(said_->place.point, position->place.point) < kStillWithin_m;
  if (said_lately) return;
  said_ = position;
  outcome.answer = *std::move(position);
}

}  // namespace wayfuse
