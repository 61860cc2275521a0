// OpenEXR files of other programs: their values are scene-linear, and their data window may differ from their
// display window, which is the picture.

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "formats/pictures/exr.h"
#include "formats/pictures/image_file.h"
#include "support/broken.h"
#include "support/errors.h"
#include "support/program.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using Imath::Box2i;
using Imath::V2i;

/// Returns the linear light of a channel at a pixel, the same in all files here.
float light(int channel, int x, int y) {
  return 0.05f + 0.001f * static_cast<float>(((7 * x + 13 * y + 29 * channel) % 700 + 700) % 700);
}

struct ExrFile {
  Box2i display, data;
  std::vector<std::string> channels = {"R", "G", "B"};
  float alpha = 0.5f;  // value of channel A
  bool tiled = false;
  int sampling = 1;
};

void write_exr(const fs::path& path, const ExrFile& file) {
  const Box2i& w = file.data;
  Imf::Header header(file.display, w);
  Imf::FrameBuffer frame;
  std::vector<std::vector<float>> planes(file.channels.size());
  for (std::size_t c = 0; c < planes.size(); ++c) {
    const std::string& name = file.channels[c];
    for (int y = w.min.y; y <= w.max.y; ++y) {
      for (int x = w.min.x; x <= w.max.x; ++x)
        planes[c].push_back(name == "A" ? file.alpha : light(static_cast<int>(c), x, y));
    }
    header.channels().insert(name, Imf::Channel(Imf::FLOAT, file.sampling, 1));
    frame.insert(name, Imf::Slice::Make(Imf::FLOAT, planes[c].data(), w, 0, 0, file.sampling, 1));
  }
  if (file.tiled) {
    header.setTileDescription(Imf::TileDescription(16, 16));
    Imf::TiledOutputFile out(path.c_str(), header);
    out.setFrameBuffer(frame);
    out.writeTiles(0, out.numXTiles() - 1, 0, out.numYTiles() - 1);
  } else {
    Imf::OutputFile out(path.c_str(), header);
    out.setFrameBuffer(frame);
    out.writePixels(w.max.y - w.min.y + 1);
  }
}

/// Returns the picture that the file's two windows define.
Image expected_window(const ExrFile& file) {
  const bool alpha = std::ranges::count(file.channels, "A") > 0, grey = file.channels[0] == "Y";
  const V2i size = file.display.size();
  Image image(size.x + 1, size.y + 1, alpha ? 4 : grey ? 1 : 3);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const V2i at = file.display.min + V2i(x, y);
      if (!file.data.intersects(at)) continue;
      for (int c = 0; c < std::min(image.channels, 3); ++c) {
        const float v = light(grey ? 0 : c, at.x, at.y) / (alpha ? file.alpha : 1.0f);
        image.at(x, y, c) = static_cast<float>(linear_to_srgb(v));
      }
      if (alpha) image.at(x, y, 3) = file.alpha;
    }
  }
  return image;
}

/// Returns the largest difference, infinity if the sizes differ.
double picture_difference(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height || a.channels != b.channels) return INFINITY;
  double worst = 0.0;
  for (std::size_t i = 0; i < a.data.size(); ++i)
    worst = std::max(worst, std::abs(static_cast<double>(a.data[i]) - b.data[i]));
  return worst;
}

const Box2i frame_window({0, 0}, {39, 29});
const Box2i windows[] = {frame_window,
                         Box2i({5, 3}, {20, 11}),    // smaller
                         Box2i({-7, -9}, {60, 50}),  // larger
                         Box2i({30, -5}, {70, 12}),  // across a corner of the frame
                         Box2i({-20, 10}, {0, 10}),  // one pixel of the frame
                         Box2i({39, 29}, {39, 29})};

