#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/recordings/recorded_house.hpp"

namespace wayfuse {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

class Recording : public testing::Test, public RecordedHouse {
 protected:
  Recording() { survey(0, 100, "all"), set_pipeline("wknn"); }
  void pass(Duration time) {
    house.clock.advance(time);
    recordings.sweep();
  }
};

TEST_F(Recording, IsOffUntilItIsOrdered) {
  WalkingPhone phone(*this, "");
  phone.walk(3);
  EXPECT_TRUE(recordings.idle());
  EXPECT_THAT(list(), IsEmpty());
  EXPECT_FALSE(desk->state(hall)->until);
}

TEST_F(Recording, ThePhoneIsToldThatItIsRecordedAndThatItIsNoMore) {
  WalkingPhone phone(*this, "");
  EXPECT_FALSE(phone.welcome->is_recorded);
  phone.walk(2);
  EXPECT_THAT(phone.caller->output.all<Welcome>(), IsEmpty()) << "nothing to tell";
  record({.on_for = std::chrono::minutes(1), .tracked = {}});
  phone.caller->conversation->tick();
  EXPECT_TRUE(phone.caller->output.last<Welcome>().is_recorded) << "without waiting for a batch";
  EXPECT_EQ(phone.caller->output.last<Welcome>().session, phone.welcome->session);
  phone.walk(1);
  EXPECT_THAT(phone.caller->output.all<Welcome>(), IsEmpty()) << "said once";
  WalkingPhone later(*this, "");
  EXPECT_TRUE(later.welcome->is_recorded) << "before it sends anything";
  phone.connect();
  EXPECT_TRUE(phone.welcome->is_recorded) << "again on a resume";
  pass(std::chrono::seconds(61));
  phone.walk(1);
  EXPECT_FALSE(phone.caller->output.last<Welcome>().is_recorded);
}

TEST_F(Recording, OnlyWhomItRecordsIsTold) {
  WalkingPhone phone(*this, ""), other(*this, "");
  record({.on_for = std::chrono::hours(1), .tracked = {phone.welcome->tracked}});
  phone.walk(1), other.walk(1);
  EXPECT_TRUE(phone.caller->output.last<Welcome>().is_recorded);
  EXPECT_THAT(other.caller->output.all<Welcome>(), IsEmpty());
  ASSERT_TRUE(desk->erase_all(hall, phone.welcome->tracked));
  phone.walk(1);
  EXPECT_FALSE(phone.caller->output.last<Welcome>().is_recorded) << "what is erased is not begun again";
}

TEST_F(Recording, BeginsInTheMiddleOfAWalkAndEndsWithItsTime) {
  WalkingPhone phone(*this, "");
  phone.walk(5);
  record({.on_for = std::chrono::minutes(1), .tracked = {}});
  phone.walk(3);
  ASSERT_THAT(list(), SizeIs(1));
  EXPECT_FALSE(list()[0].from_the_start);
  EXPECT_TRUE(list()[0].growing);
  EXPECT_EQ(list()[0].answers, 3u);
  EXPECT_EQ(list()[0].tracked, phone.welcome->tracked);
  pass(std::chrono::seconds(61));
  phone.walk(3);
  EXPECT_EQ(list()[0].answers, 3u);
  EXPECT_FALSE(list()[0].growing);
  EXPECT_FALSE(desk->state(hall)->until);
}

TEST_F(Recording, GoesOnThroughAResume) {
  record();
  WalkingPhone phone(*this, "");
  phone.walk(3);
  phone.connect();
  phone.walk(3);
  ASSERT_THAT(list(), SizeIs(1));
  EXPECT_EQ(list()[0].answers, 6u);
}

TEST_F(Recording, OfOneNamedPhoneAlone) {
  WalkingPhone wanted(*this, ""), other(*this, "");
  record({.on_for = std::chrono::hours(1), .tracked = {wanted.welcome->tracked}});
  wanted.walk(2), other.walk(2);
  ASSERT_THAT(list(), SizeIs(1));
  EXPECT_EQ(list()[0].tracked, wanted.welcome->tracked);
}

TEST_F(Recording, OlderPiecesAreForgottenByTheirAge) {
  record({.on_for = std::chrono::hours(10), .kept = std::chrono::hours(1), .tracked = {}});
  WalkingPhone phone(*this, "");
  phone.walk(2);
  pass(std::chrono::minutes(50));
  phone.walk(2);  // five minutes have passed: another piece
  pass(std::chrono::minutes(11));
  ASSERT_THAT(list(), SizeIs(1));
  EXPECT_EQ(list()[0].answers, 2u);
  EXPECT_EQ(list()[0].pieces_dropped, 1u);
  EXPECT_FALSE(list()[0].from_the_start);
  EXPECT_EQ(replay_all(list()[0].id).differing, 0u);
  pass(std::chrono::hours(1));
  EXPECT_THAT(list(), IsEmpty());
  EXPECT_EQ(desk->state(hall)->bytes_used, 0u);
}

TEST_F(Recording, TheOldestPieceGoesWhereThereIsNoRoom) {
  record({.on_for = std::chrono::hours(10), .bytes = RecordingOrder::kLeastBytes, .tracked = {}});
  WalkingPhone phone(*this, "default");
  std::size_t most = 0;
  for (int i = 0; i < 120; ++i) {
    phone.walk(60);
    pass(std::chrono::minutes(1));
    most = std::max(most, desk->state(hall)->bytes_used);
  }
  EXPECT_LE(most, RecordingOrder::kLeastBytes);
  EXPECT_GT(desk->state(hall)->pieces_dropped, 0u);
  ASSERT_THAT(list(), SizeIs(1));
  EXPECT_EQ(list()[0].pieces_dropped, desk->state(hall)->pieces_dropped);
  const auto answer = replay(list()[0].id);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->differing, 0u);
  EXPECT_THAT(answer->remarks, testing::Contains(testing::HasSubstr("older pieces of the recording are gone")));
}

