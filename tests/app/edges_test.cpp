// What every sub-command must withstand: empty arguments, outputs that are inputs, full disks, hangups.

#include <chrono>
#include <csignal>
#include <thread>

#include "app/scene.h"

namespace binosplat {
namespace {

using test::ended;
using test::good;
using test::read_text;
using test::run_program;
using test::write_text;

struct Edges : test::SceneTest {
  Edges() { add_cameras(); }
};

TEST_F(Edges, EmptyArgumentsAreRefused) {
  ASSERT_TRUE(good(render({"--view", "front", "--mono", "-o", folder / "a.png"})));
  const std::string a = folder / "a.png";
  EXPECT_TRUE(good(run_program({"compare", a, a, "--min-psnr", "50"})));
  EXPECT_TRUE(
      ended(run_program({"compare", a, a, "--min-psnr", ""}), 2, "--min-psnr '': its value is empty"));
  EXPECT_TRUE(ended(run_program({"compare", a, ""}), 2, "argument 3 is empty"));
  EXPECT_TRUE(ended(render({"-o", ""}), 2, "-o '': its value is empty"));
  EXPECT_TRUE(ended(render({"--json", "", "-o", out}), 2, "--json '': its value is empty"));
  EXPECT_TRUE(ended(run_program({"view", ""}), 2, "argument 2 is empty"));
}

TEST_F(Edges, InputsAreNeverOverwritten) {
  ASSERT_TRUE(good(render({"--view", "front", "--mono", "-o", folder / "a.png"})));
  std::filesystem::copy(folder / "a.png", folder / "b.png");
  std::filesystem::create_symlink(model, folder / "link.ply");
  std::filesystem::create_directories(folder / "photos");
  std::filesystem::copy(folder / "a.png", folder / "photos/front.png");
  const std::string cameras = folder / "cameras.json", a = folder / "a.png", b = folder / "b.png";
  const std::vector<std::vector<std::string>> cases = {
      {"calibrate", model, "-o", model, "--quality", "40"},
      {"calibrate", model, "-o", folder / "link.ply", "--quality", "40"},
      {"render", model, "--json", model, "-o", out},
      {"render", model, "--json", cameras, "-o", out},  // found beside the model
      {"render", model, "--cameras", cameras, "--json", cameras, "-o", out},
      {"render", model, "--view", "front", "--mono", "--photos", folder / "photos", "-o", folder / "photos"},
      {"convert", model, "-o", cameras, "--to", "ply", "--cameras", cameras, "--report"},
      {"info", model, "--json", model},
      {"compare", a, b, "--difference", a},
      {"compare", a, b, "--json", b},
  };
  const auto before = [&] {
    std::vector<std::string> all;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path()))
      if (entry.is_regular_file() && entry.path().string().rfind(out, 0) != 0)
        all.push_back(entry.path().string() + read_text(entry.path()));
    std::sort(all.begin(), all.end());
    return all;
  };
  const auto files = before();
  for (const auto& arguments : cases) {
    EXPECT_TRUE(ended(run_program(arguments), 2, "this run reads it, and it would be lost")) << arguments[0];
    EXPECT_EQ(before(), files) << arguments[0];
  }
  // What a run wrote may be written again.
  EXPECT_TRUE(good(render({"--view", "front", "--mono", "-o", a})));
}

TEST_F(Edges, OutputsAreFilesOfTheirOwn) {
  std::filesystem::create_symlink(folder / "q.png", folder / "link.png");
  std::filesystem::create_directory_symlink(folder.path(), folder / "here");
  const std::string q = folder / "q.png";
  const auto one_view = [&](const std::string& output, const std::string& json,
                            const std::vector<std::string>& more = {}) {
    std::vector<std::string> all = {"--view", "front", "--mono", "--size", "36x24",
                                    "-o",     output,  "--json", json};
    all.insert(all.end(), more.begin(), more.end());
    return render(all);
  };
  for (const char* same : {"q.png", "./q.png", "here/q.png", "link.png", "photos/../q.png"})
    EXPECT_TRUE(ended(one_view(q, folder / same), 2, "it is what --output writes, too")) << same;
  EXPECT_TRUE(ended(one_view(folder.path(), folder / "front.png"), 2, "it is the picture of front"));
  EXPECT_TRUE(ended(one_view(q, folder / "q.exr", {"--exr", "half"}), 2, "it is the picture of front"));
  EXPECT_TRUE(ended(run_program({"convert", model, "-o", folder / "a.sog", "--json", folder / "./a.sog"}), 2,
                    "it is what --output writes, too"));
  EXPECT_FALSE(std::filesystem::exists(q));
  EXPECT_TRUE(good(one_view(q, folder / "q.json"))) << "planted: others are not one file";
  EXPECT_TRUE(ended(run_program({"compare", q, q, "--difference", folder / "d", "--json", folder / "./d"}), 2,
                    "it is what --json writes, too"));
}

