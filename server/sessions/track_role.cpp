#include "server/sessions/role.hpp"
#include "server/sessions/scan_wishes.hpp"

namespace wayfuse {
namespace {

/// One connection's hold on a tracking session.
class TrackRole final : public RoleConversation {
 public:
  TrackRole(RoleSeat seat, std::shared_ptr<TrackingSession> session, PhoneTime phone_time, bool recovered)
      : world_(seat.world),
        output_(seat.output),
        session_(std::move(session)),
        recovered_(recovered),
        expires_at_(seat.rights.expires_at),
        generation_(session_->attach()) {
    clock_offset_.note(phone_time, world_.clock.now());
    show();
  }

  void welcome() {
    const auto building = session_->building();
    Welcome welcome = welcome_from(world_, building.get(), expires_at_);
    welcome.session = session_->name();
    welcome.tracked = session_->tracked();
    welcome.applied_through = session_->applied_through();
    welcome.recovered = recovered_;
    if (building) welcome.pipeline = session_->pipeline();
    welcome.is_recorded = told_recorded_ = session_->is_recorded();
    output_.send(welcome);
  }

  bool receive(ClientMessage& message) override {
    const auto* batch = std::get_if<SampleBatch>(&message);
    if (!batch) return false;
    const ServerTime arrived = world_.clock.now();
    const auto outcome = session_->apply(generation_, *batch, world_.settings.still_interval);
    if (!outcome.owner) {
      yield_to_newer();
      return true;
    }
    if (outcome.applied > 0) clock_offset_.note(outcome.at, arrived);
    count(outcome, arrived);
    complain(outcome);
    if (outcome.building_changed) {
      show();
      welcome();
    }
    tell_recording();
    output_.send(Ack{world_.sessions.epoch(), outcome.applied_through});
    overhear(*batch, outcome);
    say(outcome);
    return true;
  }

  void tick() override {
    if (!session_->owned_by(generation_)) return yield_to_newer();
    tell_recording();
  }

  void goodbye() override {
    if (!session_->owned_by(generation_)) return;
    world_.sessions.end(session_->name());
    world_.board.gone(session_->tracked(), world_.clock.wall_now());
  }

  void disconnected() override {
    if (!session_->owned_by(generation_)) return;
    session_->detach(generation_, world_.clock.now());
    world_.board.set_connected(session_->tracked(), false);
  }

 private:
  // Whoever is recorded is told, and told when it ends [SAFETY C19].
  void tell_recording() {
    if (session_->is_recorded() != told_recorded_) welcome();
  }

  void yield_to_newer() { output_.close({FaultCode::kConflict, "", "another connection resumed this session"}); }

  void show() {
    SessionSummary summary;
    summary.tracked = session_->tracked();
    if (const auto building = session_->building()) summary.building = building->record().id;
    summary.device_model = session_->device_model();
    summary.app = session_->app();
    summary.pipeline = session_->pipeline();
    summary.since = session_->since();
    summary.connected = true;
    summary.applied_through = session_->applied_through();
    world_.board.put(summary);
  }

  void count(const TrackingSession::Outcome& outcome, ServerTime arrived) {
    SessionCounters& counters = world_.counters;
    counters.batches++;
    counters.samples_applied += outcome.applied;
    counters.samples_duplicate += outcome.duplicates;
    counters.samples_late_dropped += outcome.late;
    counters.rewinds += outcome.rewinds;
    counters.unsound_positions += outcome.unsound;
    counters.apply_us += static_cast<std::uint64_t>((world_.clock.now() - arrived).count());
  }

  // One scan every few seconds is enough to watch access points by.
  void overhear(const SampleBatch& batch, const TrackingSession::Outcome& outcome) {
    constexpr Duration kEvery = std::chrono::seconds(5);
    const auto* position = std::get_if<FusedPosition>(&outcome.answer);
    const auto building = session_->building();
    if (!world_.heard || !position || !building) return;
    for (const Sample& sample : batch.samples) {
      const auto* scan = std::get_if<RssScan>(&sample.body);
      if (!scan || (overheard_ && scan->time < *overheard_ + kEvery)) continue;
      overheard_ = scan->time;
      world_.heard(std::hash<std::string>()(session_->tracked()), *building, *scan, *position);
    }
  }

