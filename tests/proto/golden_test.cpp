#include "tests/proto/golden.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "proto/src/wire/message_fields.hpp"

namespace wayfuse {
namespace {

using nlohmann::json;

template <typename... Alternatives>
std::set<std::string> names_of(const std::variant<Alternatives...>*) {
  return {std::string(wire::kWireName<Alternatives>)...};
}

TEST(Golden, EveryMessageHasADocument) {
  std::set<std::string> types;
  for (const Golden& golden : golden_documents()) types.insert(json::parse(golden.text).at("type"));
  std::set<std::string> wanted = names_of(static_cast<ClientMessage*>(nullptr));
  wanted.merge(names_of(static_cast<ServerMessage*>(nullptr)));
  EXPECT_EQ(types, wanted);
}

TEST(Golden, SurvivesJsonThereAndBack) {
  for (const Golden& golden : golden_documents()) {
    const auto again = round_trip(golden.text, Encoding::kJson, Encoding::kJson, golden.from_client);
    ASSERT_TRUE(again) << golden.name << ": " << to_string(again.fault());
    EXPECT_EQ(json::parse(*again), json::parse(golden.text)) << golden.name;
  }
}

TEST(Golden, SurvivesCborThereAndBack) {
  for (const Golden& golden : golden_documents()) {
    const auto binary = round_trip(golden.text, Encoding::kJson, Encoding::kCbor, golden.from_client);
    ASSERT_TRUE(binary) << golden.name << ": " << to_string(binary.fault());
    EXPECT_LT(binary->size(), golden.text.size()) << golden.name;
    const auto again = round_trip(*binary, Encoding::kCbor, Encoding::kJson, golden.from_client);
    ASSERT_TRUE(again) << golden.name << ": " << to_string(again.fault());
    EXPECT_EQ(json::parse(*again), json::parse(golden.text)) << golden.name;
  }
}

// A foreign encoder spells numbers as doubles, addresses and bytes as texts.
TEST(Golden, IsReadFromAForeignCborEncoder) {
  for (const Golden& golden : golden_documents()) {
    const std::vector<std::uint8_t> foreign = json::to_cbor(json::parse(golden.text));
    const auto again =
        round_trip(std::string(foreign.begin(), foreign.end()), Encoding::kCbor, Encoding::kJson, golden.from_client);
    ASSERT_TRUE(again) << golden.name << ": " << to_string(again.fault());
    EXPECT_EQ(json::parse(*again), json::parse(golden.text)) << golden.name;
  }
}

// A newer peer of the same version may say more.
json with_unknown_fields(const json& value) {
  if (value.is_array()) {
    json list = json::array();
    for (const json& element : value) list.push_back(with_unknown_fields(element));
    return list;
  }
  if (!value.is_object()) return value;
  json map = {{"a_new_field", {1, "two", nullptr, -1e300}}, {"zz", false}};
  for (const auto& [key, element] : value.items()) map[key] = with_unknown_fields(element);
  return map;
}

TEST(Golden, IgnoresFieldsOfALaterRevision) {
  for (const Golden& golden : golden_documents()) {
    const json extended = with_unknown_fields(json::parse(golden.text));
    const auto again = round_trip(extended.dump(), Encoding::kJson, Encoding::kJson, golden.from_client);
    ASSERT_TRUE(again) << golden.name << ": " << to_string(again.fault());
    EXPECT_EQ(json::parse(*again), json::parse(golden.text)) << golden.name;
  }
}

// null and absent mean the same: an optional field may be null, a required one may not.
void null_in_turn(const Golden& golden, const json& whole, const json::json_pointer& at, const json& here) {
  for (const auto& [key, value] : here.items()) {
    const json::json_pointer inner = here.is_array() ? at / static_cast<std::size_t>(std::stoul(key)) : at / key;
    if (value.is_structured()) null_in_turn(golden, whole, inner, value);
    if (!here.is_object()) continue;
    json nulled = whole;
    nulled[inner] = nullptr;
    json absent = whole;
    absent[at].erase(key);
    const auto with_null = round_trip(nulled.dump(), Encoding::kJson, Encoding::kJson, golden.from_client);
    const auto without = round_trip(absent.dump(), Encoding::kJson, Encoding::kJson, golden.from_client);
    ASSERT_EQ(with_null.has_value(), without.has_value()) << golden.name << ' ' << inner;
    if (without) {
      EXPECT_EQ(*with_null, *without) << golden.name << ' ' << inner;
    } else {
      EXPECT_EQ(with_null.fault(), without.fault());
      EXPECT_EQ(without.fault().code, FaultCode::kMissingField) << golden.name << ' ' << inner << to_string(without.fault());
      EXPECT_TRUE(without.fault().field.ends_with(key)) << inner << ' ' << to_string(without.fault());
    }
  }
}

TEST(Golden, TakesNullAsAbsent) {
  for (const Golden& golden : golden_documents()) {
    const json whole = json::parse(golden.text);
    null_in_turn(golden, whole, json::json_pointer(), whole);
  }
}

}  // namespace
}  // namespace wayfuse
