#include <cstdio>

#include "db/database_directory.hpp"
#include "tests/db/survey_world.hpp"

// make_fixture FOLDER: writes the databases of today's schema versions as they belong into tests/db/fixtures, once a version:
// building 7 with batches 1..3 of the tests' survey, and a server with two keys. Run before the schema moves on.
int main(int argc, char** argv) {
  using namespace wayfuse;  // NOLINT
  if (argc != 2) return 2;
  DatabaseDirectory::Options options;
  options.own_thread = false;
  auto directory = DatabaseDirectory::open(argv[1], options);
  if (!directory) return 1;
  bool good = true;
  (*directory)->create_building(testing::sample_building(7), [&](Result<BuildingRecord> made) { good &= made.has_value(); });
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    (*directory)->store({7}, testing::sample_batch(seed), [&](Result<SurveyAck> ack) { good &= ack.has_value(); });
  }
  for (const char hash : {'a', 'b'}) {
    KeyRecord key;
    key.name = std::string("key ") + hash;
    key.keyed_hash = std::string(32, hash);
    key.scopes = {"observe", "track"};
    key.building.value = hash == 'b' ? 7 : 0;
    key.created_at = UnixTime(std::chrono::seconds(1'700'000'000));
    good &= (*directory)->add_key(key).has_value();
  }
  good &= (*directory)->revoke_key(2).has_value();
  (*directory)->close();
  return good ? 0 : 1;
}
