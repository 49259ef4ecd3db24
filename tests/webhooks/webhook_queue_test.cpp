#include "server/webhooks/webhook_queue.hpp"

#include <gtest/gtest.h>

#include "server/webhooks/signature.hpp"

namespace wayfuse {
namespace {

ServerTime at(double time_s) { return ServerTime{from_seconds(time_s)}; }

NumberedZoneEvent event(std::uint64_t number, const std::string& zone = "3", std::uint64_t building = 1) {
  NumberedZoneEvent made{number, {building}, {}};
  made.event.tracked = "phone";
  made.event.zone = zone;
  made.event.id = "e-" + std::to_string(number);
  return made;
}

WebhookRecord hook(std::uint64_t id, std::vector<std::uint64_t> zones = {}) {
  return {id, "https://example.org/" + std::to_string(id), std::string(32, 's'), std::move(zones), true, {}};
}

WebhookQueue queue_of(std::vector<WebhookRecord> hooks, WebhookSettings settings = {}) {
  WebhookQueue queue(settings, Random(1));
  queue.put_webhooks({1}, hooks);
  return queue;
}

TEST(WebhookQueue, OffersEachEventToTheWebhooksThatWantIt) {
  WebhookRecord off = hook(4);
  off.enabled = false;
  WebhookQueue queue = queue_of({hook(1), hook(2, {3}), hook(3, {9}), off});
  queue.offer(event(1), at(0));
  queue.offer(event(2, "3", 7), at(0));
  EXPECT_EQ(queue.total().waiting, 2u);
  const auto first = queue.take(at(0));
  const auto second = queue.take(at(0));
  EXPECT_EQ(first->webhook, 1u);
  EXPECT_EQ(second->webhook, 2u);
  EXPECT_NE(first->body.find(R"({"building":1,"event":{"type":"zone_event")"), std::string::npos) << first->body;
  EXPECT_FALSE(queue.take(at(0)));
}

TEST(WebhookQueue, HasOneEventOfAWebhookUnderWay) {
  WebhookQueue queue = queue_of({hook(1)});
  queue.offer(event(1), at(0));
  queue.offer(event(2), at(0));
  const auto first = queue.take(at(0));
  EXPECT_FALSE(queue.take(at(0)));
  queue.done(*first);
  EXPECT_EQ(queue.take(at(0))->id, "e-2");
  EXPECT_EQ(queue.state({1}, 1).delivered, 1u);
}

TEST(WebhookQueue, WaitsTwiceAsLongAfterEachFailureAndThenBuries) {
  WebhookSettings settings;
  settings.attempts = 4;
  WebhookQueue queue = queue_of({hook(1)}, settings);
  queue.offer(event(1), at(0));
  double now_s = 0;
  for (int attempt = 1; attempt <= 4; ++attempt) {
    auto delivery = queue.take(at(now_s));
    ASSERT_TRUE(delivery) << attempt;
    EXPECT_EQ(delivery->attempts, static_cast<unsigned>(attempt));
    queue.failed(*delivery, "answered 500", false, at(now_s));
    if (attempt == 4) break;
    const double wait_s = seconds(*queue.next_due() - at(now_s));
    EXPECT_GE(wait_s, 0.5 * (1 << (attempt - 1)));
    EXPECT_LE(wait_s, 1.0 * (1 << (attempt - 1)));
    EXPECT_FALSE(queue.take(at(now_s + wait_s - 0.001)));
    now_s += wait_s;
  }
  EXPECT_FALSE(queue.next_due());
  const auto dead = queue.dead_letters({1}, 1);
  ASSERT_EQ(dead.size(), 1u);
  EXPECT_EQ(dead[0].attempts, 4u);
  EXPECT_EQ(dead[0].failure, "answered 500");
  EXPECT_EQ(queue.retry_dead_letters({1}, 1, "", at(now_s)), 1u);
  EXPECT_EQ(queue.take(at(now_s))->attempts, 1u);
}

TEST(WebhookQueue, LetsOthersPassOneThatWaits) {
  WebhookQueue queue = queue_of({hook(1)});
  queue.offer(event(1), at(0));
  queue.failed(*queue.take(at(0)), "no answer", false, at(0));
  queue.offer(event(2), at(0.1));
  EXPECT_EQ(queue.take(at(0.1))->id, "e-2");
}

TEST(WebhookQueue, BuriesAtOnceWhatTheReceiverWillNeverTake) {
  WebhookQueue queue = queue_of({hook(1)});
  queue.offer(event(1), at(0));
  queue.failed(*queue.take(at(0)), "answered 410", true, at(0));
  EXPECT_EQ(queue.dead_letters({1}, 1).size(), 1u);
}

TEST(WebhookQueue, IsBounded) {
  WebhookSettings settings;
  settings.waiting_most = 5;
  settings.dead_most = 3;
  WebhookQueue queue = queue_of({hook(1)}, settings);
  for (std::uint64_t i = 1; i <= 20; ++i) queue.offer(event(i), at(0));
  const WebhookState state = queue.state({1}, 1);
  EXPECT_EQ(state.waiting, 5u);
  EXPECT_EQ(state.dead, 3u);
  EXPECT_EQ(state.dropped, 12u);
  EXPECT_EQ(queue.take(at(0))->id, "e-16") << "the newest are kept";
}

TEST(WebhookQueue, TellsOfItsNewestAttemptsAndWhatCameOfThem) {
  WebhookSettings settings;
  settings.attempts = 2;
  settings.attempts_most = 3;
  WebhookQueue queue = queue_of({hook(1)}, settings);
  queue.offer(event(1), at(0));
  auto delivery = queue.take(at(0));
  delivery->status = 500, delivery->took = std::chrono::milliseconds(20), delivery->sent_at = UnixTime(std::chrono::seconds(7));
  queue.failed(*delivery, "answered 500", false, at(1));
  using Outcome = WebhookAttempt::Outcome;
  ASSERT_EQ(queue.attempts({1}, 1).size(), 1u);
  const WebhookAttempt first = queue.attempts({1}, 1)[0];
  EXPECT_EQ(first.event_id, "e-1");
  EXPECT_EQ(first.attempt, 1u);
  EXPECT_EQ(first.status, 500);
  EXPECT_EQ(first.took, Duration(std::chrono::milliseconds(20)));
  EXPECT_EQ(first.at, UnixTime(std::chrono::seconds(7)));
  EXPECT_EQ(first.outcome, Outcome::kWaits);
  queue.failed(*queue.take(at(100)), "no answer", false, at(101));
  EXPECT_EQ(queue.attempts({1}, 1)[0].outcome, Outcome::kDead) << "newest first";
  for (std::uint64_t number = 2; number < 5; ++number) {
    queue.offer(event(number), at(200));
    queue.done(*queue.take(at(200)));
  }
  ASSERT_EQ(queue.attempts({1}, 1).size(), 3u) << "the oldest make room";
  EXPECT_EQ(queue.attempts({1}, 1)[0].event_id, "e-4");
  EXPECT_EQ(queue.attempts({1}, 1)[0].outcome, Outcome::kDelivered);
  EXPECT_TRUE(queue.attempts({1}, 9).empty());
}

TEST(WebhookQueue, SendsOneDeadLetterAgainWhereItIsNamed) {
  WebhookSettings settings;
  settings.attempts = 1;
  WebhookQueue queue = queue_of({hook(1)}, settings);
  for (std::uint64_t number = 1; number < 4; ++number) {
    queue.offer(event(number), at(0));
    queue.failed(*queue.take(at(0)), "answered 500", false, at(0));
  }
  EXPECT_EQ(queue.retry_dead_letters({1}, 1, "e-9", at(1)), 0u);
  EXPECT_EQ(queue.retry_dead_letters({1}, 1, "e-2", at(1)), 1u);
  EXPECT_EQ(queue.state({1}, 1).dead, 2u);
  EXPECT_EQ(queue.take(at(1))->id, "e-2");
  EXPECT_EQ(queue.dead_letters({1}, 1)[0].event_id, "e-1");
  EXPECT_EQ(queue.dead_letters({1}, 1)[1].event_id, "e-3");
}

TEST(WebhookQueue, ForgetsWhatWaitsForAWebhookThatIsNoMore) {
  WebhookQueue queue = queue_of({hook(1), hook(2)});
  queue.offer(event(1), at(0));
  auto under_way = queue.take(at(0));
  queue.put_webhooks({1}, {hook(2)});
  queue.failed(*under_way, "late", false, at(0));
  EXPECT_EQ(queue.total().waiting, 1u);
}

TEST(WebhookSignature, IsWhatTheStandardSays) {
  // HMAC-SHA256 with key "key" over "id.1.body", by `printf 'id.1.body' | openssl dgst -sha256 -hmac key -binary | base64`.
  EXPECT_EQ(webhook_signature("key", "id", "1", "body"), "v1,sYA3/+8KvyXbe4KAKZy0QWKFoLKSHDq/QWu0xQZyY7s=");
}

}  // namespace
}  // namespace wayfuse
