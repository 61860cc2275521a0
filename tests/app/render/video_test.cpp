// render -o FILE.mkv: the frames of a path as a video, encoded by the installed ffmpeg.

#include "app/scene.h"

namespace binosplat {
namespace {

struct Video : SceneTest {
  const std::string path = folder / "path.json";

  // Writes five cameras that move along x, `step` seconds apart.
  explicit Video(double step = 0.04) {
    json cameras;
    for (int k = 0; k < 5; ++k) {
      json camera = camera_json("frame" + std::to_string(k), -0.6 + 0.3 * k);
      camera["time"] = step * k;
      cameras.push_back(camera);
    }
    save("path.json", cameras);
  }

  // Replaces ffmpeg by a script, for which $file is the video.
  Surroundings with_ffmpeg(const std::string& script) const {
    const fs::path program = folder / "bin/ffmpeg";
    fs::create_directories(program.parent_path());
    write_text(program, "#!/bin/sh\nfor file; do :; done\n" + script + "\n");
    fs::permissions(program, fs::perms::owner_all);
    return {.variables = {{"PATH", program.parent_path().string() + ":/usr/bin:/bin"}}};
  }

  static glm::dvec3 mean(const Image& image) {
    glm::dvec3 sum(0.0);
    for (std::size_t k = 0; k < image.data.size(); ++k) sum[static_cast<int>(k % 3)] += image.data[k];
    return sum / (static_cast<double>(image.data.size()) / 3.0);
  }
};

TEST_F(Video, HasPathFramesInOrder) {
  if (!have_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  const std::string video = folder / "new/pair.mkv";
  ASSERT_TRUE(good(render({"--path", path, "-o", video, "--layout", "cross-eyed", "--convergence", "inf"})));
  ASSERT_TRUE(good(render({"--path", path, "-o", out, "--layout", "cross-eyed", "--convergence", "inf"})));
  const std::string facts = facts_of(video);
  for (const char* fact : {"width=144", "height=48", "r_frame_rate=25/1", "nb_read_frames=5",
                           "codec_name=h264", "stereo_mode=right_left", "color_space=bt709"})
    EXPECT_TRUE(has(facts, fact)) << fact;
  asked("ffmpeg -v error -i " + video + " " + (folder / "decoded%d.png").string());
  const auto decoded = [&](int k) {
    return load_image(folder / ("decoded" + std::to_string(k + 1) + ".png"));
  };
  const auto written = [&](int k) { return load_image(out + "/frame" + std::to_string(k) + ".png"); };
  for (int k = 0; k < 5; ++k) {
    // Subsampled colours make confetti differ much from the drawn picture, but every other frame differs
    // more.
    const double own = measure::psnr(decoded(k), written(k));
    EXPECT_GT(own, measure::psnr(decoded(k), written((k + 1) % 5)) + 3.0) << "another frame goes unnoticed";
    // A wrong matrix or range of colours shifts the mean.
    EXPECT_LT(glm::length(mean(decoded(k)) - mean(written(k))), 1.5 / 255);
    EXPECT_GT(glm::length(mean(decoded(k)) - 16.0 / 255 - mean(written(k)) * 219.0 / 255.0), 1.5 / 255);
  }
}

TEST_F(Video, InterleavedEyesKeepFullChroma) {
  if (!have_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  const auto format = [&](const std::string& layout) {
    const std::string video = folder / (layout + ".mp4");
    EXPECT_TRUE(good(render({"--path", path, "-o", video, "--layout", layout, "--fps", "12"})));
    const std::string facts = asked("ffprobe -v error -show_streams " + video);
    EXPECT_TRUE(has(facts, "r_frame_rate=12/1"));
    return facts.substr(facts.find("pix_fmt="), 15);
  };
  EXPECT_EQ(format("columns"), "pix_fmt=yuv444p");
  EXPECT_EQ(format("half-width"), "pix_fmt=yuv420p");
}

TEST_F(Video, MissingFfmpegFailsEarly) {
  const Surroundings bare = {.variables = {{"PATH", folder.path().string()}}};
  const Outcome outcome = render({"--path", path, "-o", folder / "a.mp4"}, bare);
  EXPECT_TRUE(ended(outcome, 2, "apt install ffmpeg"));
  EXPECT_FALSE(has(outcome.err, "drawing"));
  EXPECT_EQ(folder.files(), (Names{"model.ply", "path.json"}));
}

TEST_F(Video, FfmpegFailureLeavesNoFile) {
  for (const char* script :
       {"echo no such encoder >&2; exit 1", "echo no such encoder >&2; cat > /dev/null; exit 1"}) {
    const Outcome outcome = render({"--path", path, "-o", folder / "a.mp4"}, with_ffmpeg(script));
    EXPECT_TRUE(ended(outcome, 2, "a.mp4: ffmpeg ended (exit code 1); what it said is above"));
    EXPECT_TRUE(has(outcome.err, "no such encoder"));
    EXPECT_EQ(folder.files(), (Names{"bin/ffmpeg", "model.ply", "path.json"}));
  }
}

TEST_F(Video, QuotesFileNamesForShell) {
  const std::string name = "it's \"one\" $(word) `of` \\ them;.mp4";
  const Surroundings copying = with_ffmpeg("cat > \"$file\"");
  ASSERT_TRUE(good(render({"--path", path, "-o", folder / name}, copying)));
  EXPECT_EQ(folder.files(), (Names{"bin/ffmpeg", name, "model.ply", "path.json"}));
  EXPECT_EQ(fs::file_size(folder / name), 5 * 3 * 144 * 48);
}

TEST_F(Video, InterruptLeavesNoFile) {
  // An ffmpeg that begins its file early, as most do, and one that begins it late.
  for (const char* script : {"touch \"$file\"; cat > \"$file\"; touch ended",
                             "touch begun; cat > /dev/null; touch \"$file\"; touch ended"}) {
    const Surroundings slow = with_ffmpeg("cd '" + folder.path().string() + "'; " + script);
    const auto before = folder.files();
    Program program({"render", model, "--orbit", "5000", "--size", "64x48", "-o", folder / "a.mp4"}, slow);
    wait_until([&] { return folder.files() != before; });
    EXPECT_NE(folder.files(), before) << "it never began to write";
    program.send(SIGINT);
    EXPECT_EQ(program.wait().code, -SIGINT);
    wait_for_file(folder / "ended");
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    fs::remove(folder / "begun");
    fs::remove(folder / "ended");
    EXPECT_EQ(folder.files(), before);
  }
}

TEST_F(Video, RejectsConflictingOptions) {
  if (!have_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  const Words video = {"--path", path, "-o", folder / "a.webm"};
  expect_refused({{{"--exr", "half"}, "is a video"},
                  {{"--background", "none"}, "no alpha"},
                  {{"--layout", "separate"}, "must be a folder"}},
                 video);
  json other = camera_json("b", 0.1);
  other["width"] = 80;
  save("path.json", json({camera_json("a", 0), other}));
  expect_refused({{video, "72 x 48 and 80 x 48 px"}});
}

}  // namespace
}  // namespace binosplat
