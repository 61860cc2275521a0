#include "base/mapped_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "support/errors.h"
#include "support/program.h"

namespace binosplat {
namespace {

using test::fails_saying;

TEST(MappedFile, MapsBytes) {
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

TEST(MappedFile, ReportsUnreadableFiles) {
  const test::TempFolder folder;
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  const auto open = [](const std::filesystem::path& path) { return [path] { const MappedFile file(path); }; };
  EXPECT_TRUE(fails_saying(open(folder / "none"), {"none", "No such file"}));
  EXPECT_TRUE(fails_saying(open(folder.path()), {folder.path().string(), "it is a folder"}));
  // Reading must not wait for a pipe without a writer.
  EXPECT_TRUE(fails_saying(open(folder / "pipe"), {"pipe", "device or a pipe"}));
}

}  // namespace
}  // namespace binosplat
