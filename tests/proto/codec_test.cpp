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

TEST(Check, RefusesABatchWhoseNumbersJump) {
  SampleBatch batch{{{4, RssScan{}}, {6, RssScan{}}}};
  EXPECT_EQ(check(ClientMessage(batch)).fault(),
            (Fault{FaultCode::kOutOfRange, "samples", "the sample numbers are not consecutive"}));
  batch.samples[1].sequence = 5;
  EXPECT_TRUE(check(ClientMessage(batch)));
}

TEST(Check, FindsWhatNoClientWouldRead) {
  FusedPosition position;
  EXPECT_TRUE(check(position, "position"));
  position.speed_mps = 101.0;
  EXPECT_EQ(to_string(check(position, "position").fault()), "out_of_range: position.speed_mps: 101 is outside 0..100");
  position.speed_mps = 1.0;
  position.covariance.yy_m2 = std::nan("");
  EXPECT_EQ(check(position, "position").fault().field, "position.covariance.yy_m2");
}

// Half of the last digit written: 5e-7 in the wire's unit, so 5e-7 degrees for angles.
TEST(Codec, RoundsNumbersToTheSixthDecimalAndNotAgain) {
  Random random(13);
  for (int round = 0; round < 1000; ++round) {
    MotionReport motion;
    motion.heading = Heading::from_radians(6.0 * (random.uniform() - 0.5));
    motion.heading_sigma_rad = random.uniform();
    motion.turn_rate_radps = 10.0 * (random.uniform() - 0.5);
    motion.step_length_m = 3.0 * random.uniform();
    for (const Encoding encoding : kEncodings) {
      const auto once = decode_client_message(encode(ClientMessage(SampleBatch{{{1, motion}}}), encoding), encoding);
      ASSERT_TRUE(once) << to_string(once.fault());
      const auto& back = std::get<MotionReport>(std::get<SampleBatch>(*once).samples[0].body);
      constexpr double kHalfDigit_rad = 5.001e-7 / wire::kDegreesPerRadian;
      EXPECT_NEAR(back.heading.minus(motion.heading), 0.0, kHalfDigit_rad);
      EXPECT_NEAR(back.heading_sigma_rad, motion.heading_sigma_rad, kHalfDigit_rad);
      EXPECT_NEAR(back.turn_rate_radps, motion.turn_rate_radps, kHalfDigit_rad);
      EXPECT_NEAR(back.step_length_m, motion.step_length_m, 5.001e-7);
      EXPECT_EQ(*decode_client_message(encode(*once, encoding), encoding), *once);
    }
  }
}

// A compass points clockwise from north, and so does the rate of turning.
TEST(Codec, SpeaksCompassOnTheWire) {
  MotionReport motion;
  motion.heading = Heading::from_vector(0.0, -1.0);
  motion.turn_rate_radps = std::numbers::pi / 2;
  const std::string frame = encode(ClientMessage(SampleBatch{{{1, motion}}}), Encoding::kJson);
  const auto sample = nlohmann::json::parse(frame).at("samples").at(0);
  EXPECT_EQ(sample.at("azimuth_deg"), 180);
  EXPECT_EQ(sample.at("turn_rate_degps"), -90);
  motion.heading = Heading::from_azimuth(-1e-12);  // just left of north, and 360 rounded
  const std::string north = encode(ClientMessage(SampleBatch{{{1, motion}}}), Encoding::kJson);
  EXPECT_EQ(nlohmann::json::parse(north).at("samples").at(0).at("azimuth_deg"), 0);
}

// Whatever a store or an operating system said, the fault can be told.
TEST(Codec, MakesTheWordsOfAFaultFitTheWire) {
  const FaultReport report{
      {FaultCode::kStorageFailed, "a\nb", "disk \xff says \"no\"\x01" + std::string(5000, 'x')}, 0, "", {}};
  for (const Encoding encoding : kEncodings) {
    const auto back = decode_server_message(encode(ServerMessage(report), encoding), encoding);
    ASSERT_TRUE(back) << to_string(back.fault());
    const Fault& fault = std::get<FaultReport>(*back).fault;
    EXPECT_EQ(fault.field, "a?b");
    EXPECT_TRUE(fault.cause.starts_with("disk ? says \"no\"?xxx"));
    EXPECT_EQ(fault.cause.size(), Limits::kCauseBytes);
  }
}

TEST(Codec, KeepsANumberOfAFaultItDoesNotKnow) {
  const auto back =
      decode_server_message(R"({"type":"fault","fault":{"code":777,"name":"of_tomorrow","cause":"?"}})", Encoding::kJson);
  ASSERT_TRUE(back) << to_string(back.fault());
  const FaultCode code = std::get<FaultReport>(*back).fault.code;
  EXPECT_EQ(static_cast<int>(code), 777);
  EXPECT_EQ(face_of(code).code, FaultCode::kInternal);
}

TEST(Codec, CarriesATicketOfTheFullSize) {
  Ticket ticket;
  for (std::size_t i = 0; i < Limits::kTicketBytes; ++i) ticket.sealed += static_cast<char>(i * 7);
  for (const Encoding encoding : kEncodings) {
    const std::string frame = encode(ServerMessage(ticket), encoding);
    EXPECT_LE(frame.size(), Limits::kMessageBytes);
    const auto back = decode_server_message(frame, encoding);
    ASSERT_TRUE(back) << to_string(back.fault());
    EXPECT_EQ(std::get<Ticket>(*back), ticket);
  }
}

}  // namespace
}  // namespace wayfuse
