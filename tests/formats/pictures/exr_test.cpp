// OpenEXR files that binosplat writes: pictures and stereo pairs, with colours, depths and metadata.

#include "formats/pictures/exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfMultiView.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <gtest/gtest.h>
#include <half.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>

#include "support/broken.h"
#include "support/full_disk.h"
#include "support/models.h"
#include "support/program.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;

/// Returns a picture with colours up to 4, holes and depths.
Picture random_picture(int width = 37, int height = 23) {
  Picture picture(width, height);
  test::Uniform uniform(7);
  for (std::size_t k = 0; k < picture.colour.size(); ++k) {
    const double covered = k % 5 == 0 ? 0.0 : uniform(0.01, 1.0);
    const auto colour = [&] { return static_cast<float>(covered * std::pow(uniform(0, 1), 3) * 4); };
    picture.colour[k] = glm::vec4(colour(), colour(), colour(), static_cast<float>(1 - covered));
    picture.z_sum[k] = static_cast<float>(covered * uniform(0.2, 50));
  }
  return picture;
}

/// The pixels of a channel as stored, and its type.
struct Channel {
  Imf::PixelType type = Imf::NUM_PIXELTYPES;
  std::vector<float> values;
};

Channel read_channel(const fs::path& path, const char* name) {
  Imf::InputFile file(path.c_str());
  const Imf::Channel* found = file.header().channels().findChannel(name);
  Channel channel;
  if (found == nullptr) return channel;
  channel.type = found->type;
  const Imath::Box2i window = file.header().dataWindow();
  const auto width = static_cast<std::size_t>(window.max.x) + 1;
  channel.values.resize(width * (static_cast<std::size_t>(window.max.y) + 1));
  Imf::FrameBuffer frame;
  frame.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(channel.values.data()), sizeof(float),
                                sizeof(float) * width));
  file.setFrameBuffer(frame);
  file.readPixels(0, window.max.y);
  return channel;
}

std::string attribute(const fs::path& path, const char* name) {
  const Imf::InputFile file(path.c_str());
  const auto* found = file.header().findTypedAttribute<Imf::StringAttribute>(name);
  return found == nullptr ? "" : found->value();
}

/// Returns the largest difference, divided by the expected value where that exceeds 1; infinity if the sizes
/// differ.
double relative_difference(const std::vector<float>& a, const std::vector<float>& b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    worst = std::max(worst, std::abs(double{a[i]} - b[i]) / std::max(1.0, std::abs(double{b[i]})));
  }
  return worst;
}

TEST(Srgb, FollowsStandardAndExtends) {
  EXPECT_DOUBLE_EQ(srgb_to_linear(0), 0);
  EXPECT_DOUBLE_EQ(srgb_to_linear(1), 1);
  EXPECT_NEAR(srgb_to_linear(0.5), 0.21404114048223255, 1e-15);
  EXPECT_DOUBLE_EQ(srgb_to_linear(0.04), 0.04 / 12.92);
  EXPECT_DOUBLE_EQ(srgb_to_linear(3), std::pow((3 + 0.055) / 1.055, 2.4));
  EXPECT_DOUBLE_EQ(srgb_to_linear(-0.02), -0.02 / 12.92);
  EXPECT_DOUBLE_EQ(srgb_to_linear(-0.5), -srgb_to_linear(0.5));
  for (double v = -2; v < 5; v += 0.01) EXPECT_NEAR(linear_to_srgb(srgb_to_linear(v)), v, 1e-7) << v;
}

TEST(Exr, HoldsLinearColourOverBackground) {
  const test::TempFolder folder;
  const Picture picture = random_picture();
  const glm::vec3 background(0.1f, 0.5f, 2.0f);
  save_exr(folder / "a.exr", picture, {.half = false, .background = background});
  const Image shown = composite(picture, background);
  for (int c = 0; c < 3; ++c) {
    std::vector<float> linear, without_eotf;
    for (std::size_t i = static_cast<std::size_t>(c); i < shown.data.size(); i += 3) {
      linear.push_back(static_cast<float>(srgb_to_linear(shown.data[i])));
      without_eotf.push_back(shown.data[i]);
    }
    const char* names[] = {"R", "G", "B"};
    const Channel channel = read_channel(folder / "a.exr", names[c]);
    EXPECT_EQ(channel.type, Imf::FLOAT);
    EXPECT_LE(relative_difference(channel.values, linear), 1e-7);
    EXPECT_GT(relative_difference(channel.values, without_eotf), 0.01);  // injected fault
  }
  std::vector<float> coverage;
  for (const glm::vec4& colour : picture.colour) coverage.push_back(1.0f - colour.a);
  EXPECT_EQ(read_channel(folder / "a.exr", "coverage").values, coverage);
  EXPECT_EQ(read_channel(folder / "a.exr", "A").values, std::vector<float>(coverage.size(), 1.0f));
}

