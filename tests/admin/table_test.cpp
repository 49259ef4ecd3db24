#include <gtest/gtest.h>

#include "admin/cli/table.hpp"

namespace wayfuse::cli {
namespace {

TEST(Table, AlignsColumnsByCharactersNotBytes) {
  EXPECT_EQ(table({"id", "name", "x"}, {{"1", "Höf", "a"}, {"22", "Annex", "b"}}),
            "id  name   x\n"
            "1   Höf    a\n"
            "22  Annex  b\n");
}

TEST(Table, ShowsAListAsRowsAndTheRestAsJson) {
  EXPECT_EQ(readable(R"({"keys":[{"id":1,"scopes":["track","survey"]}]})", "keys", {"id", "scopes", "name"}),
            "id  scopes        name\n"
            "1   track,survey  -\n");
  EXPECT_EQ(readable(R"({"ready":true})", "", {}), "{\n  \"ready\": true\n}\n");
  EXPECT_EQ(readable("not json", "", {}), "not json\n");
}

}  // namespace
}  // namespace wayfuse::cli
