#include "admin/cli/completion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

namespace wayfuse::cli {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class Completion : public testing::Test {
 protected:
  Completion() {
    app.add_option("--server", text);
    app.add_flag("--json", flag);
    auto* key = app.add_subcommand("key", "");
    auto* create = key->add_subcommand("create", "");
    create->add_option("NAME", text)->required();
    create->add_option("--scope", text)->check(CLI::IsMember({"survey", "track"}));
    key->add_subcommand("list", "");
    app.add_subcommand("keep", "");
  }
  std::vector<std::string> after(const std::vector<std::string>& words) const { return completions(app, words); }

  CLI::App app;
  std::string text;
  bool flag = false;
};

TEST_F(Completion, CommandsFollowCommands) {
  EXPECT_THAT(after({""}), ElementsAre("keep", "key"));
  EXPECT_THAT(after({"key", ""}), ElementsAre("create", "list"));
  EXPECT_THAT(after({"key", "c"}), ElementsAre("create"));
  EXPECT_THAT(after({}), ElementsAre("keep", "key"));
}

TEST_F(Completion, AnOptionsValueIsNoCommand) {
  EXPECT_THAT(after({"--server", "key", "ke"}), ElementsAre("keep", "key"));
  EXPECT_THAT(after({"--json", "key", ""}), ElementsAre("create", "list"));
}

TEST_F(Completion, FlagsOfTheCommandAndOfThoseAboveIt) {
  EXPECT_THAT(after({"key", "create", "--s"}), ElementsAre("--scope", "--server"));
}

TEST_F(Completion, ValuesWhereAnOptionNamesThem) {
  EXPECT_THAT(after({"key", "create", "x", "--scope", ""}), ElementsAre("survey", "track"));
  EXPECT_THAT(after({"key", "create", "x", "--scope", "t"}), ElementsAre("track"));
}

TEST_F(Completion, NothingWhereAFileOrFreeTextStands) {
  EXPECT_THAT(after({"--server", ""}), IsEmpty());
  EXPECT_THAT(after({"key", "create", ""}), IsEmpty());
}

}  // namespace
}  // namespace wayfuse::cli
