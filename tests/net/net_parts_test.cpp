#include <gtest/gtest.h>

#include "server/net/address_book.hpp"
#include "server/net/deadline_wheel.hpp"
#include "server/net/outbox.hpp"
#include "server/net/target.hpp"

namespace wayfuse {
namespace {

ServerTime at(double time_s) {
  return ServerTime(from_seconds(time_s));
}

ServerMessage decoded(const std::optional<std::string>& frame) {
  EXPECT_TRUE(frame);
  auto message = decode_server_message(*frame, Encoding::kCbor);
  EXPECT_TRUE(message);
  return *message;
}

Position position(std::uint64_t applied_through) {
  Position position;
  position.applied_through = applied_through;
  position.position.building = BuildingId{1};
  position.position.floors = {{FloorOrdinal{0}, 1.0}};
  return position;
}

TEST(Outbox, KeepsTheNewestPositionAndAckAndTheOrderOfAllElse) {
  Outbox outbox(Encoding::kCbor, {});
  EXPECT_TRUE(outbox.push(position(1)));
  EXPECT_TRUE(outbox.push(Ack{7, 1}));
  EXPECT_TRUE(outbox.push(GoAway{std::chrono::seconds(1), "first"}));
  EXPECT_TRUE(outbox.push(position(2)));
  EXPECT_TRUE(outbox.push(Ack{7, 2}));
  EXPECT_TRUE(outbox.push(GoAway{std::chrono::seconds(1), "second"}));
  EXPECT_EQ(std::get<GoAway>(decoded(outbox.pop())).reason, "first");
  EXPECT_EQ(std::get<GoAway>(decoded(outbox.pop())).reason, "second");
  EXPECT_EQ(std::get<Ack>(decoded(outbox.pop())).through, 2u);
  EXPECT_EQ(std::get<Position>(decoded(outbox.pop())).applied_through, 2u);
  EXPECT_TRUE(outbox.empty());
  EXPECT_EQ(outbox.bytes(), 0u);
}

TEST(Outbox, ANoFixReplacesAPositionThatIsOutdated) {
  Outbox outbox(Encoding::kCbor, {});
  EXPECT_TRUE(outbox.push(position(1)));
  EXPECT_TRUE(outbox.push(NoFix{PhoneTime{}, {FaultCode::kNoKnownAccessPoint, "", "none"}}));
  EXPECT_TRUE(std::holds_alternative<NoFix>(decoded(outbox.pop())));
  EXPECT_FALSE(outbox.pop());
}

TEST(Outbox, RefusesBeyondItsBoundsButNeverAnAckOrAPosition) {
  Outbox outbox(Encoding::kCbor, {.messages = 3, .bytes = 100'000});
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(outbox.push(GoAway{std::chrono::seconds(1), "x"}));
  EXPECT_FALSE(outbox.push(GoAway{std::chrono::seconds(1), "one too many"}));
  EXPECT_TRUE(outbox.push(Ack{1, 1}));
  EXPECT_TRUE(outbox.push(position(1)));
  Outbox narrow(Encoding::kCbor, {.messages = 100, .bytes = 300});
  EXPECT_TRUE(narrow.push(GoAway{std::chrono::seconds(1), std::string(200, 'x')}));
  EXPECT_FALSE(narrow.push(GoAway{std::chrono::seconds(1), std::string(200, 'x')}));
}

TEST(TokenBucket, LetsABurstThroughAndThenItsRate) {
  TokenBucket bucket(2.0, 10.0, at(0));
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(bucket.has(at(0)));
    bucket.spend(1, at(0));
  }
  EXPECT_FALSE(bucket.has(at(0)));
  EXPECT_FALSE(bucket.has(at(0.49)));
  EXPECT_TRUE(bucket.has(at(0.5)));
  EXPECT_FALSE(bucket.full(at(4.9)));
  EXPECT_TRUE(bucket.full(at(5.01)));
}

TEST(AddressBook, CapsConnectionsAndForgetsWhoHasLeft) {
  AddressBook::Settings settings;
  settings.connections_most = 2;
  const auto book = std::make_shared<AddressBook>(settings);
  auto first = book->enter("192.0.2.1", at(0));
  const auto second = book->enter("192.0.2.1", at(0));
  EXPECT_TRUE(first && second);
  EXPECT_FALSE(book->enter("192.0.2.1", at(0)));
  EXPECT_TRUE(book->enter("192.0.2.2", at(0)));
  first.reset();
  EXPECT_TRUE(book->enter("192.0.2.1", at(0)));
  for (int i = 0; i < 20'000; ++i) book->enter("198.51.100." + std::to_string(i), at(i));
  EXPECT_LT(book->size(), 5'000u);  // whoever left and owes nothing is forgotten
}

TEST(AddressBook, HoldsBackWhoFailsTooOften) {
  AddressBook::Settings settings;
  settings.refusals_burst = 3;
  settings.refusals_per_second = 1;
  const auto book = std::make_shared<AddressBook>(settings);
  EXPECT_TRUE(book->may_authenticate("192.0.2.1", at(0)));
  for (int i = 0; i < 3; ++i) book->refused("192.0.2.1", at(0));
  EXPECT_FALSE(book->may_authenticate("192.0.2.1", at(0.5)));
  EXPECT_TRUE(book->may_authenticate("192.0.2.1", at(1)));
  EXPECT_TRUE(book->may_authenticate("192.0.2.2", at(0)));
}

class Looked final : public Ticked {
 public:
  void look_at_deadlines() override { ++looks; }
  void drain(Duration, Duration) override {}
  void cut() override {}
  int looks = 0;
};

TEST(DeadlineWheel, LooksAtEverybodyOnceATurnAndOftenerWhereAsked) {
  DeadlineWheel wheel;
  std::vector<std::shared_ptr<Looked>> all;
  for (int i = 0; i < 25; ++i) {
    all.push_back(std::make_shared<Looked>());
    wheel.add(all.back());
  }
  wheel.add_often(all[0]);
  for (std::size_t i = 0; i < DeadlineWheel::kSlots; ++i) wheel.turn();
  EXPECT_EQ(all[0]->looks, 1 + 5);
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_EQ(all[i]->looks, 1);
  all.resize(3);
  EXPECT_EQ(wheel.all().size(), 3u);
}

TEST(Target, TakesPathAndQueryApart) {
  const auto target = parse_target("/v1/buildings/7?floor=-1&name=a+b%26c&empty");
  ASSERT_TRUE(target);
  EXPECT_EQ(target->path, "/v1/buildings/7");
  EXPECT_EQ(target->query, (std::map<std::string, std::string>{{"floor", "-1"}, {"name", "a b&c"}, {"empty", ""}}));
}

TEST(Target, RefusesWhatIsNotAPath) {
  for (const char* bad :
       {"", "v1", "http://x/y", "*", "/%", "/%4", "/%zz", "/a%00b", "/../x", "/a/./b", "/%2e%2e/x", "/?a=1&a=2", "/?%=1"}) {
    EXPECT_FALSE(parse_target(bad)) << bad;
  }
}

TEST(BearerToken, IsTakenFromItsSchemeOnly) {
  EXPECT_EQ(bearer_token("Bearer wf_x"), "wf_x");
  EXPECT_EQ(bearer_token("bEARER wf_x"), "wf_x");
  EXPECT_EQ(bearer_token("Basic wf_x"), "");
  EXPECT_EQ(bearer_token("Bearer"), "");
}

}  // namespace
}  // namespace wayfuse
