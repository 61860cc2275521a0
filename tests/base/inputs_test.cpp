#include "base/inputs.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "support/program.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;

TEST(Inputs, AreRejectedUnderAnyName) {
  const test::TempFolder folder;
  const fs::path file = folder / "model.ply", link = folder / "other.ply";
  test::write_text(file, "a model");
  check_no_input(file);
  protect_input(file);
  EXPECT_THROW(check_no_input(file), Error);
  fs::create_hard_link(file, link);
  EXPECT_THROW(check_no_input(link), Error);
  check_no_input(folder / "not_there.ply");
}

// File systems may give a deleted file's inode number to the next file.
TEST(Inputs, DeletedInputReleasesInode) {
  const test::TempFolder folder;
  const fs::path file = folder / "model.ply", link = folder / "other.ply";
  test::write_text(file, "a model");
  protect_input(file);
  fs::create_hard_link(file, link);
  fs::remove(file);
  check_no_input(link);
  test::write_text(file, "another model");
  check_no_input(link);
}

}  // namespace
}  // namespace binosplat