  void complain(const TrackingSession::Outcome& outcome) {
    if (outcome.late > 0) {
      output_.send(report({FaultCode::kLate, "samples",
                           std::to_string(outcome.late) + " dropped: older than " +
                               std::to_string(Timeline::kWindow / std::chrono::seconds(1)) + " s before the newest evidence"},
                          outcome.first_late));
    }
    // Said once a gap: what is in flight behind it would repeat it.
    if (outcome.gap_at && gap_said_after_ != outcome.applied_through) {
      gap_said_after_ = outcome.applied_through;
      world_.counters.sequence_gaps++;
      output_.send(
          report({FaultCode::kSequenceGap, "samples",
                  std::to_string(*outcome.gap_at) + " came where " + std::to_string(outcome.applied_through + 1) + " was due"},
                 *outcome.gap_at));
    }
    if (!outcome.gap_at) gap_said_after_.reset();
  }

  void say(const TrackingSession::Outcome& outcome) {
    if (const auto* position = std::get_if<FusedPosition>(&outcome.answer)) {
      const auto age_us = clock_offset_.age(position->valid_at, world_.clock.now()).count();
      world_.counters.positions++;
      world_.counters.note_radius(position->radius68_m);
      world_.counters.position_age_us += static_cast<std::uint64_t>(age_us > 0 ? age_us : 0);
      world_.board.moved(session_->tracked(), *position, outcome.applied_through, world_.clock.wall_now());
      output_.send(Position{*position, outcome.applied_through});
      wish(wishes_.after(*position));
    } else if (const auto* reason = std::get_if<Fault>(&outcome.answer)) {
      world_.counters.no_fixes++;
      output_.send(NoFix{outcome.at, *reason});
      wish(wishes_.without_position());
    }
  }

  void wish(const std::optional<ScanHint>& hint) {
    if (hint) output_.send(*hint);
  }

  SessionWorld& world_;
  SessionOutput& output_;
  const std::shared_ptr<TrackingSession> session_;
  const bool recovered_;
  const std::optional<UnixTime> expires_at_;
  const std::uint64_t generation_;
  ClockOffset clock_offset_;
  std::optional<std::uint64_t> gap_said_after_;
  ScanWishes wishes_;
  std::optional<PhoneTime> overheard_;
  bool told_recorded_ = false;
};

Result<SessionRequest> request_from(const RoleSeat& seat, const Hello& hello) {
  SessionRequest request;
  request.key_id = seat.rights.key_id;
  request.only = seat.rights.building;
  request.pipeline = hello.pipeline;
  request.device_model = hello.device_model;
  request.app = hello.app;
  request.begins_after = hello.resume ? hello.resume->acked_through : 0;
  request.since = seat.world.clock.wall_now();
  request.recordings = seat.world.recordings;
  request.prepare = &seat.world.prepare;
  if (hello.building.value != 0) {
    auto building = ready_building(seat.world.buildings, seat.world.store, hello.building);
    if (!building) return building.fault();
    request.building = *std::move(building);
    if (!seat.world.prepare) {
      const auto pipeline = request.building->pipeline(hello.pipeline);
      if (!pipeline) return pipeline.fault();
    } else if (const auto at_hand = request.building->pipeline_at_hand(hello.pipeline); at_hand && !*at_hand) {
      return at_hand->fault();
    }
  } else if (!hello.pipeline.empty()) {
    const auto known = preset(hello.pipeline);
    if (!known) return known.fault();
  }
  return request;
}

// The session to go on with, if the server has it whole: nothing the client forgot may be missing here.
std::shared_ptr<TrackingSession> resumable(const RoleSeat& seat, const Resume& resume) {
  if (resume.epoch != seat.world.sessions.epoch()) return nullptr;
  auto session = seat.world.sessions.find(resume.session, seat.rights.key_id);
  return session && session->applied_through() >= resume.acked_through ? session : nullptr;
}

}  // namespace

Result<std::shared_ptr<RoleConversation>> begin_tracking(RoleSeat seat, const Hello& hello) {
  SessionWorld& world = seat.world;
  std::shared_ptr<TrackingSession> session = hello.resume ? resumable(seat, *hello.resume) : nullptr;
  const bool recovered = session != nullptr;
  if (!recovered) {
    auto request = request_from(seat, hello);
    if (!request) return request.fault();
    session = world.sessions.begin(*std::move(request), world.buildings, world.clock.now());
    if (!session) return Fault{FaultCode::kOverloaded, "", "the server holds as many sessions as it may"};
  }
  (recovered ? world.counters.sessions_resumed : world.counters.sessions_begun)++;
  if (hello.resume && !recovered) world.counters.sessions_not_recovered++;
  const auto role = std::make_shared<TrackRole>(std::move(seat), std::move(session), hello.phone_time, recovered);
  role->welcome();
  return std::shared_ptr<RoleConversation>(role);
}

}  // namespace wayfuse