TEST(ExrWindows, DisplayWindowIsPicture) {
  const test::TempFolder folder;
  for (const Box2i& display : {frame_window, Box2i({-3, 4}, {36, 33})}) {
    for (const Box2i& data : windows) {
      for (const std::vector<std::string>& channels : std::vector<std::vector<std::string>>{
               {"R", "G", "B"}, {"R", "G", "B", "A", "depth.Z"}, {"Y"}, {"Y", "A"}}) {
        for (const bool tiled : {false, true}) {
          const ExrFile file{.display = display, .data = data, .channels = channels, .tiled = tiled};
          write_exr(folder / "a.exr", file);
          const Image image = load_image(folder / "a.exr");
          EXPECT_LE(picture_difference(image, expected_window(file)), 1e-5)
              << channels.size() << " channels, x " << data.min.x << " to " << data.max.x;
          EXPECT_EQ(picture_size(folder / "a.exr"), glm::ivec2(40, 30));
          if (data == frame_window || !display.intersects(data)) continue;
          // Injected fault: the display window one pixel to the right.
          ExrFile moved = file;
          moved.display.min.x += 1;
          moved.display.max.x += 1;
          EXPECT_GT(picture_difference(image, expected_window(moved)), 1e-3);
        }
      }
    }
  }
}

TEST(ExrWindows, DisjointWindowsAreEmpty) {
  const test::TempFolder folder;
  const ExrFile file{
      .display = frame_window, .data = Box2i({100, 100}, {120, 110}), .channels = {"R", "G", "B", "A"}};
  write_exr(folder / "a.exr", file);
  testing::internal::CaptureStderr();
  const Image image = load_image(folder / "a.exr");
  EXPECT_NE(testing::internal::GetCapturedStderr().find("a.exr: its pixels lie outside its display window"),
            std::string::npos);
  EXPECT_EQ(picture_difference(image, Image(40, 30, 4)), 0.0);
}

TEST(ExrWindows, HugeWindowsTakeNoMemory) {
  const test::TempFolder folder;
  ExrFile file{.display = frame_window, .data = frame_window};
  write_exr(folder / "a.exr", file);
  const std::string good = test::read_text(folder / "a.exr");
  const std::size_t at = good.find("displayWindow") + sizeof("displayWindow") + sizeof("box2i") + 4;
  const auto with = [&](int x0, int y0, int x1, int y1) {
    test::write_text(
        folder / "b.exr",
        test::patched(good, at, test::little(x0) + test::little(y0) + test::little(x1) + test::little(y1)));
  };
  for (const int most : {20000, 1 << 20, (1 << 30) - 2}) {
    with(-most, -most, most, most);
    EXPECT_ERROR(load_image(folder / "b.exr"), "b.exr") << most;
    EXPECT_ERROR(picture_size(folder / "b.exr"), "b.exr") << most;
  }
  for (const int least : {0, 5}) {  // a window without a pixel
    with(least, 3, least - 1, 10);
    EXPECT_ERROR(load_image(folder / "b.exr"), "b.exr");
  }
  // A display window of ordinary size is read however far it is from the data window.
  with(1000000, -1000000, 1000099, -999901);
  EXPECT_EQ(load_image(folder / "b.exr").width, 100);
  // The memory limit also counts the pixels of the display window.
  with(0, 0, 1999, 1999);
  EXPECT_EQ(load_image(folder / "b.exr").height, 2000);
  try {
    load_image(folder / "b.exr", {.bytes = 1000000, .bytes_per_pixel = 10});
    ADD_FAILURE() << "4 Mpx in 1 MB";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::out_of_memory);
  }
}

TEST(ExrWindows, RejectUnsupportedChannels) {
  const test::TempFolder folder;
  const auto refuses = [&](const ExrFile& file, const std::vector<std::string>& said) {
    write_exr(folder / "a.exr", file);
    return test::fails_saying([&] { load_image(folder / "a.exr"); }, said) &&
           test::fails_saying([&] { picture_size(folder / "a.exr"); }, said);
  };
  ExrFile file{.display = frame_window, .data = frame_window, .channels = {"R", "Z"}};
  EXPECT_TRUE(refuses(file, {"a.exr", "no channels R, G, B or Y", "R Z"}));
  file.channels = {"Y", "RY", "BY"};
  EXPECT_TRUE(refuses(file, {"a.exr", "Y, RY, BY", "convert it to RGB"}));
  file.channels = {"R", "G", "B"};
  file.sampling = 2;
  EXPECT_TRUE(refuses(file, {"a.exr", "channel R", "lower resolution"}));
}

}  // namespace
}  // namespace binosplat
