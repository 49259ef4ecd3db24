#include <gtest/gtest.h>
#include <malloc.h>

#include <cmath>

#include "tests/sessions/session_house.hpp"

namespace wayfuse {
namespace {

// As long as a mall's: what the hall has, and the shops' own networks, which no survey knows.
RssScan long_scan(double time_s, BuildingPoint where) {
  RssScan scan = SessionHouse::hall().scan_at(where, at(time_s));
  for (std::uint64_t i = 0; scan.readings.size() < 216; ++i) {
    scan.readings.push_back({Bssid{0x00'77'00'00'00'00u + i}, -70.0 - static_cast<double>(i % 20), Duration{0}, 2437, {}, {}});
  }
  for (ScanReading& reading : scan.readings) reading.rss_dbm = std::round(reading.rss_dbm);  // as phones tell them
  return scan;
}

// With the conversation, the copies it may go back to and the evidence of the last seconds.
TEST(SessionMemory, TenThousandOfTheDefaultFitInAGibibyte) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer keeps books of its own";
#endif
  constexpr std::size_t kSessions = 60;
  SessionHouse house;
  Hello hello = track_hello(house.add_building("Hall", true));
  hello.pipeline = "default";
  std::vector<Caller> callers(kSessions);
  const auto walk = [&](Caller& caller) {
    house.call(caller);
    caller.say(hello);
    std::uint64_t number = 1;
    for (double t = 0.5; t <= 30.0; t += 0.5) {  // two steps a second round a circle, a scan every three
      std::vector<SampleBody> heard = {step_at(t, 0.5 * t)};
      if (std::fmod(t, 3.0) == 0.5) heard.emplace_back(long_scan(t, {20.0, 4.0}));
      const std::size_t count = heard.size();
      caller.say(numbered(number, std::move(heard)));
      number += count;
    }
    ASSERT_FALSE(caller.output.closed);
    ASSERT_EQ(caller.output.last<Ack>().through, number - 1);
    std::vector<ServerMessage>().swap(caller.output.said);
  };
  walk(callers.front());  // what is made once is made
  const std::size_t before = mallinfo2().uordblks;
  for (std::size_t i = 1; i < kSessions; ++i) walk(callers[i]);
  const double bytes = static_cast<double>(mallinfo2().uordblks - before) / (kSessions - 1);
  RecordProperty("kB_a_session", std::to_string(bytes / 1000.0));
  EXPECT_LT(bytes, 1024.0 * 1024.0 * 1024.0 / 10'000.0);
  EXPECT_GT(bytes, 20'000.0) << "a thousand walkers are no less";
}

}  // namespace
}  // namespace wayfuse
