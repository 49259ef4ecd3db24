#include "wayfuse/proto/codec.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/proto/random_message.hpp"

namespace wayfuse {
namespace {

constexpr Encoding kEncodings[] = {Encoding::kJson, Encoding::kCbor};

template <typename Message>
Result<Message> decode(std::string_view frame, Encoding encoding) {
  if constexpr (std::is_same_v<Message, ClientMessage>) {
    return decode_client_message(frame, encoding);
  } else {
    return decode_server_message(frame, encoding);
  }
}

template <typename Message>
void every_message_round_trips() {
  Random random(11);
  for (int round = 0; round < 300; ++round) {
    for (std::size_t kind = 0; kind < std::variant_size_v<Message>; ++kind) {
      const Message message = RandomFiller(random).message<Message>(kind);
      const Result<void> checked = check(message);
      ASSERT_TRUE(checked) << to_string(checked.fault());
      for (const Encoding encoding : kEncodings) {
        const std::string frame = encode(message, encoding);
        const Result<Message> back = decode<Message>(frame, encoding);
        ASSERT_TRUE(back) << to_string(back.fault()) << '\n' << (encoding == Encoding::kJson ? frame : "");
        ASSERT_TRUE(*back == message) << encode(message, Encoding::kJson) << '\n' << encode(*back, Encoding::kJson);
      }
    }
  }
}

TEST(Codec, BringsEveryClientMessageBack) {
  every_message_round_trips<ClientMessage>();
}
TEST(Codec, BringsEveryServerMessageBack) {
  every_message_round_trips<ServerMessage>();
}

TEST(Codec, SpellsTheSameMapInBothEncodings) {
  // An independent reader sees the same names and numbers; addresses and sealed bytes differ by design.
  Random random(12);
  for (std::size_t kind = 0; kind < std::variant_size_v<ServerMessage>; ++kind) {
    const ServerMessage message = RandomFiller(random).message<ServerMessage>(kind);
    if (std::holds_alternative<Ticket>(message)) continue;
    EXPECT_EQ(nlohmann::json::parse(encode(message, Encoding::kJson)),
              nlohmann::json::from_cbor(encode(message, Encoding::kCbor)));
  }
}

TEST(Codec, NamesTheSubprotocols) {
  for (const Encoding encoding : kEncodings) EXPECT_EQ(encoding_of(subprotocol(encoding)), encoding);
  EXPECT_FALSE(encoding_of("wayfuse.v2.json"));
}

TEST(Codec, SaysWhichReadingIsWrong) {
  const auto fault =
      decode_client_message(R"({"type":"samples","first_sequence":1,"samples":[{"kind":"scan","time_us":5,"readings":[)"
                            R"({"bssid":"aa:bb:cc:dd:ee:ff","rss_dbm":-50},{"bssid":"aa:bb:cc:dd:ee:fe","rss_dbm":-312}]}]})",
                            Encoding::kJson)
          .fault();
  EXPECT_EQ(to_string(fault), "out_of_range: samples[0].readings[1].rss_dbm: -312 is outside -120..0");
}

TEST(Codec, NumbersTheSamplesOfABatch) {
  const auto message = decode_client_message(
      R"({"samples":[{"kind":"scan","time_us":5,"readings":[]},{"kind":"scan","time_us":6,"readings":[]}],)"
      R"("first_sequence":41,"type":"samples"})",
      Encoding::kJson);
  ASSERT_TRUE(message) << to_string(message.fault());
  const auto& samples = std::get<SampleBatch>(*message).samples;
  EXPECT_EQ(samples[0].sequence, 41u);
  EXPECT_EQ(samples[1].sequence, 42u);
}

TEST(Check, UsesTheSameGatesAndTheCallersPath) {
  MotionReport motion;
  EXPECT_TRUE(check(motion, "motion"));
  motion.heading = Heading::from_radians(std::nan(""));
  EXPECT_EQ(check(motion, "motion").fault().field, "motion.azimuth_deg");
  RssScan scan;
  scan.readings.resize(513);
  EXPECT_EQ(check(scan, "scan").fault().code, FaultCode::kTooLarge);
  ReferencePoint point;
  EXPECT_EQ(check(point, "points[2]").fault(), (Fault{FaultCode::kOutOfRange, "points[2].scans", "0 elements, at least 1"}));
}

}  // namespace
}  // namespace wayfuse
