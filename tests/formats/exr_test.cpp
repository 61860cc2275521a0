#include "formats/exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <gtest/gtest.h>
#include <half.h>

#include <cmath>
#include <limits>
#include <map>

#include "support/errors.h"
#include "support/full_disk.h"
#include "support/models.h"
#include "support/program.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;

/// A picture with colours up to 4, holes, and depths.
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

/// Largest difference, relative above 1; a difference of sizes is infinite.
double relative_difference(const std::vector<float>& a, const std::vector<float>& b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    worst = std::max(worst, std::abs(double{a[i]} - b[i]) / std::max(1.0, std::abs(double{b[i]})));
  }
  return worst;
}

TEST(Srgb, IsTheStandardsCurveAndGoesOn) {
  EXPECT_DOUBLE_EQ(srgb_to_linear(0), 0);
  EXPECT_DOUBLE_EQ(srgb_to_linear(1), 1);
  EXPECT_NEAR(srgb_to_linear(0.5), 0.21404114048223255, 1e-15);
  EXPECT_DOUBLE_EQ(srgb_to_linear(0.04), 0.04 / 12.92);
  EXPECT_DOUBLE_EQ(srgb_to_linear(3), std::pow((3 + 0.055) / 1.055, 2.4));
  EXPECT_DOUBLE_EQ(srgb_to_linear(-0.02), -0.02 / 12.92);
  EXPECT_DOUBLE_EQ(srgb_to_linear(-0.5), -srgb_to_linear(0.5));
  for (double v = -2; v < 5; v += 0.01) EXPECT_NEAR(linear_to_srgb(srgb_to_linear(v)), v, 1e-7) << v;
}

TEST(Exr, HoldsWhatTheMethodSaysWithABackground) {
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
    EXPECT_GT(relative_difference(channel.values, without_eotf), 0.01);  // planted fault
  }
  std::vector<float> coverage;
  for (const glm::vec4& colour : picture.colour) coverage.push_back(1.0f - colour.a);
  EXPECT_EQ(read_channel(folder / "a.exr", "coverage").values, coverage);
  EXPECT_EQ(read_channel(folder / "a.exr", "A").values, std::vector<float>(coverage.size(), 1.0f));
}

TEST(Exr, HoldsAssociatedAlphaWithoutABackground) {
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
  EXPECT_GT(relative_difference(stored, straight), 0.01);  // planted fault
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
    std::vector<float> rounded = z.values;  // planted fault: depth as half
    for (float& value : rounded) value = Imath::half(value);
    EXPECT_NE(z.values, rounded);
    EXPECT_EQ(read_channel(folder / "a.exr", "R").type, half ? Imf::HALF : Imf::FLOAT);
    EXPECT_EQ(read_channel(folder / "a.exr", "A").type, half ? Imf::HALF : Imf::FLOAT);
  }
}