TEST(Exr, HoldsAssociatedAlphaWithoutBackground) {
  const test::TempFolder folder;
  const Picture picture = random_picture();
  save_exr(folder / "a.exr", picture, {.half = false});
  std::vector<float> associated, straight, coverage;
  for (const glm::vec4& colour : picture.colour) {
    const double a = 1.0f - colour.a;
    coverage.push_back(static_cast<float>(a));
    straight.push_back(static_cast<float>(a > 0 ? srgb_to_linear(colour.g / a) : 0));
    associated.push_back(static_cast<float>(a > 0 ? a * srgb_to_linear(colour.g / a) : 0));
  }
  const std::vector<float> stored = read_channel(folder / "a.exr", "G").values;
  EXPECT_LE(relative_difference(stored, associated), 1e-6);
  EXPECT_GT(relative_difference(stored, straight), 0.01);  // injected fault
  EXPECT_EQ(read_channel(folder / "a.exr", "A").values, coverage);
  EXPECT_EQ(read_channel(folder / "a.exr", "coverage").type, Imf::NUM_PIXELTYPES);
}

TEST(Exr, DepthIsAlwaysFloat) {
  const test::TempFolder folder;
  const Picture picture = random_picture();
  for (const bool half : {false, true}) {
    save_exr(folder / "a.exr", picture, {.half = half});
    const Channel z = read_channel(folder / "a.exr", "Z");
    EXPECT_EQ(z.type, Imf::FLOAT);
    EXPECT_EQ(z.values, depth_map(picture).data);
    std::vector<float> rounded = z.values;  // injected fault: depth as half
    for (float& value : rounded) value = Imath::half(value);
    EXPECT_NE(z.values, rounded);
    EXPECT_EQ(read_channel(folder / "a.exr", "R").type, half ? Imf::HALF : Imf::FLOAT);
    EXPECT_EQ(read_channel(folder / "a.exr", "A").type, half ? Imf::HALF : Imf::FLOAT);
  }
}

TEST(Exr, CompressionIsLossless) {
  const test::TempFolder folder;
  const Picture picture = random_picture();
  std::map<ExrCompression, std::string> files;
  for (const ExrCompression by : {ExrCompression::none, ExrCompression::rle, ExrCompression::zip}) {
    save_exr(folder / "a.exr", picture, {.compression = by});
    files[by] = test::read_text(folder / "a.exr");
    const Image loaded = load_image(folder / "a.exr");
    save_exr(folder / "none.exr", picture, {.compression = ExrCompression::none});
    EXPECT_EQ(loaded.data, load_image(folder / "none.exr").data);
    EXPECT_EQ(read_channel(folder / "a.exr", "Z").values, depth_map(picture).data);
  }
  EXPECT_NE(files[ExrCompression::rle], files[ExrCompression::none]);
  EXPECT_NE(files[ExrCompression::zip], files[ExrCompression::rle]);
}

TEST(Exr, RoundTripKeepsDisplayValues) {
  const test::TempFolder folder;
  const fs::path path = folder / "a.exr";
  const Picture picture = random_picture();
  for (const Background& background : {Background(), Background(glm::vec3(0.2f, 0.0f, 1.0f))}) {
    for (const bool half : {false, true}) {
      for (const bool display : {false, true}) {
        save_exr(path, picture,
                 {.half = half,
                  .display = display,
                  .background = background,
                  .notes = {{"unitsPerMetre", "0.5"}}});
        EXPECT_EQ(attribute(path, "unitsPerMetre"), "0.5");
        EXPECT_EQ(attribute(path, "binosplatEncoding"), display ? "display" : "linear");
        const Image loaded = load_image(path);
        const Image shown = composite(picture, background);
        EXPECT_EQ(loaded.channels, background ? 3 : 4);
        const double bound = half ? 2e-3 : 1e-6;
        EXPECT_LE(relative_difference(loaded.data, shown.data), bound)
            << half << display << background.has_value();
        // Injected fault: the other encoding.
        Image faulty = shown;
        for (std::size_t i = 0; i < faulty.data.size(); ++i) {
          if (faulty.channels == 4 && i % 4 == 3) continue;
          faulty.data[i] =
              static_cast<float>(display ? linear_to_srgb(faulty.data[i]) : srgb_to_linear(faulty.data[i]));
        }
        EXPECT_GT(relative_difference(loaded.data, faulty.data), 10 * bound);
      }
    }
  }
}