TEST_F(Edges, PhotosBesideAreNotDrawnOver) {
  ASSERT_TRUE(good(render({"--view", "front", "--mono", "-o", folder / "images"})));
  EXPECT_TRUE(ended(render({"--view", "front", "--mono", "--photos", "beside", "-o", folder / "images"}), 2,
                    "this run reads it, and it would be lost"));
}

TEST_F(Edges, NumbersHaveRanges) {
  const std::string to = folder / "to.ply";
  const std::vector<std::vector<std::string>> lines = {
      {"render", model, "-o", out, "--quality"},   {"trim", model, "-o", to, "--quality"},
      {"calibrate", model, "-o", to, "--quality"}, {"study", model, "--motion", "--target"},
      {"study", model, "--motion", "--quality"},
  };
  for (std::vector<std::string> line : lines) {
    line.emplace_back();
    for (const char* number : {"nan", "inf", "4000", "-40", "9.9", "100.1"}) {
      line.back() = number;
      EXPECT_TRUE(ended(run_program(line), 2, "expected decibels from 10 to 100")) << line[0] << number;
    }
  }
  const std::vector<std::vector<std::string>> others = {
      {"render", model, "-o", out, "--tolerance"},
      {"render", model, "-o", out, "--near"},
      {"render", model, "-o", out, "--fov"},
      {"render", model, "-o", out, "--fps"},
      {"render", model, "-o", out, "--kernel-px2"},
      {"render", model, "-o", out, "--gpu-memory"},
      {"render", model, "-o", out, "--max-memory"},
      {"render", model, "-o", out, "--units-per-metre"},
      {"render", model, "-o", out, "--ipd"},
      {"render", model, "-o", out, "--cant"},
      {"render", model, "-o", out, "--convergence"},
      {"render", model, "-o", out, "--spacing"},
      {"render", model, "-o", out, "--detail"},
      {"render", model, "-o", out, "--seconds"},
      {"trim", model, "-o", to, "--max-drop"},
      {"calibrate", model, "-o", to, "--max-drop"},
      {"calibrate", model, "-o", to, "--far"},
      {"compare", model, model, "--min-psnr"},
      {"compare", model, model, "--ppd"},
      {"compare", model, model, "--max-memory"},
      {"bench", model, "--ppd"},
      {"study", model, "--ipd"},
      {"study", model, "--units-per-metre"},
  };
  for (std::vector<std::string> line : others) {
    line.emplace_back("nan");
    EXPECT_TRUE(ended(run_program(line), 2, "nan")) << line[0] << line[line.size() - 2];
  }
  EXPECT_FALSE(std::filesystem::exists(out));
  EXPECT_FALSE(std::filesystem::exists(to));
}

TEST_F(Edges, LinksInACircleAreNamed) {
  std::filesystem::create_symlink(folder / "b", folder / "a");
  std::filesystem::create_symlink(folder / "a", folder / "b");
  std::filesystem::create_symlink(folder / "nowhere", folder / "dangling");
  for (const char* to : {"a", "a/deeper", "dangling", "dangling/deeper"}) {
    EXPECT_TRUE(ended(run_program({"levels", model, "-o", folder / to}), 2, "symbolic link")) << to;
    EXPECT_TRUE(ended(run_program({"bench", model, "-o", folder / to}), 2, "symbolic link")) << to;
    EXPECT_TRUE(ended(render({"--resume", "-o", folder / to}), 2, "symbolic link")) << to;
  }
  std::filesystem::create_symlink(folder / "c.png", folder / "c.png");
  EXPECT_TRUE(ended(render({"--mono", "-o", folder / "c.png"}), 2, "lead in a circle"));
}

