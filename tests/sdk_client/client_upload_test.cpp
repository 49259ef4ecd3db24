#include "tests/sdk_client/scripted_link.hpp"

namespace wayfuse {
namespace {

using namespace std::chrono_literals;

SurveyBatch batch(std::string key) {
  ReferencePoint point;
  point.place = {{1, 2}, {0}};
  point.device_model = "m";
  point.scans = {RssScan{PhoneTime{5s}, {ScanReading{Bssid{1}, -50, 0us, 2412, {}, {}}}}};
  return {std::move(key), {point}};
}

class ClientUpload : public ClientTest {
 protected:
  std::vector<std::string> keys() {
    std::vector<std::string> found;
    for (const auto& sent : far().all<SurveyBatch>()) found.push_back(sent.idempotency_key);
    return found;
  }
  using Keys = std::vector<std::string>;
};

TEST_F(ClientUpload, KeepsABatchUntilItIsDurable) {
  start_streaming(Role::kSurvey);
  ASSERT_TRUE(client->upload(batch("a")));
  run(1);
  EXPECT_EQ(keys(), Keys{"a"});
  EXPECT_EQ(client->uploads_waiting(), 1u);
  far().say(SurveyAck{"a", 1, 1});
  EXPECT_EQ(client->uploads_waiting(), 0u);
  EXPECT_EQ(stored, Keys{"a"});
  far().say(SurveyAck{"a", 1, 1});  // told twice, heard once
  EXPECT_EQ(stored, Keys{"a"});
}

TEST_F(ClientUpload, SendsAgainUnderTheSameKeyAfterAReconnect) {
  start_streaming(Role::kSurvey);
  ASSERT_TRUE(client->upload(batch("a")));
  ASSERT_TRUE(client->upload(batch("b")));
  run(1);
  far().say(SurveyAck{"a", 1, 1});
  far().drop();
  ASSERT_TRUE(client->upload(batch("c")));
  ASSERT_TRUE(wait_for_attempt());
  far().open();
  EXPECT_FALSE(far().all<Hello>().at(0).resume);
  far().say(fresh("s2"));
  run(1);
  EXPECT_EQ(keys(), (Keys{"b", "c"}));
  EXPECT_EQ(far().all<SurveyBatch>().at(0), batch("b"));
}

TEST_F(ClientUpload, SendsAgainWhenNobodyAnswers) {
  start_streaming(Role::kSurvey);
  ASSERT_TRUE(client->upload(batch("a")));
  run(29);
  EXPECT_EQ(keys(), Keys{"a"});
  far().events.alive();
  run(2.5);
  EXPECT_EQ(keys(), (Keys{"a", "a"}));
}

TEST_F(ClientUpload, HasFourOnTheirWayAtMost) {
  start_streaming(Role::kSurvey);
  for (const char* key : {"a", "b", "c", "d", "e", "f"}) ASSERT_TRUE(client->upload(batch(key)));
  run(1);
  EXPECT_EQ(keys(), (Keys{"a", "b", "c", "d"}));
  far().say(SurveyAck{"b", 1, 1});  // and the next goes at once
  EXPECT_EQ(keys(), (Keys{"a", "b", "c", "d", "e"}));
}

TEST_F(ClientUpload, DropsWhatIsRefusedForGoodAndRepeatsTheRest) {
  start_streaming(Role::kSurvey);
  ASSERT_TRUE(client->upload(batch("bad")));
  ASSERT_TRUE(client->upload(batch("later")));
  run(1);
  far().say(FaultReport{{FaultCode::kIdempotencyConflict, "idempotency_key", "another body"}, 0, "bad", 0s});
  far().say(FaultReport{{FaultCode::kStorageFull, "", "disk full"}, 0, "later", 5s});
  EXPECT_EQ(client->uploads_waiting(), 1u);
  EXPECT_EQ(faults.size(), 2u);
  run(4.9);
  EXPECT_EQ(keys(), (Keys{"bad", "later"}));
  run(1.2);
  EXPECT_EQ(keys(), (Keys{"bad", "later", "later"}));
}

TEST_F(ClientUpload, RefusesAFullQueueABadKeyAndATwin) {
  settings.uploads_most = 2;
  make(Role::kSurvey);
  EXPECT_EQ(client->upload(batch("white space")).fault().field, "idempotency_key");
  ASSERT_TRUE(client->upload(batch("a")));
  EXPECT_EQ(client->upload(batch("a")).fault().code, FaultCode::kIdempotencyConflict);
  ASSERT_TRUE(client->upload(batch("b")));
  EXPECT_EQ(client->upload(batch("c")).fault().code, FaultCode::kTooLarge);
  EXPECT_FALSE(client->send(step()));
}

TEST_F(ClientUpload, RefusesWhatNoFrameCanCarry) {
  make(Role::kSurvey);
  SurveyBatch big = batch("big");
  big.points.front().scans.front().readings.assign(500, ScanReading{Bssid{1}, -50.5, 1234567us, 2412, 1.23456, 0.12345});
  for (std::size_t i = 0; i < 500; ++i) big.points.front().scans.front().readings[i].bssid.value = i + 1;
  big.points.push_back(big.points.front());
  EXPECT_EQ(client->upload(big).fault().code, FaultCode::kTooLarge);
}

TEST_F(ClientUpload, CarriesPartsOfWalksToo) {
  start_streaming(Role::kSurvey);
  SurveyWalk part;
  part.idempotency_key = "walk-1-0";
  part.walk = "walk-1";
  part.device_model = "m";
  part.marks = {{PhoneTime{1s}, {{0, 0}, {0}}, 0.3}, {PhoneTime{9s}, {{8, 0}, {0}}, 0.3}};
  part.scans = {RssScan{PhoneTime{5s}, {ScanReading{Bssid{1}, -50, 0us, 2412, {}, {}}}}};
  ASSERT_TRUE(client->upload(part));
  run(1);
  ASSERT_EQ(far().all<SurveyWalk>().size(), 1u);
  EXPECT_EQ(far().all<SurveyWalk>()[0], part);
  far().say(SurveyAck{"walk-1-0", 1, 1});
  EXPECT_EQ(client->uploads_waiting(), 0u);
}

TEST_F(ClientUpload, AnObserverSubscribesAgainAfterEveryReconnect) {
  make(Role::kObserve);
  Subscribe floor_two;
  floor_two.floors = {FloorOrdinal{2}};
  ASSERT_TRUE(client->subscribe(floor_two));
  client->start();
  far().open();
  far().say(fresh());
  ASSERT_EQ(far().all<Subscribe>().size(), 1u);
  far().drop();
  ASSERT_TRUE(wait_for_attempt());
  far().open();
  far().say(fresh("s2"));
  ASSERT_EQ(far().all<Subscribe>().size(), 1u);
  EXPECT_EQ(far().all<Subscribe>()[0], floor_two);
}

}  // namespace
}  // namespace wayfuse
