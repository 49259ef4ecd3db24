#include "tests/sdk_client/scripted_link.hpp"

namespace wayfuse {
namespace {

using enum ClientState;
using namespace std::chrono_literals;

class ClientStream : public ClientTest {
 protected:
  /// The link breaks and comes back as far as the hello.
  Hello reconnect() {
    far().drop();
    EXPECT_TRUE(wait_for_attempt());
    far().open();
    return far().all<Hello>().at(0);
  }
};

TEST_F(ClientStream, WakesTheRadioOnceASecond) {
  start_streaming();
  run(10);
  for (int i = 0; i < 40; ++i) {
    walk(1);
    run(0.25);
  }
  run(1);
  EXPECT_GE(far().all<SampleBatch>().size(), 10u);
  EXPECT_LE(far().all<SampleBatch>().size(), 12u);
  EXPECT_EQ(far().sequences(), numbers(1, 40));
}

TEST_F(ClientStream, HurriesLessAtRestAndAtOnceWhenTheWalkGoesOn) {
  start_streaming();
  walk(1);
  run(1);
  ASSERT_EQ(far().sequences(), numbers(1, 1));
  ASSERT_TRUE(client->send(rest()));
  run(3);
  EXPECT_EQ(far().sequences(), numbers(1, 1));
  walk(1);
  run(0.001);
  EXPECT_EQ(far().sequences(), numbers(1, 3));
  ASSERT_TRUE(client->send(rest()));
  run(5.001);
  EXPECT_EQ(far().sequences(), numbers(1, 4));
}

TEST_F(ClientStream, SaysLessAtRest) {
  start_streaming();
  for (int i = 0; i < 120; ++i) {  // a minute on the table, a report every half second
    run(0.5);
    ASSERT_TRUE(client->send(rest()));
    if (!far().sequences().empty()) far().say(Ack{7, far().sequences().back()});
  }
  run(5);
  EXPECT_GE(far().sequences().size(), 15u);
  EXPECT_LE(far().sequences().size(), 26u);
  PhoneTime end{};
  for (const SampleBatch& batch : far().all<SampleBatch>()) {
    for (const Sample& sample : batch.samples) {
      const auto& report = std::get<MotionReport>(sample.body);
      EXPECT_LE(report.interval, 4s);
      if (end != PhoneTime{}) {
        EXPECT_EQ(report.time - report.interval, end) << "a hole or an overlap in time";
      }
      end = report.time;
    }
  }
  EXPECT_EQ(far().all<SampleBatch>().size() <= 13, true) << far().all<SampleBatch>().size();
}

TEST_F(ClientStream, ForgetsWhatIsAcknowledgedAndNothingElse) {
  start_streaming();
  walk(5);
  run(1);
  far().say(Ack{7, 3});
  EXPECT_EQ(client->acked_through(), 3u);
  const Hello hello = reconnect();
  ASSERT_TRUE(hello.resume);
  EXPECT_EQ(hello.resume->session, "s1");
  EXPECT_EQ(hello.resume->epoch, 7u);
  EXPECT_EQ(hello.resume->acked_through, 3u);
  far().say(recovered(3));
  run(1);
  EXPECT_EQ(far().sequences(), numbers(4, 5));
}

TEST_F(ClientStream, BelievesHowFarTheServerApplied) {
  start_streaming();
  walk(9);
  run(1);  // all sent, no ack heard
  reconnect();
  far().say(recovered(6));
  EXPECT_EQ(client->acked_through(), 6u);
  run(1);
  EXPECT_EQ(far().sequences(), numbers(7, 9));
  EXPECT_TRUE(lost.empty());
}

TEST_F(ClientStream, TakesAllItKeepsIntoANewSessionWhenTheOldOneIsGone) {
  start_streaming();
  walk(9);
  run(1);
  far().say(Ack{7, 4});
  reconnect();
  far().say(FaultReport{{FaultCode::kUnknownSession, "resume.session", "not known"}, 0, {}, 0s});
  Welcome anew = fresh("s2", 8);
  anew.applied_through = 4;
  far().say(anew);
  ASSERT_EQ(client->state(), kStreaming);
  run(1);
  EXPECT_EQ(far().sequences(), numbers(5, 9));
  EXPECT_TRUE(lost.empty());
  far().say(Ack{8, 9});
  EXPECT_EQ(client->acked_through(), 9u);
}

TEST_F(ClientStream, KeepsNumberingWhileItIsOffline) {
  make();
  walk(2);
  client->start();
  walk(2);
  far().drop();
  walk(2);
  ASSERT_TRUE(wait_for_attempt());
  far().open();
  walk(1);
  far().say(fresh());
  run(1);
  EXPECT_EQ(far().sequences(), numbers(1, 7));
}

TEST_F(ClientStream, SaysWhatTheRingCouldNotHold) {
  start_streaming();
  walk(10);
  run(1);
  far().say(Ack{7, 10});
  far().drop();
  for (int i = 0; i < 90; ++i) {  // one a second, 90 s offline, 60 s of memory
    walk(1);
    run(1);
    if (client->state() == kConnecting) far().drop();
  }
  while (client->state() != kConnecting) run(0.01);
  far().open();
  const Hello hello = far().all<Hello>().at(0);
  ASSERT_TRUE(hello.resume);
  const std::uint64_t gone = hello.resume->acked_through;
  EXPECT_GE(gone, 39u);  // 100 samples, the last 60 s of them kept
  EXPECT_LE(gone, 75u);
  std::uint64_t next = 11;
  for (const auto& [first, last] : lost) {  // told without gap, once
    EXPECT_EQ(first, next);
    next = last + 1;
  }
  EXPECT_EQ(next, gone + 1);
  Welcome anew = fresh("s2", 7);
  anew.applied_through = gone;
  far().say(anew);
  run(5);
  EXPECT_EQ(far().sequences(), numbers(gone + 1, 100));
}

TEST_F(ClientStream, WhatWasSentAndDroppedIsLostOnlyIfTheServerSaysSo) {
  for (const bool whole : {true, false}) {
    lost.clear();
    start_streaming();
    walk(5);
    run(1);  // sent, never acknowledged
    far().drop();
    for (int i = 0; i < 70; ++i) {
      run(1);
      if (client->state() == kConnecting && i < 68) far().drop();
    }
    while (client->state() != kConnecting) run(0.01);
    walk(1);
    far().open();
    EXPECT_TRUE(lost.empty());
    if (whole) {
      far().say(recovered(5));
    } else {
      Welcome anew = fresh("s2");
      anew.applied_through = 5;
      far().say(anew);
    }
    run(1);
    EXPECT_EQ(far().sequences(), numbers(6, 6));
    if (whole) {
      EXPECT_TRUE(lost.empty());
    } else {
      ASSERT_EQ(lost.size(), 1u);
      EXPECT_EQ(lost[0], std::pair(std::uint64_t{1}, std::uint64_t{5}));
    }
    client.reset();
  }
}

TEST_F(ClientStream, BoundsItsMemoryWhateverTheAge) {
  settings.sample_bytes_most = 100'000;
  make();
  RssScan scan{clock.now(), std::vector<ScanReading>(100)};
  for (std::size_t i = 0; i < 100; ++i) scan.readings[i].bssid = Bssid{i + 1};
  for (int i = 0; i < 200; ++i) ASSERT_TRUE(client->send(scan));
  client->start();
  std::uint64_t dropped = 0;
  for (const auto& [first, last] : lost) dropped += last - first + 1;
  EXPECT_GT(dropped, 150u);
  far().open();
  far().say(fresh());
  run(10);
  EXPECT_EQ(far().sequences(), numbers(1, 200 - dropped));  // a session that resumes nothing counts from 1
  far().say(Ack{7, 3});
  EXPECT_EQ(client->acked_through(), dropped + 3);
  EXPECT_EQ(client->last_sequence(), 200u);
}

TEST_F(ClientStream, CutsAReplayIntoFramesTheServerTakes) {
  make();
  RssScan scan{clock.now(), std::vector<ScanReading>(150)};
  for (std::size_t i = 0; i < 150; ++i) {
    scan.readings[i] = {Bssid{0xaabbccddee00 + i}, -61.25, 12345678us, 5180, 12.3456789, 1.23456789};
  }
  for (int i = 0; i < 60; ++i) ASSERT_TRUE(client->send(scan));
  client->start();
  far().encoding = Encoding::kJson;
  far().open();
  far().say(fresh());
  run(15);  // ScriptedLink checks the size of every frame
  EXPECT_EQ(far().sequences(), numbers(1, 60));
}

TEST_F(ClientStream, ReplaysFasterWhenTheServerKeepsUp) {
  make();
  for (int i = 0; i < 30; ++i) {
    for (int j = 0; j < 100; ++j) walk(1);
    run(1);
  }
  client->start();
  far().open();
  far().say(fresh());
  for (std::size_t acked = 0; acked < 3000; acked = far().sequences().back()) far().say(Ack{7, far().sequences().back()});
  EXPECT_EQ(far().sequences(), numbers(1, 3000));
}

TEST_F(ClientStream, KeepsWhatTheLinkDoesNotTake) {
  start_streaming();
  run(5);
  far().room = 0;
  walk(4);
  run(1);
  EXPECT_TRUE(far().sequences().empty());
  far().room = 100;
  run(1);
  EXPECT_EQ(far().sequences(), numbers(1, 4));
}

TEST_F(ClientStream, LeavesAServerThatAcknowledgesNothing) {
  start_streaming();
  for (int i = 0; i < 25; ++i) {
    walk(1);
    run(1);
    far().events.alive();
    if (i == 10) far().say(Ack{7, 5});
  }
  EXPECT_EQ(client->state(), kStreaming);  // 14 s since the last acknowledgement
  for (int i = 0; i < 8 && client->state() == kStreaming; ++i) {
    walk(1);
    run(1);
  }
  EXPECT_EQ(reasons.at(0), "samples are sent and none is acknowledged");
}

TEST_F(ClientStream, LeavesAServerThatOnlyEverAsksToWait) {
  start_streaming();
  int waits = 0;
  for (int i = 0; i < 59 && client->state() == kStreaming; ++i) {
    walk(1);
    run(1);
    far().events.alive();
    if (i % 10 != 9) continue;
    far().say(FaultReport{{FaultCode::kRateLimited, "", "too many"}, 0, {}, 1s});
    ++waits;
  }
  EXPECT_EQ(waits, 2);  // 20 s and the seconds it asked for, before the ring of 60 s runs over
  EXPECT_EQ(reasons.at(0), "samples are sent and none is acknowledged");
  EXPECT_TRUE(lost.empty());
}

TEST_F(ClientStream, SendsAgainWhatTheServerMissed) {
  start_streaming();
  walk(6);
  run(1);
  far().say(Ack{7, 2});
  far().say(FaultReport{{FaultCode::kSequenceGap, "samples[0].sequence", "5, expected 3"}, 5, {}, 0s});
  far().say(FaultReport{{FaultCode::kSequenceGap, "samples[0].sequence", "6, expected 3"}, 6, {}, 0s});
  run(2);
  auto expected = numbers(1, 6);
  for (std::uint64_t n : numbers(3, 6)) expected.push_back(n);
  EXPECT_EQ(far().sequences(), expected);
  EXPECT_EQ(faults.size(), 2u);
}

TEST_F(ClientStream, AGapThatNeverClosesBeginsANewSession) {
  start_streaming();
  walk(6);
  for (int i = 0; i < 4; ++i) {
    run(1.1);
    far().say(FaultReport{{FaultCode::kSequenceGap, "samples[0].sequence", "1, expected 0"}, 1, {}, 0s});
  }
  EXPECT_EQ(client->state(), kBackingOff);
  ASSERT_TRUE(wait_for_attempt());
  far().open();
  EXPECT_FALSE(far().all<Hello>().at(0).resume);
  far().say(fresh("s2"));
  run(1);
  EXPECT_EQ(far().sequences(), numbers(1, 6));
  EXPECT_TRUE(lost.empty());
}

TEST_F(ClientStream, WaitsWhenItIsTooFast) {
  start_streaming();
  walk(3);
  run(1);
  far().say(FaultReport{{FaultCode::kRateLimited, "", "too many"}, 0, {}, 7s});
  walk(3);
  run(6.9);
  EXPECT_EQ(far().sequences(), numbers(1, 3));
  run(0.2);
  EXPECT_EQ(far().sequences().size(), 9u);  // the refused ones once more, then the new ones
  EXPECT_EQ(far().sequences()[3], 1u);
}

TEST_F(ClientStream, SendsTheYoungestOfAListLongerThanAMessage) {
  start_streaming();
  RssScan crowded{clock.now(), {}};
  for (std::uint64_t i = 0; i < 600; ++i) crowded.readings.push_back({Bssid{i + 1}, -60, i < 88 ? 2s : 1s, 2412, {}, {}});
  ASSERT_TRUE(client->send(crowded));
  run(2);
  const auto batches = far().all<SampleBatch>();
  ASSERT_EQ(batches.size(), 1u);
  const auto& sent = std::get<RssScan>(batches[0].samples[0].body).readings;
  EXPECT_EQ(sent.size(), 512u);
  for (const ScanReading& reading : sent) EXPECT_EQ(reading.age, 1s);
}

TEST_F(ClientStream, RefusesWhatBreaksTheLimits) {
  start_streaming();
  MotionReport report = step();
  report.heading_sigma_rad = std::nan("");
  const auto refused = client->send(report);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.fault().code, FaultCode::kOutOfRange);
  EXPECT_NE(refused.fault().field.find("azimuth_sigma"), std::string::npos) << refused.fault().field;
  EXPECT_FALSE(client->send(GnssFix{clock.now(), {91, 0}, 1, {}, {}}));
  EXPECT_EQ(client->last_sequence(), 0u);
  EXPECT_FALSE(client->upload(SurveyBatch{"k", {}}));
  EXPECT_FALSE(client->subscribe({}));
}

TEST_F(ClientStream, TranslatesPositionsAndHandsTheTicketOn) {
  start_streaming();
  walk(2);
  run(1);
  Position position;
  position.applied_through = 2;
  position.position.building = BuildingId{1};
  position.position.floors = {{FloorOrdinal{0}, 1.0}};
  far().say(position);
  ASSERT_EQ(positions.size(), 1u);
  EXPECT_EQ(positions[0].applied_through, 2u);
  far().say(Ticket{"sealed", 2, 60s});
  const Hello hello = reconnect();
  ASSERT_TRUE(hello.resume);
  EXPECT_EQ(hello.resume->ticket, "sealed");
}

TEST_F(ClientStream, AWelcomeInMidStreamBringsNews) {
  start_streaming();
  walk(2);
  run(1);
  Welcome resolved = fresh();
  resolved.applied_through = 2;
  resolved.building_name = "resolved";
  far().say(resolved);
  EXPECT_EQ(client->state(), kStreaming);
  EXPECT_EQ(welcomes.back().building_name, "resolved");
  EXPECT_EQ(client->acked_through(), 2u);
}

}  // namespace
}  // namespace wayfuse