TEST(Exr, RejectsBrokenFiles) {
  const test::TempFolder folder;
  save_exr(folder / "a.exr", random_picture(), {.compression = ExrCompression::zip});
  const std::string good = test::read_text(folder / "a.exr");
  using namespace std::string_view_literals;
  const auto with = [&](std::size_t at, std::string_view bytes) {
    return test::patched(good, at, std::string(bytes));
  };
  const std::size_t window = good.find("box2i") + 10;
  const std::vector<test::BrokenFile> refusals = {
      // An attribute of nearly 2^31 bytes.
      {with(good.find("string") + 7, "\xf0\xff\xff\x7f"sv), {}},
      // A float attribute of five bytes: OpenEXR would read four, and take the fifth as the next attribute's
      // name.
      {with(good.find("float") + 6, "\5"sv), {"broken OpenEXR"}},
      // The data window's far corner at 2^31 - 2 and at 60,000.
      {with(window + 8, "\xfe\xff\xff\x7f\xfe\xff\xff\x7f"sv), {}},
      {with(window + 8, "\x60\xea\0\0\x60\xea\0\0"sv), {}},
      // One row of 2^24 px, for which OpenEXR would allocate blocks of 16 rows; then blocks that the file has
      // no offsets for.
      {with(window + 8, "\xff\xff\xff\0\0\0\0\0"sv), {"16777216 x 1 px, which"}},
      {with(window + 12, "\x20\x4e\0\0"sv), {"1251 blocks, which"}},
  };
  test::expect_refusals("b.exr", refusals, [&](const std::string& bytes) {
    test::write_text(folder / "b.exr", bytes);
    load_image(folder / "b.exr");
  });
}

TEST(Exr, ReportsFullDisk) {
  const test::TempFolder folder;
  const Picture picture = random_picture();
  save_exr(folder / "a.exr", picture, {});
  const std::size_t size = fs::file_size(folder / "a.exr");
  fs::remove(folder / "a.exr");
  for (std::size_t room = 0; room < size; room += size / 7) {
    const test::FullDisk disk(room);
    EXPECT_ERROR(save_exr(folder / "a.exr", picture, {}), "a.exr: File too large");
    EXPECT_TRUE(folder.names().empty());
  }
  test::write_text(folder / "file", "");
  EXPECT_ERROR(save_exr(folder / "file/a.exr", picture, {}), "Not a directory");
}

/// Returns a picture of one colour with an alpha of 0.75 and depths from 1 to 2.
Picture flat_picture(const glm::vec3& colour, int width = 13) {
  Picture picture(width, 7);
  for (std::size_t k = 0; k < picture.colour.size(); ++k) {
    picture.colour[k] = glm::vec4(0.75f * colour, 0.25f);
    picture.z_sum[k] = 0.75f * (1.0f + static_cast<float>(k) / 91.0f);
  }
  return picture;
}

const Picture left = flat_picture({0.9f, 0.2f, 0.1f}), right = flat_picture({0.1f, 0.3f, 0.8f});

/// Returns the first pixel of a channel, or -1 if the file lacks the channel.
float first_value(const fs::path& path, const char* name) {
  const Channel channel = read_channel(path, name);
  return channel.values.empty() ? -1.0f : channel.values[0];
}

float stored(float display) { return static_cast<float>(0.75 * srgb_to_linear(display)); }

TEST(ExrViews, DefaultToLeft) {
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

TEST(ExrViews, RequireEqualSizes) {
  const test::TempFolder folder;
  const Picture wider = flat_picture({1, 1, 1}, 14);
  EXPECT_ERROR(save_exr(folder / "pair.exr", left, wider, {}), "pair.exr", "13 x 7", "14 x 7");
  EXPECT_TRUE(folder.names().empty());
}

/// Returns the output of a command, whose exit code must be 0.
std::string said_by(const test::TempFolder& folder, const std::string& command) {
  const fs::path out = folder / "said";
  const int code = std::system((command + " > " + out.string() + " 2>&1").c_str());
  EXPECT_EQ(code, 0) << command << ": " << test::read_text(out);
  return test::read_text(out);
}

TEST(ExrViews, AreSplitByOpenExrTools) {
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
