// The texts of other modules name settings. The program shows the options instead.

#include <gtest/gtest.h>

#include "app/options/table.h"
#include "support/program.h"

namespace binosplat {
namespace {

using app::with_options;

TEST(WithOptions, ReplacesNamesInBackticks) {
  EXPECT_EQ(with_options("a smaller `size`, `max_memory` MB or `quality` 40"),
            "a smaller --size, --max-memory MB or --quality 40");
  EXPECT_EQ(with_options("`background` 1,1,1 draws it so"), "--background 1,1,1 draws it so");
  EXPECT_EQ(with_options("as `binosplat trim` and `size`"), "as `binosplat trim` and --size");
  EXPECT_EQ(with_options("``size```size`"), "`--size`--size");
}

TEST(WithOptions, KeepsOtherWords) {
  for (const std::string text :
       {"", "`", "``", "a `size", "size", "`Size`", "`sizes`", "`size 3`", "`--size`", "`scene`", "`SCENE`",
        "`binosplat bench`", "`ns-export cameras`", "`s\nize`", "\xff`\xff`"})
    EXPECT_EQ(with_options(text), text);
}

// Some options have the name of a command.
TEST(WithOptions, KeepsCommands) {
  const std::string help = test::run_program({"--help"}).out;
  app::Options unused;
  int commands = 0;
  for (const app::Row& row : app::option_table(unused)) {
    if (!row.word().starts_with("--")) continue;
    const std::string name = row.word().substr(2), text = "`" + name + "`";
    const bool is_command = help.find("\n  " + name + " ") != std::string::npos;
    commands += is_command ? 1 : 0;
    EXPECT_EQ(with_options(text), is_command ? text : row.word());
  }
  EXPECT_GT(commands, 3);
}

}  // namespace
}  // namespace binosplat
