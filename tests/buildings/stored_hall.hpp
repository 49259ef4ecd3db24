#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "db/database_directory.hpp"
#include "server/buildings/building_shelf.hpp"
#include "tests/fixtures/scratch_folder.hpp"
#include "tests/locating/plan.hpp"

namespace wayfuse {

/// A building whose one hall is 44 x 8 m, 4 m a character, on a store without a thread. Workers run inline: everything is over, and
/// every answer there, when a call returns.
class StoredHall : public testing::Test {
 protected:
  StoredHall(const std::string& pipeline, PublicationPolicy publication) {
    DatabaseDirectory::Options options;
    options.own_thread = false;
    store = DatabaseDirectory::open(folder.path(), options).value();
    BuildingRecord record;
    record.name = "Hall";
    record.pipeline = pipeline;
    record.publication = publication;
    store->create_building(record, [&](Result<BuildingRecord> made) { id = made.value().id; });
  }
  static void run_inline(std::function<void()> task) { task(); }
  static Plan hall() { return Plan({"A....B....C", "...........", "D....E....F"}, 4.0); }

  void upload(const SurveyBatch& batch) {
    store->store(id, batch, [](Result<SurveyAck> ack) { EXPECT_TRUE(ack) << to_string(ack.fault()); });
  }
  void on_database(const std::function<void(BuildingDatabase&)>& task) {
    store->with_building(id, [&](Result<BuildingDatabase*> database) { task(*database.value()); });
  }
  void change(const std::function<void(BuildingRecord&)>& change_it) {
    on_database([&](BuildingDatabase& database) {
      BuildingRecord record = database.building().value();
      change_it(record);
      EXPECT_TRUE(database.update(record));
    });
  }

  ScratchFolder folder;
  std::unique_ptr<DatabaseDirectory> store;
  BuildingShelf shelf;
  BuildingId id;
};

}  // namespace wayfuse
