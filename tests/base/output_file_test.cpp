#include "base/output_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <mutex>
#include <thread>
#include <vector>

#include "support/errors.h"
#include "support/full_disk.h"
#include "support/program.h"

namespace {

/// The calls on files, in order.
struct Told {
  std::mutex mutex;
  std::vector<std::string> all;
};

Told& told() {
  static Told one;
  return one;
}

}  // namespace

// Replaces the C library's function in this program.
// NOLINTNEXTLINE(readability-inconsistent-declaration-parameter-name): the C library's are reserved
extern "C" int fsync(int file) {
  struct stat status {};
  fstat(file, &status);
  {
    const std::lock_guard lock(told().mutex);
    told().all.emplace_back(S_ISDIR(status.st_mode) ? "sync folder" : "sync file");
  }
  return static_cast<int>(syscall(SYS_fsync, file));
}

// NOLINTNEXTLINE(readability-inconsistent-declaration-parameter-name)
extern "C" int rename(const char* from, const char* to) noexcept {
  {
    const std::lock_guard lock(told().mutex);
    told().all.emplace_back("rename");
  }
  return static_cast<int>(syscall(SYS_rename, from, to));
}

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using test::fails_saying;
using test::read_text;
using Names = std::set<std::string>;

TEST(OutputFile, AppearsWholeWhenCommitted) {
  const test::TempFolder folder;
  {
    OutputFile file(folder / "a/b/out.txt");
    file.write("one ");
    file.write("two");
    EXPECT_FALSE(fs::exists(folder / "a/b/out.txt"));
    EXPECT_EQ(file.path().parent_path(), folder / "a/b");
    file.commit();
  }
  EXPECT_EQ(read_text(folder / "a/b/out.txt"), "one two");
  EXPECT_EQ(folder.names(), (Names{"a", "a/b", "a/b/out.txt"}));
}

TEST(OutputFile, AcceptsWorkingFolder) {
  const test::TempFolder folder;
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  OutputFile file("out.txt");
  file.write("text");
  file.commit();
  fs::current_path(before);
  EXPECT_EQ(read_text(folder / "out.txt"), "text");
}

TEST(OutputFile, LeavesNothingWhenNotCommitted) {
  const test::TempFolder folder;
  test::write_text(folder / "out.txt", "old");
  {
    OutputFile file(folder / "out.txt");
    file.write("new");
    // Injected: a temporary file exists before the commit, and names() lists it.
    EXPECT_EQ(folder.names().size(), 2u);
  }
  EXPECT_EQ(read_text(folder / "out.txt"), "old");
  EXPECT_EQ(folder.names(), Names{"out.txt"});
}

// The data is on the disk before its name is, because power may fail at any time.
TEST(OutputFile, SyncsBeforeRename) {
  const test::TempFolder folder;
  using Steps = std::vector<std::string>;
  const auto steps_of = [&](const std::string& name, bool commits) {
    told().all.clear();
    OutputFile file(folder / name);
    file.write("text");
    if (commits) file.commit();
    return told().all;
  };
  EXPECT_EQ(steps_of("out.txt", true), (Steps{"sync file", "rename", "sync folder"}));
  EXPECT_EQ(steps_of("a/b/out.txt", true),
            (Steps{"sync file", "rename", "sync folder", "sync folder", "sync folder"}))
      << "folders that were made are in others";
  EXPECT_EQ(steps_of("a/b/out.txt", true), (Steps{"sync file", "rename", "sync folder"}));
  EXPECT_EQ(steps_of("none.txt", false), Steps{}) << "injected: one that is not committed";
}

TEST(OutputFile, CommitAsFirstHasOneWinner) {
  const test::TempFolder folder;
  for (int round = 0; round < 20; ++round) {
    const fs::path path = folder / std::to_string(round);
    std::atomic<int> first = 0, winner = -1;
    {
      std::vector<std::jthread> threads;
      for (int k = 0; k < 4; ++k) {
        threads.emplace_back([&, k] {
          OutputFile file(path);
          file.write(std::to_string(k));
          if (!file.commit_as_first()) return;
          ++first;
          winner = k;
        });
      }
    }
    EXPECT_EQ(first, 1);
    EXPECT_EQ(read_text(path), std::to_string(winner));
  }
  EXPECT_EQ(folder.names().size(), 20u) << "nothing else is left";
  OutputFile late(folder / "0");  // injected: a usual commit
  late.write("late");
  late.commit();
  EXPECT_EQ(read_text(folder / "0"), "late");
}

TEST(OutputFile, FollowsSymbolicLinks) {
  const test::TempFolder folder;
  test::write_text(folder / "target.txt", "old");
  fs::create_symlink(folder / "target.txt", folder / "link.txt");
  OutputFile file(folder / "link.txt");
  file.write("new");
  file.commit();
  EXPECT_TRUE(fs::is_symlink(folder / "link.txt"));
  EXPECT_EQ(read_text(folder / "target.txt"), "new");
}

TEST(OutputFile, ReportsUnwritablePaths) {
  const test::TempFolder folder;
  test::write_text(folder / "file", "");
  fs::create_directory(folder / "folder");
  const auto open = [&](const fs::path& path) { return [path] { const OutputFile file(path); }; };
  EXPECT_TRUE(fails_saying(open(folder / "file/out.txt"), {"file/out.txt", "Not a directory"}));
  EXPECT_TRUE(fails_saying(open(folder / "file/deeper/out.txt"), {"file/deeper/out.txt", "Not a directory"}));
  EXPECT_TRUE(fails_saying(open(folder / "folder"), {"folder", "it is a folder"}));
  EXPECT_TRUE(fails_saying(open("/dev/null"), {"/dev/null", "device"}));
  EXPECT_TRUE(fails_saying(open(""), {"expected the name of a file"}));
  EXPECT_TRUE(fails_saying(open(folder / std::string(300, 'x')), {"File name too long"}));
  EXPECT_EQ(folder.names(), (Names{"file", "folder"}));
}

TEST(OutputFile, NeedsPermission) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  const test::TempFolder folder;
  fs::create_directory(folder / "locked");
  fs::permissions(folder / "locked", fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_ERROR(const OutputFile file(folder / "locked/out.txt"), "out.txt", "Permission denied");
  fs::permissions(folder / "locked", fs::perms::owner_all);
}

TEST(OutputFile, ReportsFullDisk) {
  const test::TempFolder folder;
  const auto write = [&](std::size_t bytes) {
    OutputFile file(folder / "out");
    file.write(std::string(bytes, 'x'));
    file.commit();
  };
  // Less than the buffer (fails on closing), and more (fails on writing).
  for (const std::size_t room : {1000u, 100000u}) {
    const test::FullDisk disk(room);
    EXPECT_ERROR(write(room + 1), "cannot write", "out: File too large");
    EXPECT_EQ(folder.names(), Names{});
    write(room);
    EXPECT_EQ(fs::file_size(folder / "out"), room);
    fs::remove(folder / "out");
  }
}

}  // namespace
}  // namespace binosplat
