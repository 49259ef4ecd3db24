#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "proto/src/wire/text.hpp"
#include "tests/proto/golden.hpp"
#include "tests/proto/hostile_table.hpp"
#include "wayfuse/proto/random.hpp"

namespace wayfuse {
namespace {

using nlohmann::json;

// In a heap block of exactly its size, so that a sanitizer sees a read beyond the end.
Result<std::string> decoded(const std::string& frame, Encoding encoding, bool from_client) {
  const auto exact = std::make_unique<char[]>(frame.size());
  std::ranges::copy(frame, exact.get());
  const std::string_view view(exact.get(), frame.size());
  if (from_client) {
    const auto message = decode_client_message(view, encoding);
    if (!message) return message.fault();
    return encode(*message, Encoding::kJson);
  }
  const auto message = decode_server_message(view, encoding);
  if (!message) return message.fault();
  return encode(*message, Encoding::kJson);
}

// Words a person can read, whatever was sent.
void expect_presentable(const Fault& fault, const std::string& where) {
  const std::string text = to_string(fault);
  EXPECT_FALSE(fault.cause.empty()) << where;
  EXPECT_LE(text.size(), 1024u) << where;
  EXPECT_TRUE(wire::is_utf8(text) && !wire::has_controls(text)) << where << ' ' << text;
}

void expect_as_tabled(const HostileCase& row, Encoding encoding) {
  const Result<std::string> result = decoded(row.frame, encoding, row.from_client);
  if (row.expected == "ok") {
    EXPECT_TRUE(result) << row.where << ' ' << to_string(result.fault());
    return;
  }
  ASSERT_FALSE(result) << row.where << " was accepted as " << *result;
  EXPECT_EQ(face_of(result.fault().code).name, row.expected) << row.where << ' ' << to_string(result.fault());
  const bool knows_where = result.fault().code != FaultCode::kMalformed;  // which names the byte instead
  EXPECT_TRUE(!knows_where || result.fault().field.starts_with(row.field)) << row.where << ' ' << to_string(result.fault());
  expect_presentable(result.fault(), row.where);
}

TEST(Hostile, JsonFramesGetTheirFault) {
  const auto rows = hostile_cases("hostile_json.txt", false);
  EXPECT_GE(rows.size(), 200u);
  for (const HostileCase& row : rows) expect_as_tabled(row, Encoding::kJson);
}

TEST(Hostile, CborFramesGetTheirFault) {
  const auto rows = hostile_cases("hostile_cbor.txt", true);
  EXPECT_GE(rows.size(), 200u);
  for (const HostileCase& row : rows) expect_as_tabled(row, Encoding::kCbor);
}

TEST(Hostile, EveryFieldRefusesWhatItsRowSays) {
  const auto rows = hostile_cases("hostile_fields.txt", false);
  EXPECT_GE(rows.size(), 2000u);
  std::size_t in_cbor = 0;
  for (const HostileCase& row : rows) {
    expect_as_tabled(row, Encoding::kJson);
    // The same value said in CBOR gets the same answer, where an independent reader can say it.
    const json document = json::parse(row.frame, nullptr, false);
    if (document.is_discarded()) continue;
    HostileCase binary = row;
    const std::vector<std::uint8_t> bytes = json::to_cbor(document);
    binary.frame.assign(bytes.begin(), bytes.end());
    if (binary.frame.size() > Limits::kMessageBytes) continue;
    expect_as_tabled(binary, Encoding::kCbor);
    ++in_cbor;
  }
  EXPECT_GE(in_cbor, 1500u);
}

// What an independent strict reader takes as JSON, ours takes too, and the other way round: over mutated documents.
TEST(Hostile, AgreesWithAnotherReaderOnWhatIsJson) {
  Random random(21);
  const auto goldens = golden_documents();
  int refused = 0;
  for (int round = 0; round < 20000; ++round) {
    const Golden& golden = goldens[random.below(goldens.size())];
    std::string text = golden.text;
    for (std::uint64_t edits = 1 + random.below(2); edits > 0; --edits) {
      const std::size_t at = random.below(text.size());
      static constexpr std::string_view kBytes = "{}[]\",:\\ 0123456789-+.eEtrufalsn\n\x01\xc3\xa9";
      const char byte = kBytes[random.below(kBytes.size())];
      switch (random.below(3)) {
        case 0:
          text[at] = byte;
          break;
        case 1:
          text.insert(at, 1, byte);
          break;
        default:
          text.erase(at, 1);
      }
    }
    const Result<std::string> result = decoded(text, Encoding::kJson, golden.from_client);
    const bool grammatical = json::accept(text);
    if (!grammatical) ++refused;
    if (!grammatical) {
      ASSERT_FALSE(result) << text;
    } else if (!result) {
      EXPECT_NE(result.fault().code, FaultCode::kMalformed) << text << to_string(result.fault());
    }
  }
  EXPECT_GT(refused, 1000);
}

TEST(Hostile, EveryTruncationIsRefused) {
  for (const Golden& golden : golden_documents()) {
    for (const Encoding encoding : {Encoding::kJson, Encoding::kCbor}) {
      const std::string frame = *round_trip(golden.text, Encoding::kJson, encoding, golden.from_client);
      for (std::size_t length = 0; length < frame.size(); ++length) {
        const auto result = decoded(frame.substr(0, length), encoding, golden.from_client);
        ASSERT_FALSE(result) << golden.name << " cut at " << length;
        EXPECT_EQ(result.fault().code, FaultCode::kMalformed) << golden.name << " cut at " << length;
      }
    }
  }
}

TEST(Hostile, EveryFlippedBitIsAMessageOrAFault) {
  std::size_t flips = 0;
  for (const Golden& golden : golden_documents()) {
    for (const Encoding encoding : {Encoding::kJson, Encoding::kCbor}) {
      std::string frame = *round_trip(golden.text, Encoding::kJson, encoding, golden.from_client);
      for (std::size_t bit = 0; bit < frame.size() * 8; ++bit) {
        frame[bit / 8] = static_cast<char>(frame[bit / 8] ^ (1 << bit % 8));
        const auto result = decoded(frame, encoding, golden.from_client);
        if (!result) expect_presentable(result.fault(), golden.name);
        frame[bit / 8] = static_cast<char>(frame[bit / 8] ^ (1 << bit % 8));
        ++flips;
      }
    }
  }
  EXPECT_GT(flips, 50000u);
}

}  // namespace
}  // namespace wayfuse
