// Speeds of the CPU's work: reading and writing files. They are in bytes per second of the file or of the
// picture's 8-bit pixels (M and G are 10^6 and 10^9). If BINOSPLAT_SCENES is set (README.md), real scenes are
// measured as well.

#include <benchmark/benchmark.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>

#include "base/output_file.h"
#include "formats/cameras/cameras_file.h"
#include "formats/models/model_file.h"
#include "formats/pictures/image_file.h"
#include "support/ply.h"

namespace {

namespace fs = std::filesystem;
using namespace binosplat;

void write_text(const fs::path& path, const std::string& text) {
  OutputFile file(path);
  file.write(text);
  file.commit();
}

/// Times `work`, which processes `bytes` bytes.
template <typename Work>
void measure(const std::string& name, double bytes, const Work& work) {
  const auto body = [=](benchmark::State& state) {
    for ([[maybe_unused]] auto _ : state) work();
    state.counters["bytes"] = benchmark::Counter(bytes, benchmark::Counter::kIsIterationInvariantRate);
  };
  benchmark::RegisterBenchmark(name.c_str(), body)->Unit(benchmark::kMillisecond)->UseRealTime();
}

void measure_loading(const std::string& name, const fs::path& path) {
  measure("load " + name, static_cast<double>(fs::file_size(path)),
          [=] { benchmark::DoNotOptimize(load_model(path)); });
}

void measure_cameras(const std::string& name, const fs::path& path) {
  measure("load " + name, static_cast<double>(fs::file_size(path)),
          [=] { benchmark::DoNotOptimize(load_cameras(path)); });
}

void add_plys(const fs::path& folder) {
  const auto add = [&](const std::string& name, const std::string& format, std::size_t count) {
    test::PlyFile file = test::inria_file(3, count);
    file.format = format;
    const fs::path path = folder / (name + ".ply");
    write_text(path, to_bytes(file));
    measure_loading(name + ".ply", path);
  };
  add("100k", "binary_little_endian", 100'000);
  add("400k", "binary_little_endian", 400'000);
  add("100k_big_endian", "binary_big_endian", 100'000);
  add("20k_ascii", "ascii", 20'000);
}

void add_cameras(const fs::path& folder) {
  std::string text;
  for (int i = 0; i < 1000; ++i) {
    text += fmt::format(
        "{}{{\"id\": {}, \"img_name\": \"{:04}\", \"width\": 1920, \"height\": 1080, \"position\": [{}, "
        "1.25, -3.5], "
        "\"rotation\": [[0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [-0.8, 0.0, 0.6]], \"fx\": 1375.5, \"fy\": "
        "1376.25}}",
        i == 0 ? "[" : ",\n", i, i, i * 0.0123456789);
  }
  write_text(folder / "cameras.json", text + "]\n");
  measure_cameras("1000 cameras", folder / "cameras.json");
}

/// Returns slow gradients with a little noise, which compress about as well as a drawn picture.
Image picture(int width, int height) {
  Image image(width, height, 3);
  test::Uniform uniform(5);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 3; ++c) {
        const double wave = 0.5 + 0.4 * std::sin(0.01 * x + c) * std::cos(0.013 * y);
        image.at(x, y, c) = static_cast<float>(wave + uniform(-0.01, 0.01));
      }
    }
  }
  return image;
}

void add_png(const fs::path& folder) {
  const Image image = picture(1920, 1080);
  const fs::path path = folder / "picture.png";
  measure("save 1920x1080 RGB as 8-bit PNG", static_cast<double>(image.data.size()),
          [=] { save_png(path, image); });
  save_png(path, image);
  measure("load 1920x1080 RGB of 8-bit PNG", static_cast<double>(image.data.size()),
          [=] { benchmark::DoNotOptimize(load_image(path)); });
}

void add_scenes() {
  const char* scenes = std::getenv("BINOSPLAT_SCENES");
  if (scenes == nullptr) return;
  for (const std::string name : {"fox", "garden"}) {
    const fs::path folder = fs::path(scenes) / name;
    measure_loading(name + ".ply", folder / (name + ".ply"));
    measure_cameras("cameras of " + name, folder / "cameras.json");
  }
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  const fs::path folder = fs::temp_directory_path() / fmt::format("binosplat-bench-{}", getpid());
  add_plys(folder);
  add_cameras(folder);
  add_png(folder);
  add_scenes();
  benchmark::RunSpecifiedBenchmarks();
  fs::remove_all(folder);
  return 0;
}
