#include "server/buildings/building_keeper.hpp"

#include <gtest/gtest.h>

#include <deque>

#include "db/database_directory.hpp"
#include "tests/fixtures/scratch_folder.hpp"

namespace wayfuse {
namespace {

// A server killed under load is started while surveyors upload without a pause.
TEST(BuildingKeeper, TheFirstRoundEndsAlthoughNothingEverSettles) {
  ScratchFolder folder;
  DatabaseDirectory::Options options;
  options.own_thread = false;
  auto store = DatabaseDirectory::open(folder.path(), options);
  ASSERT_TRUE(store);
  BuildingRecord record;
  record.name = "Busy";
  BuildingId id;
  (*store)->create_building(record, [&](Result<BuildingRecord> made) { id = made->id; });
  BuildingShelf shelf;
  std::deque<std::function<void()>> tasks;
  BuildingKeeper keeper(**store, shelf, [&](std::function<void()> task) { tasks.push_back(std::move(task)); });

  keeper.refresh(id);
  keeper.refresh(id);  // an upload while it is being built
  ASSERT_EQ(tasks.size(), 1u);
  tasks.front()();
  EXPECT_FALSE(keeper.settled());
  keeper.wait_for_first_round({id});
  EXPECT_TRUE(shelf.find(id));
  tasks.back()();
  EXPECT_TRUE(keeper.settled());
}

}  // namespace
}  // namespace wayfuse
