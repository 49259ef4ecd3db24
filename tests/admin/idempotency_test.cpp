#include "admin/idempotency.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/fixtures/scratch_folder.hpp"

namespace wayfuse {
namespace {

using ::testing::HasSubstr;

// One store, and ledgers that come and go over it as servers do.
class Ledger : public testing::Test {
 protected:
  class HandClock final : public Clock {
   public:
    ServerTime now() const override { return ServerTime{} + shift; }
    UnixTime wall_now() const override { return UnixTime{std::chrono::seconds(1'800'000'000)} + shift; }
    Duration shift{0};
  };
  Ledger() {
    DatabaseDirectory::Options options;
    options.own_thread = false;
    store = DatabaseDirectory::open(folder.path(), options).value();
    restart();
  }
  void restart() {
    ledger = std::make_unique<IdempotencyLedger>(*store, clock);
    EXPECT_TRUE(ledger->load());
  }
  static Request request(std::string body = "{}") {
    Request request;
    request.method = "POST";
    request.path = "/v1/buildings/1/zones";
    request.key_id = 7;
    request.headers["idempotency-key"] = "once";
    request.body = std::move(body);
    return request;
  }
  static Response made(std::string body) {
    Response response;
    response.status = 201;
    response.headers["location"] = "/v1/buildings/1/zones/4";
    response.body = std::move(body);
    return response;
  }
  /// What a POST is answered; `handler` says it where the request goes on to one.
  Response ask(const Request& request, std::optional<Response> handler) {
    std::optional<Response> answer;
    handled = false;
    auto respond = ledger->begin(request, [&](Response response) { answer = std::move(response); });
    if (respond) {
      handled = true;
      if (handler) (*respond)(*std::move(handler));
    }
    return answer.value_or(Response{});
  }

  ScratchFolder folder;
  HandClock clock;
  std::unique_ptr<DatabaseDirectory> store;
  std::unique_ptr<IdempotencyLedger> ledger;
  bool handled = false;
};

TEST_F(Ledger, GivesTheFirstAnswerAgainAlsoAfterARestart) {
  ask(request(), made("{\"id\":4}"));
  EXPECT_TRUE(handled);
  for (int start = 0; start < 2; ++start) {
    const Response again = ask(request(), made("{\"id\":5}"));
    EXPECT_FALSE(handled);
    EXPECT_EQ(again.status, 201);
    EXPECT_EQ(again.body, "{\"id\":4}");
    EXPECT_EQ(again.headers.at("location"), "/v1/buildings/1/zones/4");
    EXPECT_EQ(ask(request("{\"other\":1}"), {}).status, 409);
    restart();
  }
  clock.shift = std::chrono::hours(25);
  restart();
  ask(request(), made("{\"id\":5}"));
  EXPECT_TRUE(handled) << "a day later it is forgotten";
}

TEST_F(Ledger, SaysAfterARestartThatNobodyKnowsHowItEnded) {
  ask(request(), {});
  EXPECT_TRUE(handled);
  restart();
  const Response again = ask(request(), made("{}"));
  EXPECT_FALSE(handled);
  EXPECT_EQ(again.status, 409);
  EXPECT_THAT(again.body, HasSubstr("look whether it happened"));
}

TEST_F(Ledger, WritesNoSecretDown) {
  Response secret = made("{\"key\":\"wfk_secret\"}");
  secret.headers["cache-control"] = "no-store";
  ask(request(), secret);
  EXPECT_EQ(ask(request(), {}).body, secret.body) << "while the server runs it is said again";
  const auto kept = store->answered_posts();
  for (const AnsweredPost& post : kept.value()) EXPECT_EQ(post.answer, "");
  restart();
  const Response again = ask(request(), {});
  EXPECT_FALSE(handled);
  EXPECT_EQ(again.status, 409);
  EXPECT_THAT(again.body, HasSubstr("was not kept"));
}

TEST_F(Ledger, LetsWhatFailedBeTriedAgain) {
  Response failed;
  failed.status = 503;
  ask(request(), failed);
  ask(request(), failed);
  EXPECT_TRUE(handled);
  restart();
  EXPECT_EQ(ask(request(), made("{}")).status, 201);
  EXPECT_TRUE(handled);
}

TEST_F(Ledger, AnswersAlthoughTheStoreIsClosed) {
  store->close();
  EXPECT_EQ(ask(request(), made("{\"id\":4}")).status, 201);
  EXPECT_EQ(ask(request(), {}).body, "{\"id\":4}");
}

}  // namespace
}  // namespace wayfuse
