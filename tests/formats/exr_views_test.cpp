// Both eyes in one OpenEXR file, as the library and OpenEXR's own tools see them.

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfMultiView.h>
#include <ImfStandardAttributes.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "formats/exr.h"
#include "support/errors.h"
#include "support/models.h"
#include "support/program.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;

/// Half covered, one colour, depth 1 to 2.
Picture flat_picture(const glm::vec3& colour, int width = 13) {
  Picture picture(width, 7);
  for (std::size_t k = 0; k < picture.colour.size(); ++k) {
    picture.colour[k] = glm::vec4(0.75f * colour, 0.25f);
    picture.z_sum[k] = 0.75f * (1.0f + static_cast<float>(k) / 91.0f);
  }
  return picture;
}

const Picture left = flat_picture({0.9f, 0.2f, 0.1f}), right = flat_picture({0.1f, 0.3f, 0.8f});

/// A channel's first pixel, or a number that none has.
float first_value(const fs::path& path, const std::string& name) {
  Imf::InputFile file(path.c_str());
  if (file.header().channels().findChannel(name) == nullptr) return -1.0f;
  const Imath::Box2i window = file.header().dataWindow();
  std::vector<float> values(13 * 7);
  Imf::FrameBuffer frame;
  frame.insert(name, Imf::Slice::Make(Imf::FLOAT, values.data(), window, sizeof(float), 13 * sizeof(float)));
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);
  return values[0];
}

float stored(float display) { return static_cast<float>(0.75 * srgb_to_linear(display)); }

TEST(ExrViews, LeftIsTheDefaultAndRightHasAPrefix) {
  const test::TempFolder folder;
  const fs::path path = folder / "pair.exr";
  save_exr(path, left, right, {.half = false});
  {
    const Imf::InputFile file(path.c_str());
    ASSERT_TRUE(Imf::hasMultiView(file.header()));
    EXPECT_EQ(Imf::multiView(file.header()), (Imf::StringVector{"left", "right"}));
    for (const char* name : {"R", "G", "B", "A", "Z"}) {
      EXPECT_EQ(Imf::viewFromChannelName(name, Imf::multiView(file.header())), "left") << name;
      const std::string other = std::string("right.") + name;
      EXPECT_NE(file.header().channels().findChannel(other), nullptr) << other;
      EXPECT_EQ(Imf::viewFromChannelName(other, Imf::multiView(file.header())), "right") << other;
    }
    EXPECT_EQ(file.header().channels().findChannel("right.Z")->type, Imf::FLOAT);
  }
  EXPECT_NEAR(first_value(path, "R"), stored(0.9f), 1e-6);
  EXPECT_NEAR(first_value(path, "right.R"), stored(0.1f), 1e-6);
  EXPECT_NEAR(first_value(path, "right.B"), stored(0.8f), 1e-6);
  EXPECT_GT(std::abs(first_value(path, "right.B") - stored(0.1f)), 0.1) << "swapped eyes go unnoticed";
  EXPECT_EQ(first_value(path, "A"), 0.75f);
  EXPECT_EQ(first_value(path, "right.A"), 0.75f);
  EXPECT_EQ(first_value(path, "right.Z"), 1.0f);
  // load_image reads the default view.
  EXPECT_NEAR(load_image(path).at(0, 0, 0), 0.9f, 1e-5);

  save_exr(path, left, right, {.background = glm::vec3(0.0f)});
  EXPECT_EQ(first_value(path, "coverage"), 0.75f);
  EXPECT_EQ(first_value(path, "right.coverage"), 0.75f);
  save_exr(path, left, {});
  EXPECT_FALSE(Imf::hasMultiView(Imf::InputFile(path.c_str()).header())) << "one picture has no views";
}

TEST(ExrViews, HaveOneSize) {
  const test::TempFolder folder;
  const Picture wider = flat_picture({1, 1, 1}, 14);
  EXPECT_TRUE(test::fails_saying([&] { save_exr(folder / "pair.exr", left, wider, {}); },
                                 {"pair.exr", "13 x 7", "14 x 7"}));
  EXPECT_TRUE(folder.names().empty());
}

/// What a command says; its exit code must be 0.
std::string said_by(const test::TempFolder& folder, const std::string& command) {
  const fs::path out = folder / "said";
  const int code = std::system((command + " > " + out.string() + " 2>&1").c_str());
  EXPECT_EQ(code, 0) << command << ": " << test::read_text(out);
  return test::read_text(out);
}

TEST(ExrViews, OpenExrsOwnToolsSplitThem) {
  if (std::system("exrheader > /dev/null 2>&1; test $? -ne 127") != 0)
    GTEST_SKIP() << "Debian's package openexr is not installed";
  const test::TempFolder folder;
  const std::string pair = (folder / "pair.exr").string(), parts = (folder / "parts.exr").string();
  save_exr(pair, left, right, {.half = false});
  const std::string header = said_by(folder, "exrheader " + pair);
  for (const char* expected : {"multiView", "\"left\"", "\"right\"", "right.R,", "right.Z, 32-bit float"})
    EXPECT_NE(header.find(expected), std::string::npos) << expected << " is not in " << header;

  said_by(folder, "exrmultipart -convert -i " + pair + " -o " + parts);
  said_by(folder, "exrmultipart -separate -i " + parts + " -o " + (folder / "eye").string());
  const auto channel = [&](const char* part, const char* of_left, const char* of_right) {
    const fs::path path = folder / part;
    const float value = first_value(path, of_left);
    return value >= 0 ? value : first_value(path, of_right);
  };
  EXPECT_NEAR(channel("eye.1.exr", "R", "left.R"), stored(0.9f), 1e-6) << folder.names().size();
  EXPECT_NEAR(channel("eye.2.exr", "R", "right.R"), stored(0.1f), 1e-6);
  EXPECT_EQ(channel("eye.2.exr", "Z", "right.Z"), 1.0f);
}

}  // namespace
}  // namespace binosplat
