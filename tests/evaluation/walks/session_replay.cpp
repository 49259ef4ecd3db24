#include "tests/evaluation/walks/session_replay.hpp"

#include "db/database_directory.hpp"
#include "server/buildings/building_keeper.hpp"
#include "server/buildings/building_shelf.hpp"
#include "server/sessions/session.hpp"
#include "tests/evaluation/walks/survey_upload.hpp"
#include "tests/evaluation/walks/virtual_loop.hpp"
#include "wayfuse/sdk/client.hpp"
#include "wayfuse/sdk/motion_tracker.hpp"

namespace wayfuse {
namespace {

Rights all_rights() {
  Rights rights;
  rights.key_id = 1;
  rights.track = rights.survey = true;
  return rights;
}

SessionNames names(std::uint64_t seed) {
  return {[] { return std::string("the-only-session-of-this-loop"); }, [] { return std::string("walker"); },
          [seed] { return seed; }};
}

// What one conversation needs around it.
struct World {
  World(VirtualLoop& loop, const BuildingShelf& shelf, DatabaseDirectory& store, std::uint64_t seed,
        std::function<void(BuildingId)> survey_changed)
      : sessions(1, names(seed), {}),
        world{loop.server(), shelf, sessions, board, store, counters, std::move(survey_changed), {}} {}
  SessionShelf sessions;
  LiveBoard board;
  SessionCounters counters;
  SessionWorld world;
};

}  // namespace

struct SessionReplay::House {
  ScratchFolder folder;
  std::unique_ptr<DatabaseDirectory> store;
  BuildingShelf shelf;
  BuildingId building;

