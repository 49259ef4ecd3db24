#include "tests/evaluation/named_parts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace wayfuse
