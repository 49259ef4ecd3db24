#include <fstream>
#include <optional>

#include "db/building_database.hpp"
#include "tests/db/campaigns.hpp"
#include "tests/db/faulty_disk.hpp"
#include "tests/db/journal.hpp"
#include "tests/db/survey_world.hpp"

namespace wayfuse::testing {
namespace {

// One building on one disk, and what its only client knows.
struct World {
  FaultyDisk disk;
  TemporaryFolder folder;
  Journal journal;
  std::optional<BuildingDatabase> database;
  std::string file = folder / "building-7.sqlite";
  BuildingDatabase::OpenOptions options;

  // A group of batches in one commit, as the writer thread makes them.
  void store(std::uint64_t first_seed, std::uint64_t batches) {
    std::vector<SurveyBatch> group;
    for (std::uint64_t i = 0; i < batches; ++i) group.push_back(sample_batch(first_seed + i, 1 + i % 3));
    for (const SurveyBatch& batch : group) note(sent_line(batch), journal);
    for (const Result<SurveyAck>& ack : database->store(group)) {
      if (ack) note(acked_line(*ack), journal);
    }
  }

  // The disk's files as real ones, for the checker's eyes.
  std::vector<std::string> losses(bool settled) {
    for (const char* part : {"", "-wal"}) {
      std::ofstream(folder / ("seen.sqlite" + std::string(part)), std::ios::binary) << disk.content(file + part);
    }
    std::vector<std::string> found = find_losses(folder / "seen.sqlite", journal, settled);
    for (const char* part : {"", "-wal", "-shm"}) std::filesystem::remove(folder / ("seen.sqlite" + std::string(part)));
    return found;
  }
};

// Works until the power goes at a random change, then looks, recovers, retries and looks again.
std::vector<std::string> one_cut(World& world, Random& random) {
  world.disk.cut_power_at(1 + random.below(220));
  std::uint64_t seed = random.below(1'000'000) * 1000;
  while (!world.disk.power_is_cut()) {
    const std::uint64_t batches = 1 + random.below(4);
    world.store(seed, batches);
    seed += batches;
    if (random.below(6) == 0 && !world.disk.power_is_cut()) {  // an orderly restart in between
      world.database.reset();
      Result<BuildingDatabase> opened = BuildingDatabase::open(world.file, world.options);
      if (!opened) break;
      world.database.emplace(std::move(*opened));
    }
  }
  world.database.reset();
  world.disk.restore_power(random);
  std::vector<std::string> losses = world.losses(false);
  if (!losses.empty()) return losses;
  Result<BuildingDatabase> opened = BuildingDatabase::open(world.file, world.options);
  if (!opened) return {"does not open: " + to_string(opened.fault())};
  return {};
}

}  // namespace

PowerFigures run_power_campaign(std::uint64_t cuts, std::uint64_t seed, bool synchronous_normal, const Progress& progress) {
  PowerFigures figures;
  for (std::uint64_t cut = 0; cut < cuts; ++cut) {
    World world;
    world.options.vfs = world.disk.name();
    world.options.synchronous_normal = synchronous_normal;
    world.options.checkpoint_pages = 24;
    Random random(seed + cut);
    Result<BuildingDatabase> made = BuildingDatabase::create(world.file, sample_building(), world.options);
    if (!made) return figures;
    world.database.emplace(std::move(*made));
    const std::vector<std::string> losses = one_cut(world, random);
    ++figures.cuts;
    for (const auto& [key, entry] : world.journal) ++(entry.acked ? figures.acked : figures.unknown);
    if (!losses.empty()) ++figures.lossy_cuts;
    for (const std::string& loss : losses) figures.losses.push_back("seed " + std::to_string(seed + cut) + ": " + loss);
    progress(cut + 1, cuts);
  }
  return figures;
}

}  // namespace wayfuse::testing