TEST(Exr, HoweverItIsPackedTheNumbersAreTheSame) {
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

TEST(Exr, RoundTripGivesTheDisplayValues) {
  const test::TempFolder folder;
  const fs::path path = folder / "a.exr";
  const Picture picture = random_picture();
  for (const Background& background : {Background(), Background(glm::vec3(0.2f, 0.0f, 1.0f))}) {
    for (const bool half : {false, true}) {
      for (const bool display : {false, true}) {
        save_exr(path, picture, {.half = half, .display = display, .background = background});
        EXPECT_EQ(attribute(path, "binosplatEncoding"), display ? "display" : "linear");
        const Image loaded = load_image(path);
        const Image shown = composite(picture, background);
        EXPECT_EQ(loaded.channels, background ? 3 : 4);
        const double bound = half ? 2e-3 : 1e-6;
        EXPECT_LE(relative_difference(loaded.data, shown.data), bound)
            << half << display << background.has_value();
        // Planted fault: the other encoding.
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

TEST(Exr, AgreesWithPngOfTheSameFrame) {
  const test::TempFolder folder;
  Picture picture = random_picture();
  for (glm::vec4& colour : picture.colour) colour = glm::vec4(glm::vec3(colour) / 4.0f, colour.a);
  for (const Background& background : {Background(), Background(glm::vec3(0.5f))}) {
    save_exr(folder / "a.exr", picture, {.half = false, .background = background});
    save_png(folder / "a.png", composite(picture, background), {.bits = 16});
    const Image exr = load_image(folder / "a.exr");
    const Image png = load_image(folder / "a.png");
    EXPECT_EQ(exr.channels, png.channels);
    EXPECT_LE(relative_difference(exr.data, png.data), 0.51 / 65535);
  }
}

TEST(Exr, CarriesNotes) {
  const test::TempFolder folder;
  save_exr(folder / "a.exr", random_picture(), {.notes = {{"unitsPerMetre", "0.5"}}});
  EXPECT_EQ(attribute(folder / "a.exr", "unitsPerMetre"), "0.5");
}

/// A file as another program writes it: channels of FLOAT, all of `values`, in a window that begins
/// elsewhere.
void write_foreign(const fs::path& path, const std::map<std::string, float>& values, int sampling = 1) {
  const Imath::Box2i window({-2, 3}, {1, 4});  // 4 x 2
  Imf::Header header(window, window);
  std::map<std::string, std::vector<float>> pixels;
  Imf::FrameBuffer frame;
  for (const auto& [name, value] : values) {
    header.channels().insert(name, Imf::Channel(Imf::FLOAT, sampling, 1));
    pixels[name].assign(8, value);
    pixels[name][7] = 2 * value;
    frame.insert(name, Imf::Slice::Make(Imf::FLOAT, pixels[name].data(), window, 0, 0, sampling, 1));
  }
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(frame);
  file.writePixels(2);
}

TEST(Exr, ForeignFilesAreSceneLinear) {
  const test::TempFolder folder;
  const fs::path path = folder / "a.exr";
  write_foreign(path, {{"R", 0.1f}, {"G", 0.2f}, {"B", 0.3f}, {"A", 0.5f}, {"depth.Z", 7.0f}});
  Image image = load_image(path);
  ASSERT_EQ(image.channels, 4);
  ASSERT_EQ(image.width, 4);
  ASSERT_EQ(image.height, 2);
  EXPECT_FLOAT_EQ(image.at(0, 0, 0), static_cast<float>(linear_to_srgb(0.2)));
  EXPECT_FLOAT_EQ(image.at(2, 1, 2), static_cast<float>(linear_to_srgb(0.6)));
  EXPECT_FLOAT_EQ(image.at(0, 0, 3), 0.5f);
  EXPECT_FLOAT_EQ(image.at(3, 1, 3), 1.0f);

  write_foreign(path, {{"Y", 0.4f}});
  image = load_image(path);
  ASSERT_EQ(image.channels, 1);
  EXPECT_FLOAT_EQ(image.at(0, 0, 0), static_cast<float>(linear_to_srgb(0.4)));
  EXPECT_FLOAT_EQ(image.at(3, 1, 0), static_cast<float>(linear_to_srgb(0.8)));

  write_foreign(path, {{"Y", 0.4f}, {"A", 0.5f}});
  image = load_image(path);
  ASSERT_EQ(image.channels, 4);
  for (int c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(image.at(1, 1, c), static_cast<float>(linear_to_srgb(0.8)));

  write_foreign(path, {{"R", 0.4f}, {"Z", 0.5f}});
  EXPECT_TRUE(test::fails_saying([&] { load_image(path); }, {"a.exr", "no channels R, G, B or Y", "R Z"}));
  write_foreign(path, {{"R", 1}, {"G", 1}, {"B", 1}}, 2);
  EXPECT_TRUE(test::fails_saying([&] { load_image(path); }, {"a.exr", "channel R", "lower resolution"}));
}

TEST(Exr, BrokenFilesAreRefused) {
  const test::TempFolder folder;
  save_exr(folder / "a.exr", random_picture(), {.compression = ExrCompression::zip});
  const std::string good = test::read_text(folder / "a.exr");
  const auto refuses = [&](const std::string& bytes, const char* reason = "") {
    test::write_text(folder / "b.exr", bytes);
    return test::fails_saying([&] { load_image(folder / "b.exr"); }, {"b.exr", reason});
  };
  for (std::size_t size = 4; size < good.size(); size += good.size() / 50)
    EXPECT_TRUE(refuses(good.substr(0, size)));
  EXPECT_TRUE(refuses(good.substr(0, good.size() - 1)));

  // An attribute of nearly 2^31 bytes.
  std::string endless = good;
  endless.replace(good.find("string") + 7, 4, "\xf0\xff\xff\x7f");
  EXPECT_TRUE(refuses(endless));

  // A number of five bytes: OpenEXR would read four and take the rest for the next attribute's name.
  std::string shifted = good;
  shifted[good.find("float") + 6] = 5;
  EXPECT_TRUE(refuses(shifted, "broken OpenEXR"));

  // The data window's far corner at 2^31 - 2 and at 60,000.
  const std::size_t window = good.find("box2i") + 10;
  for (const char* side : {"\xfe\xff\xff\x7f", "\x60\xea\x00\x00"}) {
    std::string forged = good;
    for (const std::size_t at : {window + 8, window + 12}) forged.replace(at, 4, std::string(side, 4));
    EXPECT_TRUE(refuses(forged));
  }
  // One line of 2^24 px, for which OpenEXR would make room in blocks of 16; lines without a place in the
  // file.
  std::string forged = good;
  forged.replace(window + 8, 8, std::string("\xff\xff\xff\0\0\0\0\0", 8));
  EXPECT_TRUE(refuses(forged, "16777216 x 1 px, which"));
  forged = good;
  forged.replace(window + 12, 4, std::string("\x20\x4e\0\0", 4));
  EXPECT_TRUE(refuses(forged, "1251 blocks, which"));
}

TEST(Exr, FullDisksAreReported) {
  const test::TempFolder folder;
  const Picture picture = random_picture();
  save_exr(folder / "a.exr", picture, {});
  const std::size_t size = fs::file_size(folder / "a.exr");
  fs::remove(folder / "a.exr");
  for (std::size_t room = 0; room < size; room += size / 7) {
    const test::FullDisk disk(room);
    EXPECT_TRUE(
        test::fails_saying([&] { save_exr(folder / "a.exr", picture, {}); }, {"a.exr: File too large"}));
    EXPECT_TRUE(folder.names().empty());
  }
  test::write_text(folder / "file", "");
  EXPECT_TRUE(test::fails_saying([&] { save_exr(folder / "file/a.exr", picture, {}); }, {"Not a directory"}));
}

}  // namespace
}  // namespace binosplat
