#include "server/webhooks/webhook_sender.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <condition_variable>
#include <deque>
#include <thread>

#include "server/system_clock.hpp"
#include "server/webhooks/signature.hpp"
#include "server/zones/zone_watch.hpp"
#include "tests/fixtures/scratch_folder.hpp"

namespace wayfuse {
namespace {

/// Somebody who takes events: one request a connection, answered with the next status of a list.
class Receiver {
 public:
  explicit Receiver(std::deque<int> statuses) : statuses_(std::move(statuses)) {
    listener_ = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ::bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address);
    ::listen(listener_, 8);
    socklen_t size = sizeof address;
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~Receiver() {
    ::shutdown(listener_, SHUT_RDWR);
    ::close(listener_);
    thread_.join();
  }
  std::string url() const { return "http://127.0.0.1:" + std::to_string(port_) + "/hook"; }
  /// The next request, head and body; waits for it.
  std::string next() {
    std::unique_lock lock(mutex_);
    if (!arrived_.wait_for(lock, std::chrono::seconds(20), [this] { return !requests_.empty(); })) return {};
    std::string request = std::move(requests_.front());
    requests_.pop_front();
    return request;
  }

 private:
  void serve() {
    for (int peer = 0; (peer = ::accept(listener_, nullptr, nullptr)) >= 0; ::close(peer)) {
      std::string request;
      char piece[4096];
      for (ssize_t read = 0; !whole(request) && (read = ::recv(peer, piece, sizeof piece, 0)) > 0;) request.append(piece, static_cast<std::size_t>(read));
      int status = 204;
      {
        const std::lock_guard lock(mutex_);
        if (!statuses_.empty()) {
          status = statuses_.front();
          statuses_.pop_front();
        }
        requests_.push_back(request);
      }
      arrived_.notify_all();
      const std::string answer = "HTTP/1.1 " + std::to_string(status) + " X\r\nContent-Length: 0\r\nConnection: close\r\nLocation: http://127.0.0.1:1/\r\n\r\n";
      ::send(peer, answer.data(), answer.size(), MSG_NOSIGNAL);
    }
  }
  static bool whole(const std::string& request) {
    const auto head = request.find("\r\n\r\n");
    const auto length = request.find("Content-Length: ");
    return head != std::string::npos && length != std::string::npos && request.size() >= head + 4 + std::stoul(request.substr(length + 16));
  }

  int listener_ = -1;
  std::uint16_t port_ = 0;
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<int> statuses_;
  std::deque<std::string> requests_;
  std::thread thread_;
};

std::string header(const std::string& request, const std::string& name) {
  const auto at = request.find("\r\n" + name + ": ");
  if (at == std::string::npos) return {};
  const auto begin = at + name.size() + 4;
  return request.substr(begin, request.find("\r\n", begin) - begin);
}

class WebhookSenderTest : public testing::Test {
 protected:
  WebhookSenderTest() {
    DatabaseDirectory::Options options;
    options.own_thread = false;
    store = *DatabaseDirectory::open(folder.path(), options);
    zones.emplace(*store, clock, 77, quick());
    ZoneRecord lab;
    lab.id = 5;
    lab.name = "Lab";
    lab.region = {{{{0, 0}, {10, 0}, {10, 10}, {0, 10}}}};
    zones->put_zones({1}, {lab});
  }
  static ZoneRules quick() {
    ZoneRules rules;
    rules.settle_m = 0;
    rules.settle_at_rest = Duration{0};
    return rules;
  }
  void start(WebhookSettings settings, const std::string& url) {
    settings.first_wait = std::chrono::milliseconds(5);
    sender.emplace(*store, *zones, clock, settings, 1);
    sender->put_webhooks({1}, {{1, url, secret, {}, true, {}}});
    sender->start();
  }
  // A phone that is seen inside, then gone: two events.
  void visit(const std::string& phone) {
    FusedPosition position;
    position.building = {1};
    position.place = {{5, 5}, {0}};
    for (int i = 0; i < 3; ++i) zones->moved(phone, position);
    zones->gone(phone);
  }
  // Waits until the sender says so; the events that change it arrive on its own thread.
  template <typename Until>
  bool until(Until&& until) {
    const ServerTime give_up = clock.now() + std::chrono::seconds(20);
    while (!until() && clock.now() < give_up) std::this_thread::yield();
    return until();
  }

  ScratchFolder folder;
  SystemClock clock;
  std::unique_ptr<DatabaseDirectory> store;
  std::optional<ZoneWatch> zones;
  std::optional<WebhookSender> sender;
  const std::string secret = std::string(32, 'k');
};

TEST_F(WebhookSenderTest, PostsSignedEventsInOrder) {
  Receiver receiver({});
  start({.private_targets = true}, receiver.url());
  visit("phone-a");
  const std::string first = receiver.next();
  const std::string body = first.substr(first.find("\r\n\r\n") + 4);
  EXPECT_EQ(first.substr(0, 19), "POST /hook HTTP/1.1");
  EXPECT_EQ(header(first, "webhook-id"), "77-1");
  EXPECT_EQ(header(first, "webhook-signature"), webhook_signature(secret, "77-1", header(first, "webhook-timestamp"), body));
  EXPECT_NE(body.find(R"("transition":"entered")"), std::string::npos) << body;
  EXPECT_EQ(header(receiver.next(), "webhook-id"), "77-2");
  EXPECT_TRUE(until([&] { return sender->total().delivered == 2; }));
  EXPECT_EQ(sender->total().waiting, 0u);
}

TEST_F(WebhookSenderTest, TriesAgainUntilItIsTaken) {
  Receiver receiver({500, 302, 429});
  start({.private_targets = true}, receiver.url());
  visit("phone-a");
  EXPECT_TRUE(until([&] { return sender->total().delivered == 2; })) << sender->state({1}, 1).last_failure;
  EXPECT_EQ(sender->total().failed_attempts, 3u) << "a redirect is no delivery";
}

TEST_F(WebhookSenderTest, KeepsWhatNobodyTakesAndSendsItLater) {
  Receiver receiver({500, 500, 500, 500});
  start({.private_targets = true, .attempts = 2}, receiver.url());
  visit("phone-a");
  ASSERT_TRUE(until([&] { return sender->total().dead == 2; }));
  EXPECT_EQ(sender->dead_letters({1}, 1)[0].failure, "answered 500");
  EXPECT_EQ(sender->attempts({1}, 1)[0].status, 500);
  EXPECT_EQ(sender->attempts({1}, 1)[0].outcome, WebhookAttempt::Outcome::kDead);
  EXPECT_EQ(sender->retry_dead_letters({1}, 1, ""), 2u);
  EXPECT_TRUE(until([&] { return sender->total().delivered == 2; }));
  ASSERT_EQ(sender->attempts({1}, 1).size(), 6u) << "two attempts an event, and one more each";
  EXPECT_EQ(sender->attempts({1}, 1)[0].status, 204);
  EXPECT_GE(sender->attempts({1}, 1)[0].took, Duration{0});
}

TEST_F(WebhookSenderTest, LeadsNowhereInsideUnlessItMay) {
  Receiver receiver({});
  std::string url = receiver.url();
  url.replace(0, 4, "https");
  start({.attempts = 1}, url);
  visit("phone-a");
  ASSERT_TRUE(until([&] { return sender->total().dead == 2; }));
  EXPECT_EQ(sender->dead_letters({1}, 1)[0].failure, "the name leads into a private network");
  EXPECT_FALSE(sender->check_target(url));
}

}  // namespace
}  // namespace wayfuse
