#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <vector>

#include "wayfuse/sdk/websocket_link.hpp"

namespace wayfuse {
namespace {

using namespace std::chrono_literals;

TEST(NetworkLoop, RunsTimersInOrderAndForgetsCancelledOnes) {
  NetworkLoop loop;
  std::string order;
  loop.after(3ms, [&] { order += 'c'; });
  loop.after(1ms, [&] { order += 'a'; });
  const auto cancelled = loop.after(2ms, [&] { order += 'b'; });
  loop.cancel(cancelled);
  loop.cancel(cancelled);
  loop.after(5ms, [&] { loop.stop(); });
  const PhoneTime before = loop.now();
  loop.run();
  EXPECT_EQ(order, "ac");
  EXPECT_GE(loop.now() - before, 5ms);
}

TEST(NetworkLoop, CancelWinsOverATimerThatHasExpired) {
  NetworkLoop loop;
  bool ran = false;
  std::uint64_t second = 0;
  loop.after(0s, [&] { loop.cancel(second); });
  second = loop.after(0s, [&] { ran = true; });
  loop.run_for(5ms);
  EXPECT_FALSE(ran);
}

TEST(NetworkLoop, TakesWorkFromOtherThreads) {
  NetworkLoop loop;
  int sum = 0;
  std::thread other([&] {
    for (int i = 0; i < 1000; ++i) loop.post([&] { ++sum; });
    loop.post([&] { loop.stop(); });
  });
  loop.run();
  other.join();
  EXPECT_EQ(sum, 1000);
}

TEST(WebsocketLinkSettings, BadAddressesAreNamed) {
  NetworkLoop loop;
  const std::vector<std::string> bad = {"",
                                        "http://a/",
                                        "ws://",
                                        "ws://:80",
                                        "ws://a:0",
                                        "ws://a:65536",
                                        "ws://a:1x",
                                        "ws://u:p@a/",
                                        "ws://a/#f",
                                        "ws://a b/",
                                        "ws://[::1",
                                        "ws://[::1]x",
                                        "wss://a\r\nX: y/",
                                        std::string("ws://a\0b", 8)};
  for (const std::string& url : bad) {
    WebsocketLinkSettings settings;
    settings.url = url;
    const auto made = loop.links(settings);
    ASSERT_FALSE(made) << url;
    EXPECT_EQ(made.fault().field, "url");
  }
  for (const char* url : {"ws://a", "wss://a:1/x?y", "wss://[::1]:8443/", "ws://a?x"}) {
    WebsocketLinkSettings settings;
    settings.url = url;
    EXPECT_TRUE(loop.links(settings)) << url;
  }
}

}  // namespace
}  // namespace wayfuse
