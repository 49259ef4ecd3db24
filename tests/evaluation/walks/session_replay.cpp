#include "tests/evaluation/walks/session_replay.hpp"

#include <unistd.h>

#include <stdexcept>

#include "db/database_directory.hpp"
#include "server/buildings/building_keeper.hpp"
#include "server/buildings/building_shelf.hpp"
#include "server/sessions/session.hpp"
#include "tests/evaluation/walks/virtual_loop.hpp"
#include "wayfuse/sdk/client.hpp"
#include "wayfuse/sdk/motion_tracker.hpp"
#include "wayfuse/sdk/surveyor.hpp"

namespace wayfuse {
namespace {

namespace fs = std::filesystem;

constexpr const char* kApp = "wayfuse-eval";
constexpr std::size_t kUploadsAhead = 4;  // batches sent before the answers to earlier ones are awaited

// A folder of its own that goes away with it.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (fs::temp_directory_path() / "wayfuse-eval-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error(pattern + ": cannot make a temporary folder");
    path_ = pattern;
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

Rights all_rights() {
  Rights rights;
  rights.key_id = 1;
  rights.track = rights.survey = true;
  return rights;
}

SessionNames names(std::uint64_t seed) {
  return {[] { return std::string("the-only-session-of-this-loop"); }, [] { return std::string("walker"); }, [seed] { return seed; }};
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

Result<std::vector<SurveyBatch>> batches_of(const RecordedWalk& walk) {
  Surveyor surveyor(walk.device_model.empty() ? "unknown" : walk.device_model, Random(fnv1a(walk.id)));
  if (const auto begun = surveyor.begin_walk(walk.id); !begun) return begun.fault();
  std::optional<PhoneTime> marked;
  for (const TruePoint& point : walk.way_points) {
    if (marked == point.time) continue;  // marked twice in one millisecond
    marked = point.time;
    if (const auto done = surveyor.mark(point.time, {point.point, walk.floor}, 0.0); !done) return done.fault();
  }
  for (const RssScan& scan : walk.scans) {
    if (const auto done = surveyor.scan(scan, UnixTime(scan.time.time_since_epoch())); !done) return done.fault();
  }
  if (const auto ended = surveyor.end_walk(); !ended) return ended.fault();
  return surveyor.take_batches();
}

}  // namespace

struct SessionReplay::House {
  ScratchFolder folder;
  std::unique_ptr<DatabaseDirectory> store;
  BuildingShelf shelf;
  BuildingId building;

  Result<void> create_building(const RecordedSite& site);
  Result<void> upload(const std::vector<RecordedWalk>& survey);
  Result<void> make_snapshot();
};

Result<void> SessionReplay::House::create_building(const RecordedSite& site) {
  DatabaseDirectory::Options options;
  options.own_thread = false;
  auto opened = DatabaseDirectory::open(folder.path(), options);
  if (!opened) return opened.fault();
  store = *std::move(opened);
  BuildingRecord record;
  record.name = site.name;
  record.georeference = site.georeference;
  record.floors = site.floors;
  std::optional<Fault> fault;
  store->create_building(record, [&](Result<BuildingRecord> made) {
    if (made) building = made->id;
    else fault = made.fault();
  });
  if (fault) return *fault;
  return {};
}

Result<void> SessionReplay::House::upload(const std::vector<RecordedWalk>& survey) {
  VirtualLoop loop(PhoneTime{});
  World world(loop, shelf, *store, 1, [](BuildingId) {});
  std::optional<Fault> refused;
  ClientEvents events;
  events.fault = [&](const FaultReport& report) { refused = report.fault; };
  ClientSettings settings;
  settings.role = Role::kSurvey;
  settings.building = building;
  settings.device_model = "surveyor";
  settings.app = kApp;
  Client client(settings, events, [&] { return std::make_unique<LoopLink>(loop, world.world, all_rights(), Encoding::kCbor); }, loop.phone(),
                Random(1));
  client.start();
  const auto settle = [&](std::size_t waiting) {
    for (int turn = 0; client.uploads_waiting() > waiting && !refused && turn < 1000; ++turn) {
      loop.run_until(loop.now() + std::chrono::milliseconds(100));
    }
    if (client.uploads_waiting() > waiting && !refused) refused = Fault{FaultCode::kTimeout, "survey", "an upload was never acknowledged"};
  };
  for (const RecordedWalk& walk : survey) {
    auto batches = batches_of(walk);
    if (!batches) return Fault{batches.fault().code, walk.id + ": " + batches.fault().field, batches.fault().cause};
    for (SurveyBatch& batch : *batches) {
      if (const auto queued = client.upload(std::move(batch)); !queued) return queued.fault();
      settle(kUploadsAhead);
      if (refused) return *refused;
    }
  }
  settle(0);
  client.stop();
  loop.run_until(loop.now() + std::chrono::seconds(1));
  if (refused) return *refused;
  return {};
}

Result<void> SessionReplay::House::make_snapshot() {
  BuildingKeeper keeper(*store, shelf, [](std::function<void()> task) { task(); });
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

Result<std::unique_ptr<SessionReplay>> SessionReplay::create(const RecordedSite& site, const std::vector<RecordedWalk>& survey) {
  std::unique_ptr<SessionReplay> replay(new SessionReplay(std::make_unique<House>()));
  if (const auto done = replay->house_->create_building(site); !done) return done.fault();
  if (const auto done = replay->house_->upload(survey); !done) return done.fault();
  if (const auto done = replay->house_->make_snapshot(); !done) return done.fault();
  return replay;
}

std::shared_ptr<const Site> SessionReplay::site() const { return house_->shelf.find(house_->building)->site(); }

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
  ClientSettings settings;
  settings.building = house_->building;
  settings.device_model = walk.device_model;
  settings.app = kApp;
  settings.pipeline = pipeline;
  settings.batch_interval = settings.rest_interval = Duration{0};  // the position is measured, not the radio's sleep
  Client client(settings, events, [&] { return std::make_unique<LoopLink>(loop, world.world, all_rights(), Encoding::kCbor); }, loop.phone(),
                Random(seed));
  client.start();
  loop.run_until(begin);

  const auto send = [&](SampleBody body, PhoneTime time) {
    loop.run_until(time);
    if (const auto sent = client.send(std::move(body)); !sent && !fault) fault = sent.fault();
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
  return reply;
}

}  // namespace wayfuse
