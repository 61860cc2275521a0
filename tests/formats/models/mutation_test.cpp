// Random damage to the files of the fuzzers' corpus: each file loads, or ends with an Error that names the
// file. The address sanitizer shows bad reads. BINOSPLAT_LONG=1 tries more files.

#include <gtest/gtest.h>

#include "formats/cameras/cameras_file.h"
#include "formats/models/model_file.h"
#include "formats/pictures/image_file.h"
#include "support/damage.h"
#include "support/program.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;

/// Reads a file from the corpus folder `kind`.
void read_corpus(const std::string& kind, const fs::path& file) {
  if (kind == "image")
    load_image(file);
  else if (kind == "json")
    load_cameras(file);
  else
    load_model(file);
}

struct DamagedFiles : testing::TestWithParam<const char*> {};

TEST_P(DamagedFiles, LoadOrAreRejected) {
  const std::string kind = GetParam();
  const test::TempFolder folder;
  test::Uniform uniform(1);
  int loaded = 0, refused = 0;
  std::vector<fs::path> files;
  for (const auto& entry :
       fs::directory_iterator(fs::path(BINOSPLAT_SOURCE_DIR) / "tests/fuzz/corpus" / kind))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  // The thousands of messages are kept out of the test's log.
  testing::internal::CaptureStderr();
  for (const fs::path& file : files) {
    const std::string good = test::read_text(file);
    for (int i = 0; i < (test::switched_on("BINOSPLAT_LONG") ? 10000 : 50); ++i) {
      test::write_text(folder / "damaged", test::damaged(good, uniform));
      try {
        read_corpus(kind, folder / "damaged");
        ++loaded;
      } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("damaged"), std::string::npos) << error.what();
        EXPECT_EQ(error.code(), ExitCode::bad_input) << error.what();
        ++refused;
      } catch (const std::exception& error) {
        ADD_FAILURE() << "not an Error: " << error.what();
      }
    }
  }
  testing::internal::GetCapturedStderr();
  EXPECT_GT(loaded, 0);
  EXPECT_GT(refused, 0);
}

INSTANTIATE_TEST_SUITE_P(Corpus, DamagedFiles,
                         testing::Values("ply", "compressed_ply", "spz", "splat", "ksplat", "gltf",
                                         "sog_archive", "json", "image"),
                         [](const auto& named) { return std::string(named.param); });

}  // namespace
}  // namespace binosplat
