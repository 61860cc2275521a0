#include "base/mapped_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "support/errors.h"
#include "support/program.h"

namespace binosplat {
namespace {

using test::fails_saying;

TEST(MappedFile, HoldsTheBytes) {
  const test::TempFolder folder;
  std::string text(100000, 'a');
  text[99999] = '\0';
  test::write_text(folder / "file", text);
  const MappedFile file(folder / "file");
  ASSERT_EQ(file.bytes().size(), text.size());
  EXPECT_TRUE(std::equal(text.begin(), text.end(), file.bytes().begin(),
                         [](char a, std::byte b) { return std::byte(a) == b; }));
  test::write_text(folder / "empty", "");
  EXPECT_TRUE(MappedFile(folder / "empty").bytes().empty());
}

TEST(MappedFile, NamesWhatCannotBeRead) {
  const test::TempFolder folder;
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  const auto open = [](const std::filesystem::path& path) { return [path] { const MappedFile file(path); }; };
  EXPECT_TRUE(fails_saying(open(folder / "none"), {"none", "No such file"}));
  EXPECT_TRUE(fails_saying(open(folder.path()), {folder.path().string(), "it is a folder"}));
  // Reading must not wait for a pipe without a writer.
  EXPECT_TRUE(fails_saying(open(folder / "pipe"), {"pipe", "device or a pipe"}));
}

TEST(MappedFile, NamesWhatIsCutShortWhileItIsRead) {
  const test::TempFolder folder;
  const auto read_cut = [&](bool told) {
    if (told) end_cleanly_on_cut_files();
    test::write_text(folder / "whole", "w");
    test::write_text(folder / "model.ply", std::string(100000, 'a'));
    const MappedFile before(folder / "whole"), file(folder / "model.ply"), after(folder / "whole");
    std::filesystem::resize_file(folder / "model.ply", 20000);
    int sum = 0;
    for (const std::byte b : file.bytes()) sum += std::to_integer<int>(b);
    std::exit(sum == 0 ? 1 : 0);
  };
  const int code = static_cast<int>(ExitCode::bad_input);
  EXPECT_EXIT(read_cut(true), testing::ExitedWithCode(code), "/model.ply was cut short while it was read");
#if !defined(__SANITIZE_ADDRESS__)  // has its own handler
  EXPECT_EXIT(read_cut(false), testing::KilledBySignal(SIGBUS), "");
#endif
}

}  // namespace
}  // namespace binosplat
