#include "server/pipeline/pipeline_spec.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "server/pipeline/tracker.hpp"

namespace wayfuse {
namespace {

using testing::HasSubstr;

Fault fault_of(std::string_view json) {
  auto spec = parse_pipeline(json);
  if (spec) {
    auto assembled = assemble(*spec, std::make_shared<Site>());
    EXPECT_FALSE(assembled);
    return assembled ? Fault{} : assembled.fault();
  }
  return spec.fault();
}

TEST(Presets, AllParseAndAssembleAndSurviveAJsonRoundTrip) {
  for (const auto& name : preset_names()) {
    const auto spec = preset(name);
    ASSERT_TRUE(spec) << name << ": " << to_string(spec.fault());
    EXPECT_EQ(spec->name, name);
    const auto again = parse_pipeline(to_json(*spec));
    ASSERT_TRUE(again) << name;
    EXPECT_EQ(*again, *spec);
    const auto assembled = assemble(*spec, std::make_shared<Site>());
    EXPECT_TRUE(assembled) << name << ": " << to_string(assembled.fault());
  }
}

TEST(Presets, AnUnknownOneListsTheKnown) {
  const auto spec = preset("p9");
  ASSERT_FALSE(spec);
  EXPECT_EQ(spec.fault().code, FaultCode::kUnknownName);
  EXPECT_THAT(spec.fault().cause, HasSubstr("p1"));
  EXPECT_THAT(spec.fault().cause, HasSubstr("dead-reckoning"));
}

TEST(ParsePipeline, NamesFieldAndCauseAndWhatIsKnown) {
  struct Row {
    const char* json;
    FaultCode code;
    const char* field;
    const char* cause;
  };
  const Row rows[] = {
      {"{", FaultCode::kMalformed, "", "a key in quotes is expected"},
      {R"({"parts": {"locator": {"part": "wknn", "settings": {"k": 1e999}}}})", FaultCode::kMalformed, "", "not JSON"},
      {R"({"parts": {}, "parts": {"locator": "wknn"}})", FaultCode::kDuplicateField, "", "'parts' stands twice"},
      {R"({"parts": {"locator": "nn", "locator": "wknn"}})", FaultCode::kDuplicateField, "parts", "'locator' stands twice"},
      {R"({"parts": {"locator": {"part": "wknn", "settings": {"k": 1, "exponent": 1, "k": 4}}}})", FaultCode::kDuplicateField,
       "parts.locator.settings", "'k' stands twice"},
      {"[]", FaultCode::kWrongType, "", "not an object"},
      {"{}", FaultCode::kMissingField, "parts", "names its parts"},
      {R"({"parts": 3})", FaultCode::kWrongType, "parts", "not an object"},
      {R"({"parts": {}, "colour": 1})", FaultCode::kUnknownName, "colour", "known: name, parts"},
      {R"({"parts": {"locater": "wknn"}})", FaultCode::kUnknownName, "parts.locater", "locator"},
      {R"({"parts": {"locator": "wknm"}})", FaultCode::kUnknownName, "parts.locator.part", "wknn"},
      {R"({"parts": {"locator": {"settings": {}}}})", FaultCode::kMissingField, "parts.locator.part", "needed"},
      {R"({"parts": {"locator": {"part": "wknn", "settings": {"kk": 1}}}})", FaultCode::kUnknownName, "parts.locator.settings.kk",
       "k (1..64)"},
      {R"({"parts": {"locator": {"part": "wknn", "settings": {"k": 65}}}})", FaultCode::kOutOfRange, "parts.locator.settings.k",
       "65 is outside 1..64"},
      {R"({"parts": {"locator": {"part": "wknn", "settings": {"k": 2.5}}}})", FaultCode::kOutOfRange, "parts.locator.settings.k",
       "whole"},
      {R"({"parts": {"locator": {"part": "wknn", "settings": {"k": "4"}}}})", FaultCode::kWrongType, "parts.locator.settings.k",
       "not a number"},
      {R"({"parts": {"measurement": "fix"}})", FaultCode::kConflict, "parts.measurement", "needs a locator"},
  };
  for (const Row& row : rows) {
    const Fault fault = fault_of(row.json);
    EXPECT_EQ(fault.code, row.code) << row.json << " -> " << to_string(fault);
    EXPECT_EQ(fault.field, row.field) << row.json;
    EXPECT_THAT(fault.cause, HasSubstr(row.cause)) << row.json;
  }
}

TEST(PartCatalogue, DescribesEverySettingWithADefaultInsideItsRange) {
  for (const auto& part : part_catalogue()) {
    EXPECT_FALSE(part.summary.empty()) << part.name;
    for (const auto& setting : part.settings) {
      EXPECT_LE(setting.least, setting.standard) << part.name << "." << setting.name;
      EXPECT_LE(setting.standard, setting.most) << part.name << "." << setting.name;
      EXPECT_FALSE(setting.meaning.empty()) << part.name << "." << setting.name;
    }
  }
}

TEST(PartCatalogue, NamesEachPartOnceWithinItsRoleAndEachSettingOnceWithinItsPart) {
  std::set<std::pair<std::string, std::string>> parts;
  for (const auto& part : part_catalogue()) {
    EXPECT_TRUE(parts.emplace(part.role, part.name).second) << part.role << " " << part.name;
    std::set<std::string> settings;
    for (const auto& setting : part.settings) EXPECT_TRUE(settings.insert(setting.name).second) << part.name << "." << setting.name;
  }
}

}  // namespace
}  // namespace wayfuse