  Result<void> create_building(const BuildingRecord& record);
  Result<void> upload(const std::vector<RecordedWalk>& survey, const std::function<void(std::vector<SurveyBatch>&)>& spoil);
  Result<void> make_snapshot(bool gate);
};

Result<void> SessionReplay::House::create_building(const BuildingRecord& record) {
  DatabaseDirectory::Options options;
  options.own_thread = false;
  auto opened = DatabaseDirectory::open(folder.path(), options);
  if (!opened) return opened.fault();
  store = *std::move(opened);
  std::optional<Fault> fault;
  store->create_building(record, [&](Result<BuildingRecord> made) {
    if (made)
      building = made->id;
    else
      fault = made.fault();
  });
  if (fault) return *fault;
  return {};
}

Result<void> SessionReplay::House::upload(const std::vector<RecordedWalk>& survey,
                                           const std::function<void(std::vector<SurveyBatch>&)>& spoil) {
  VirtualLoop loop(PhoneTime{});
  World world(loop, shelf, *store, 1, [](BuildingId) {});
  std::optional<Fault> refused;
  ClientEvents events;
  events.fault = [&](const FaultReport& report) { refused = report.fault; };
  Client client(
      phone_settings(Role::kSurvey, building, "surveyor"), events,
      [&] { return std::make_unique<LoopLink>(loop, world.world, all_rights(), Encoding::kCbor); }, loop.phone(), Random(1));
  client.start();
  const auto uploaded =
      upload_survey(client, survey, refused, [&] { loop.run_until(loop.now() + std::chrono::milliseconds(100)); }, spoil);
  if (!uploaded) return uploaded;
  client.stop();
  loop.run_until(loop.now() + std::chrono::seconds(1));
  if (refused) return *refused;
  return {};
}

Result<void> SessionReplay::House::make_snapshot(bool gate) {
  BuildingKeeper::Settings settings;
  settings.gate = gate;
  BuildingKeeper keeper(*store, shelf, [](std::function<void()> task) { task(); }, settings);
  keeper.refresh(building);
  keeper.settle();
  const auto failures = keeper.failures();
  if (!failures.empty()) return failures.front().second;
  return {};
}

SessionReplay::SessionReplay(std::unique_ptr<House> house) : house_(std::move(house)) {}
SessionReplay::~SessionReplay() {
  if (house_->store) house_->store->close();
}

Result<std::unique_ptr<SessionReplay>> SessionReplay::create(const RecordedSite& site,
                                                             const std::vector<RecordedWalk>& survey, const Survey& how) {
  std::unique_ptr<SessionReplay> replay(new SessionReplay(std::make_unique<House>()));
  if (const auto done = replay->house_->create_building(record_of(site)); !done) return done.fault();
  if (const auto done = replay->house_->upload(survey, how.spoil); !done) return done.fault();
  if (const auto done = replay->house_->make_snapshot(how.gate); !done) return done.fault();
  return replay;
}

std::shared_ptr<const Site> SessionReplay::site() const {
  return house_->shelf.find(house_->building)->site();
}

std::span<const DoubtfulPoint> SessionReplay::doubts() const { return house_->shelf.find(house_->building)->doubts(); }

std::vector<DeviceLevel> SessionReplay::devices() const {
  std::vector<DeviceLevel> devices;
  house_->store->with_building(house_->building, [&](Result<BuildingDatabase*> database) {
    MapVersions versions(*database.value());
    if (const auto live = versions.live().value()) devices = learn_device_levels(versions.material(*live).value().points);
  });
  return devices;
}

Result<void> SessionReplay::prepare(const std::string& pipeline) {
  const auto factory = house_->shelf.find(house_->building)->pipeline(pipeline);
  if (!factory) return factory.fault();
  return {};
}

Result<WalkReply> SessionReplay::run(const RecordedWalk& walk, std::span<const Instant> instants, const std::string& pipeline,
                                     std::uint64_t seed) const {
  const PhoneTime begin = begin_of(walk);
  VirtualLoop loop(begin);
  World world(loop, house_->shelf, *house_->store, seed, [](BuildingId) {});
  auto motion = MotionTracker::create({});
  if (!motion) return motion.fault();

  WalkReply reply;
  reply.at.resize(instants.size());
  std::optional<FusedPosition> newest;
  std::optional<Fault> fault;
  ClientEvents events;
  events.welcomed = [&](const Welcome& welcome) { motion->expect(welcome.magnetic_field); };
  events.position = [&](const Position& position) {
    if (!newest) reply.first_fix_s = seconds(loop.now() - begin);
    newest = position.position;
  };
  events.fault = [&](const FaultReport& report) { fault = report.fault; };
  ClientSettings settings = phone_settings(Role::kTrack, house_->building, walk.device_model);
  settings.pipeline = pipeline;
  Client client(
      settings, events, [&] { return std::make_unique<LoopLink>(loop, world.world, all_rights(), Encoding::kCbor); },
      loop.phone(), Random(seed));
  client.start();
  loop.run_until(begin);

  const auto send = [&](SampleBody body, PhoneTime time) {
    loop.run_until(time);
    if (const auto sent = client.send(std::move(body)); !sent && !reply.leaves_out(sent.fault()) && !fault) fault = sent.fault();
    loop.run_until(time);
  };
  PhoneEvents phone;
  phone.sample = [&](const MargSample& sample) {
    if (auto report = motion->feed(sample)) send(*std::move(report), sample.time);
  };
  phone.scan = [&](const RssScan& scan) { send(scan, scan.time); };
  phone.ask = [&](std::size_t i) {
    loop.run_until(instants[i].time);
    reply.at[i] = newest;
  };
  play(walk, instants, phone);
  client.stop();
  loop.run_until(loop.now() + std::chrono::seconds(1));
  if (fault) return Fault{fault->code, walk.id + ": " + fault->field, fault->cause};
  // What the last check before sending refuses is a fault of the pipeline's, not a gap in its answers.
  if (const std::uint64_t withheld = world.counters.unsound_positions; withheld > 0)
    return Fault{FaultCode::kInternal, walk.id, std::to_string(withheld) + " positions were withheld as unsound"};
  return reply;
}

}  // namespace wayfuse
