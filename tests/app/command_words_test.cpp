// --print man|bash|fish|zsh: what the help says, for man and for shells.

#include <regex>

#include "app/scene.h"

namespace binosplat {
namespace {

using test::good;
using test::has;
using test::run_program;

std::string printed(const char* what) {
  const test::Outcome outcome = run_program({"--print", what});
  EXPECT_TRUE(good(outcome));
  return outcome.out;
}

/// The long options that a sub-command's help lists.
std::set<std::string> options_of(const char* command) {
  const std::string help = run_program({command, "--help"}).out;
  std::set<std::string> options;
  static const std::regex option(R"((^|\n)  (?:-\w,)?(--[a-z0-9-]+))");
  for (std::sregex_iterator at(help.begin(), help.end(), option), end; at != end; ++at)
    options.insert((*at)[2]);
  return options;
}

std::string in_roff(const std::string& option) {
  return std::regex_replace(option, std::regex("-"), R"(\-)");
}

TEST(CommandWords, HaveEveryOption) {
  const std::string man = printed("man"), bash = printed("bash"), fish = printed("fish"),
                    zsh = printed("zsh");
  for (const char* command : {"render", "compare", "trim", "study", "bench"}) {
    const std::size_t begin = man.find(std::string(".SH binosplat ") + command);
    ASSERT_NE(begin, std::string::npos) << command;
    const std::string page = man.substr(begin, man.find(".SH", begin + 1) - begin);
    const std::size_t row = bash.find(std::string("[") + command + "]=");
    const std::string words = bash.substr(row, bash.find('\n', row) - row);
    const std::size_t part = zsh.find(std::string("    ") + command + ")\n");
    const std::string of_zsh = zsh.substr(part, zsh.find(";;", part) - part);
    const std::set<std::string> options = options_of(command);
    EXPECT_GT(options.size(), 5u) << command;
    for (const std::string& option : options) {
      EXPECT_TRUE(has(page, in_roff(option))) << command << " " << option;
      EXPECT_TRUE(has(words, option)) << command << " " << option;
      EXPECT_TRUE(has(of_zsh, "'" + option + "[")) << command << " " << option;
      EXPECT_TRUE(has(fish, "-l " + option.substr(2) + " ")) << command << " " << option;
    }
    EXPECT_FALSE(has(page, in_roff("--no-such-option")));
  }
  EXPECT_TRUE(has(man.substr(man.find(".SH binosplat view")), in_roff("--convergence")))
      << "the preview's, a program of its own";
}

TEST(CommandWords, CompleteInBash) {
  const test::TempFolder folder;
  test::write_text(folder / "words.bash", printed("bash"));
  const auto completed = [&](const std::string& words) {
    const std::string script = "source " + (folder / "words.bash").string() + "; COMP_WORDS=(" + words +
                               "); COMP_CWORD=$((${#COMP_WORDS[@]}-1)); _binosplat; echo ${COMPREPLY[@]}";
    EXPECT_EQ(std::system(("bash -c '" + script + "' > " + (folder / "said").string()).c_str()), 0);
    return test::read_text(folder / "said");
  };
  EXPECT_EQ(completed("binosplat re"), "render refit\n");
  EXPECT_EQ(completed("binosplat render --lay"), "--layout\n");
  EXPECT_EQ(completed("binosplat render m.ply --layout cr"), "cross-eyed\n");
  EXPECT_EQ(completed("binosplat compare --lay"), "\n");
  EXPECT_EQ(completed("binosplat render m"), "\n") << "a file is meant";
}

// By a zsh that somebody types into.
TEST(CommandWords, CompleteInZsh) {
  if (std::system("zsh --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "no zsh here";
  const test::TempFolder folder;
  test::write_text(folder / "_binosplat", printed("zsh"));
  const auto completed = [&](const std::string& typed) {
    const std::string said = (folder / "said").string();
    test::write_text(folder / "type",
                     "zmodload zsh/zpty; zpty z zsh -f -i\n"
                     "zpty -w z 'PROMPT=; fpath=(" +
                         folder.path().string() +
                         " $fpath); autoload -U compinit; compinit -u -D; "
                         "binosplat() { print -- \"<$*>\" > " +
                         said +
                         "; exit }'\n"
                         "zpty -w -n z $'binosplat " +
                         typed +
                         "\\t\\n'\n"
                         "while zpty -r z line; do :; done\n");
    EXPECT_EQ(std::system(("timeout 20 zsh -f " + (folder / "type").string() + " > /dev/null").c_str()), 0);
    return test::read_text(said);
  };
  EXPECT_EQ(completed("rend"), "<render>\n");
  EXPECT_EQ(completed("render --exr-dep"), "<render --exr-depth>\n");
  EXPECT_EQ(completed("render --layout cross"), "<render --layout cross-eyed>\n");
  EXPECT_EQ(completed("compare --exr-dep"), "<compare --exr-dep>\n");
}

TEST(CommandWords, AreOfTextsThatThereAre) {
  EXPECT_TRUE(test::ended(run_program({"--print", "csh"}), 2, "--print"));
  EXPECT_FALSE(has(run_program({"--help"}).out, "--print")) << "for packages only";
}

}  // namespace
}  // namespace binosplat
