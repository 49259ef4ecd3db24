#include "tests/simulation/simulated_server.hpp"

#include <stdexcept>

namespace wayfuse {
namespace {

std::unique_ptr<DatabaseDirectory> open_store(const std::filesystem::path& folder) {
  DatabaseDirectory::Options options;
  options.own_thread = false;
  auto opened = DatabaseDirectory::open(folder, options);
  if (!opened) throw std::runtime_error(to_string(opened.fault()));
  return *std::move(opened);
}

SessionNames names_from(Random& random, std::vector<BegunSession>& begun) {
  return {[&] {
            begun.push_back({"session-" + std::to_string(random.bits()), 0});
            return begun.back().name;
          },
          [&] { return "phone-" + std::to_string(random.below(1'000'000'000)); },
          [&] { return begun.back().seed = random.bits(); }};
}

}  // namespace

SimulatedServer::SimulatedServer(const VirtualScheduler& scheduler, const std::filesystem::path& folder, std::uint64_t seed)
    : clock_(scheduler),
      random_(seed),
      store_(open_store(folder)),
      keeper_(std::make_unique<BuildingKeeper>(*store_, buildings_, [](std::function<void()> task) { task(); })),
      sessions_(1 + random_.below(1'000'000'000), names_from(random_, begun_), {}),
      world_(new SessionWorld{.clock = clock_,
                              .buildings = buildings_,
                              .sessions = sessions_,
                              .board = board_,
                              .store = *store_,
                              .counters = counters_,
                              .survey_changed = [this](BuildingId id) { keeper_->refresh(id); },
                              .settings = {}}) {
  for (const BuildingId id : store_->buildings()) keeper_->refresh(id);
}

SimulatedServer::~SimulatedServer() {
  store_->close();
}

BuildingId SimulatedServer::add_building(const std::string& name, const std::string& pipeline,
                                         const std::vector<ReferencePoint>& survey) {
  BuildingRecord record;
  record.name = name;
  record.pipeline = pipeline;
  BuildingId id;
  store_->create_building(record, [&](Result<BuildingRecord> made) { id = made.value().id; });
  store_->store(id, SurveyBatch{"first", survey}, [](Result<SurveyAck> ack) {
    if (!ack) throw std::runtime_error(to_string(ack.fault()));
  });
  keeper_->refresh(id);
  return id;
}

void SimulatedServer::sweep() {
  for (const std::string& tracked : sessions_.sweep(clock_.now())) board_.gone(tracked, clock_.wall_now());
  board_.sweep(clock_.wall_now() - std::chrono::seconds(30));
}

}  // namespace wayfuse
