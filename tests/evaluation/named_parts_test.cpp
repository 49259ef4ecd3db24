#include "tests/evaluation/named_parts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <vector>

#include "tests/fixtures/scratch_folder.hpp"

namespace wayfuse {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

std::string locator_fault(const std::string& text) {
  const auto locator = locator_named(text);
  return locator ? "no fault" : to_string(locator.fault());
}

TEST(LocatorNamed, IsARowWithSettingsChanged) {
  const auto changed = locator_named("knn:k=5,floor_dbm=-105");
  ASSERT_TRUE(changed) << to_string(changed.fault());
  EXPECT_EQ(changed->first->description.name, "knn");
  EXPECT_EQ(changed->second.count("k"), 5);
  EXPECT_EQ(changed->second["floor_dbm"], -105.0);
  EXPECT_EQ(changed->second["exponent"], 2.0) << "as the row says";
  EXPECT_EQ(locator_named("radio-field:learn=0")->second["learn"], 0.0);
  for (const LocatorRow& row : locator_catalogue()) EXPECT_EQ(locator_named(row.description.name).has_value(), row.prepare != nullptr);
}

TEST(LocatorNamed, AnUnknownOneListsThoseThatLocate) {
  EXPECT_THAT(locator_fault("wknm"), AllOf(HasSubstr("no such locator `wknm`; known: nn, knn"), Not(HasSubstr("spaces"))));
  EXPECT_THAT(locator_fault("none"), AllOf(HasSubstr("known: nn, knn"), Not(HasSubstr("none,"))));
}

TEST(LocatorNamed, AFaultSaysWhichLocatorsSettingIsWrong) {
  EXPECT_THAT(locator_fault("wknn:k=65"), HasSubstr("locators.wknn.k: 65 is outside 1..64"));
  EXPECT_THAT(locator_fault("wknn:kk=5"), HasSubstr("locators.wknn.kk: no such setting; known: k (1..64)"));
  EXPECT_THAT(locator_fault("wknn:k=nan"), HasSubstr("locators.wknn.k: nan is outside"));
}

TEST(LocatorNamed, ASettingNeedsANumber) {
  for (const char* text : {"learn=", "learn=off", "learn=0x", "=1", "learn"}) {
    EXPECT_THAT(locator_fault(std::string("radio-field:") + text), EndsWith("malformed: locators.radio-field: `" + std::string(text) + "` is not setting=number"));
  }
  EXPECT_THAT(locator_fault("knn:"), EndsWith("`` is not setting=number"));
  EXPECT_THAT(locator_fault("knn:k=5,"), EndsWith("`` is not setting=number"));
}

TEST(LocatorNamed, ASettingGivenTwiceIsRefused) {
  EXPECT_EQ(locator_fault("knn:k=5,k=6"), "duplicate_field: locators.knn.k: stands twice");
}

TEST(LocatorNamed, CommasBetweenLocatorsAreToldApart) {
  for (const char* text : {"wknn,knn:k=5", "knn:k=5,wknn", "knn:k=5,wknn:k=3"}) EXPECT_THAT(locator_fault(text), HasSubstr("locators are separated by spaces")) << text;
}

std::string pipeline_fault(const std::string& name) {
  const auto spec = pipeline_named(name);
  return spec ? "no fault" : to_string(spec.fault());
}

std::string check_fault(const std::vector<std::string>& names, AskedOf asked) {
  const auto checked = check_pipelines(names, asked);
  return checked ? "no fault" : to_string(checked.fault());
}

TEST(PipelineNamed, IsAPresetWithSettingsChanged) {
  const auto changed = pipeline_named("default:filter.particles=300+locator.learn=0");
  ASSERT_TRUE(changed) << to_string(changed.fault());
  EXPECT_EQ(changed->parts.at("filter").settings.at("particles"), 300.0);
  EXPECT_EQ(changed->parts.at("locator").settings.at("learn"), 0.0);
  EXPECT_EQ(changed->parts.at("filter").name, preset("default")->parts.at("filter").name);
  EXPECT_TRUE(preset("default")->parts.at("filter").settings.empty()) << "the preset itself stays";
  EXPECT_TRUE(pipeline_named("p1"));
}

TEST(PipelineNamed, WhatCannotBeMeantIsAFaultThatNamesIt) {
  for (const char* change : {"filter.particles=many", "filter.particles=", "filter.particles", "particles=3", "resampler.threshold=1", ""}) {
    const std::string name = std::string("default:") + change;
    EXPECT_EQ(pipeline_fault(name), "malformed: " + name + ": `" + change + "` is not role.setting=number of a role the preset fills: filter, locator");
  }
  EXPECT_THAT(pipeline_fault("default:filter.particles=-1"), HasSubstr("default:filter.particles=-1: parts.filter.settings.particles: -1 is outside"));
  EXPECT_THAT(pipeline_fault("defualt:filter.particles=3"), HasSubstr("no such preset `defualt`; known: p1"));
  EXPECT_THAT(pipeline_fault("defualt"), HasSubstr("no such preset `defualt`; known: p1"));
}

TEST(PipelineNamed, ASettingGivenTwiceIsRefused) {
  EXPECT_THAT(pipeline_fault("default:locator.learn=0+locator.learn=1"), HasSubstr("duplicate_field: default:locator.learn=0+locator.learn=1: `locator.learn` stands twice"));
}

TEST(PipelineNamed, AFilesFaultNamesTheFile) {
  const ScratchFolder folder;
  const std::string path = (folder.path() / "mine.json").string();
  EXPECT_EQ(pipeline_fault(path), "not_found: " + path + ": cannot be read");
  const auto written = [&](const char* json) {
    std::ofstream(path) << json;
    return check_fault({"wknn", path}, AskedOf::kPipelines);
  };
  EXPECT_THAT(written("{"), HasSubstr("malformed: " + path + ": byte 1: the message ends"));
  EXPECT_THAT(written(R"({"parts": {"locator": "wknm"}})"), HasSubstr(path + ": parts.locator.part: no such part `wknm`"));
  EXPECT_THAT(written(R"({"parts": {"measurement": "fix"}})"), HasSubstr(path + ": parts.measurement: `fix` needs a locator"));
  EXPECT_EQ(written(R"({"name": "mine", "parts": {"locator": {"part": "knn", "settings": {"k": 5}}, "measurement": {"part": "fix"}, "motion": {"part": "steps"}}})"), "no fault");
}

TEST(CheckPipelines, ASessionKnowsPresetsOnly) {
  EXPECT_EQ(check_fault({"p1", "dead-reckoning", "default"}, AskedOf::kSessions), "no fault");
  EXPECT_THAT(check_fault({"p1", "p9"}, AskedOf::kSessions), HasSubstr("no such preset `p9`; known: p1"));
  for (const std::string name : {"mine.json", "default:locator.learn=0"}) {
    EXPECT_THAT(check_fault({"p1", name}, AskedOf::kSessions), AllOf(HasSubstr(name + ": "), EndsWith("it needs --direct")));
  }
  EXPECT_EQ(check_fault({"p1", "default:locator.learn=0"}, AskedOf::kPipelines), "no fault");
}

}  // namespace
}  // namespace wayfuse