TEST_F(Recording, NoMoreSessionsAtOnceThanThereIsRoomFor) {
  record({.on_for = std::chrono::hours(1), .bytes = 2 * RecordingShelf::kSessionBytes, .tracked = {}});
  WalkingPhone first(*this, ""), second(*this, ""), third(*this, "");
  first.walk(2), second.walk(2), third.walk(2);
  EXPECT_THAT(list(), SizeIs(2));
  EXPECT_EQ(desk->state(hall)->not_recorded, 1u) << "and that is said";
  first.caller->say(Goodbye{"done"});
  first.caller.reset();
  pass(std::chrono::seconds(1));
  third.walk(1);
  EXPECT_THAT(list(), SizeIs(3));
}

TEST_F(Recording, HoldsFewRetiredMapsHoweverOftenTheyChange) {
  record({.on_for = std::chrono::hours(10), .tracked = {}});
  WalkingPhone phone(*this, "");
  for (int i = 0; i < 12; ++i) {
    phone.walk(10);
    pass(std::chrono::minutes(6));
    with_database([](BuildingDatabase&) {});  // another snapshot
  }
  EXPECT_EQ(desk->state(hall)->pieces_dropped, 12u - RecordingShelf::kMapsMost);
  EXPECT_EQ(replay_all(list().at(0).id).differing, 0u);
}

TEST_F(Recording, WhatIsErasedIsGoneAndNotBegunAgain) {
  record();
  WalkingPhone phone(*this, ""), other(*this, "");
  phone.walk(3), other.walk(3);
  EXPECT_EQ(*desk->erase_all(hall, phone.welcome->tracked), 1u);
  phone.walk(3), other.walk(3);
  ASSERT_THAT(list(), SizeIs(1));
  EXPECT_EQ(list()[0].tracked, other.welcome->tracked);
  ASSERT_TRUE(desk->erase(list()[0].id, hall));
  EXPECT_FALSE(desk->erase(1, hall));
  other.walk(1);
  EXPECT_THAT(list(), IsEmpty());
  EXPECT_EQ(desk->state(hall)->bytes_used, 0u);
  record();  // a new order records everybody again
  phone.walk(1);
  EXPECT_THAT(list(), SizeIs(1));
}

TEST_F(Recording, BuildingsShareABoundAndDoNotSeeEachOther) {
  const BuildingId other = house.add_building("Other", true);
  RecordingOrder large{.on_for = std::chrono::hours(1), .bytes = RecordingOrder::kMostBytes, .tracked = {}};
  const BuildingId third = house.add_building("Third", true);
  ASSERT_TRUE(desk->order(hall, large));
  ASSERT_TRUE(desk->order(other, large));
  const auto refused = desk->order(third, large);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.fault().field, "bytes");
  WalkingPhone phone(*this, "");
  phone.walk(1);
  const auto id = list().at(0).id;
  EXPECT_TRUE(desk->recording(id, BuildingId{}));
  EXPECT_FALSE(desk->recording(id, other));
  EXPECT_FALSE(desk->content(id, other));
  EXPECT_EQ(desk->state(BuildingId{4711}).fault().code, FaultCode::kUnknownBuilding);
}

TEST_F(Recording, ChangesNoBitOfTheSession) {
  RecordedHouse quiet(1);
  quiet.survey(0, 100, "all"), quiet.set_pipeline("wknn");
  record();
  WalkingPhone recorded(*this, "default"), unrecorded(quiet, "default");
  recorded.walk(30), unrecorded.walk(30);
  EXPECT_EQ(recorded.told, unrecorded.told);
}

}  // namespace
}  // namespace wayfuse