TEST_F(Edges, NamesOfViewsArePlain) {
  for (const std::string& bad : {std::string("a\x1b[31m"), std::string("a\0b", 3), std::string("a\nb")}) {
    const nlohmann::json cameras = {test::camera_json(bad, 0.0)};
    write_text(folder / "cameras.json", cameras.dump());
    const auto outcome = render({"-o", out});
    EXPECT_TRUE(ended(outcome, 2, "has a control character"));
    EXPECT_EQ(outcome.err.find('\x1b'), std::string::npos);
    EXPECT_EQ(outcome.err.find('\0'), std::string::npos);
  }
}

TEST_F(Edges, EveryViewHasAFileOfItsOwn) {
  nlohmann::json cameras;
  for (const char* name :
       {"a_left", "a_right", "a", "a.jpg", "a_2", "a.png", "A", "b/c", "b_c", "b_c_2", ".", ".."})
    cameras.push_back(test::camera_json(name, 0.1 * static_cast<double>(cameras.size())));
  write_text(folder / "cameras.json", cameras.dump());
  const auto files = [&](std::vector<std::string> arguments) {
    std::filesystem::remove_all(out);
    arguments.insert(arguments.begin(), {"--view", "all", "-o", out});
    EXPECT_TRUE(good(render(arguments)));
    return std::distance(std::filesystem::directory_iterator(out), {});
  };
  EXPECT_EQ(files({}), 2 * 11) << "the first two are a pair";
  EXPECT_EQ(files({"--mono"}), 12);
}

TEST_F(Edges, AFullStandardOutputIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const std::string run =
      std::string(BINOSPLAT_PROGRAM) + " info " + model + " > /dev/full 2> " + (folder / "err").string();
  EXPECT_EQ(WEXITSTATUS(std::system(run.c_str())), 2);
  EXPECT_NE(read_text(folder / "err").find("cannot write to standard output: No space left"),
            std::string::npos)
      << read_text(folder / "err");
}

TEST_F(Edges, AFullDiskKeepsNoShaders) {
  test::Surroundings full;
  full.variables["XDG_CACHE_HOME"] = "/proc";  // has no room
  const auto outcome = render({"--view", "front", "--mono", "-o", out}, full);
  EXPECT_TRUE(good(outcome));
  EXPECT_NE(outcome.err.find("/proc: the disk is full; drivers keep no shaders there"), std::string::npos);
  EXPECT_EQ(render({"--view", "front", "--mono", "-o", out}).err.find("the disk is full"), std::string::npos);
}

// Neither by the program nor by the driver, which has a cache of its own there.
TEST_F(Edges, ARelativeFolderOfCachesIsIgnored) {
  const test::TempFolder here, home;
  test::Surroundings caching{.folder = here.path()};
  caching.variables["HOME"] = home.path().string();
  for (const char* relative : {"caches", "./caches", ""}) {
    caching.variables["XDG_CACHE_HOME"] = relative;
    ASSERT_TRUE(good(render({"--view", "front", "--mono", "-o", out}, caching)));
    EXPECT_TRUE(here.names().empty()) << relative;
  }
  EXPECT_TRUE(std::filesystem::exists(home / ".cache/binosplat/programs"));
  caching.variables["XDG_CACHE_HOME"] = here / "caches";
  ASSERT_TRUE(good(render({"--view", "front", "--mono", "-o", out}, caching)));
  EXPECT_TRUE(std::filesystem::exists(here / "caches/binosplat/programs"));
}

TEST_F(Edges, AFolderInPlaceOfACachedProgramIsNoProgram) {
  test::Surroundings caching;
  caching.variables["XDG_CACHE_HOME"] = (folder / "cache").string();
  ASSERT_TRUE(good(render({"--view", "front", "--mono", "-o", out}, caching)));
  int programs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "cache/binosplat/programs")) {
    std::filesystem::remove(entry.path());
    std::filesystem::create_directory(entry.path());
    ++programs;
  }
  EXPECT_GT(programs, 0);
  EXPECT_TRUE(good(render({"--view", "front", "--mono", "-o", out}, caching)));
}

TEST_F(Edges, AHangupLeavesNoHalfFile) {
  const auto before = folder.files();
  test::Program program({"render", model, "-o", out, "--frames", "100000"});
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (program.said().find("drawing with") == std::string::npos && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  program.send(SIGHUP);
  EXPECT_EQ(program.wait().code, -SIGHUP);
  EXPECT_EQ(folder.files(), before);
}

}  // namespace
}  // namespace binosplat
