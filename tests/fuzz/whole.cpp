// fuzz_whole COUNT [SEED] gives mutated files to the whole program. It must load each one, or refuse it with
// a clear error: no signal, no internal error, no half-written output, within limits of time and memory. The
// output of `convert` must load with the same number of Gaussians. Mutations start from the corpus, from
// models that `convert` writes, and from the files in BINOSPLAT_FORMATS. The same SEED makes the same files.

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <charconv>
#include <chrono>
#include <map>
#include <mutex>
#include <thread>

#include "base/text.h"
#include "formats/models/registry.h"
#include "support/damage.h"
#include "support/program.h"

namespace {

namespace fs = std::filesystem;
using binosplat::test::Outcome;
using binosplat::test::run_program;
using binosplat::test::TempFolder;
using binosplat::test::Uniform;

constexpr std::size_t max_seed_bytes = 300000;  // bytes
constexpr double max_seconds = 20.0;            // per run, on a busy machine
// Limit of a run's memory: that of a million Gaussians, which even a small file may promise.
constexpr long max_kib = 400 * 1024;

struct Seed {
  std::string kind;  // model, picture or cameras
  std::string name;
  std::string bytes;
};

// Results for the files with one extension.
struct Tally {
  int files = 0, taken = 0, converted = 0;
  double seconds = 0.0;  // maximum over runs
  long kib = 0;
};

std::string kind_of(const fs::path& path) {
  const std::string ending = path.extension();
  for (const binosplat::FormatRow& row : binosplat::format_rows())
    if (std::ranges::count(binosplat::words_of(row.endings), ending) > 0) return "model";
  for (const char* picture : {".png", ".jpg", ".exr"})
    if (ending == picture) return "picture";
  return ending == ".json" && path.string().find("camera") != std::string::npos ? "cameras" : "";
}

void add_seeds(const fs::path& folder, std::vector<Seed>& seeds) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && entry.file_size() <= max_seed_bytes) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    const bool cameras = folder.filename() == "corpus" && file.parent_path().filename() == "json";
    const std::string kind = cameras ? "cameras" : kind_of(file);
    if (!kind.empty()) seeds.push_back({kind, file.filename(), binosplat::test::read_text(file)});
  }
}

class Campaign {
 public:
  Campaign(std::uint64_t seed, fs::path findings) : seed_(seed), findings_(std::move(findings)) {
    const TempFolder made;
    for (const binosplat::ModelFormat format : binosplat::written_formats()) {
      const std::string file = made / ("room." + word_of(format));
      if (run_program({"convert", BINOSPLAT_SOURCE_DIR "/tests/fuzz/corpus/ply/degree_3.ply", "-o", file})
                  .code == 0 ||
          run_program({"convert", BINOSPLAT_SOURCE_DIR "/tests/fuzz/corpus/ply/ascii.ply", "-o", file})
                  .code == 0)
        seeds_.push_back({"model", fs::path(file).filename(), binosplat::test::read_text(file)});
    }
    add_seeds(BINOSPLAT_SOURCE_DIR "/tests/fuzz/corpus", seeds_);
    if (const char* formats = std::getenv("BINOSPLAT_FORMATS")) add_seeds(formats, seeds_);
  }

  std::size_t seeds() const { return seeds_.size(); }

  // Tries file number n, which is the same on every thread.
  void try_file(int n) {
    Uniform random(static_cast<std::uint32_t>(seed_ * 1000003 + static_cast<std::uint64_t>(n)));
    const Seed& seed = seeds_[static_cast<std::size_t>(n) % seeds_.size()];
    const TempFolder folder;
    const fs::path file = folder / seed.name;
    const std::string bytes = binosplat::test::damaged(seed.bytes, random, random(0, 10) < 6);
    binosplat::test::write_text(file, bytes);
    Tally tally{.files = 1};
    std::string problem;
    if (seed.kind == "model") {
      const auto format = static_cast<std::size_t>(random(0.0, static_cast<double>(written_.size())));
      problem = try_model(file, folder, word_of(written_[format]), tally);
    } else if (seed.kind == "picture") {
      Outcome outcome;
      problem = run({"compare", file, file}, {0, 1, 2, 4}, tally, outcome);
      tally.taken = outcome.code < 2 ? 1 : 0;
    } else {
      Outcome outcome;
      const std::string model = BINOSPLAT_SOURCE_DIR "/tests/fuzz/corpus/ply/ascii.ply";
      problem = run({"render", model, "--cameras", file, "--mono", "--size", "16x12", "-o", folder / "out"},
                    {0, 2, 4}, tally, outcome);
      tally.taken = outcome.code == 0 ? 1 : 0;
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    Tally& all = tallies_[fs::path(seed.name).extension()];
    all.files += tally.files;
    all.taken += tally.taken;
    all.converted += tally.converted;
    all.seconds = std::max(all.seconds, tally.seconds);
    all.kib = std::max(all.kib, tally.kib);
    if (problem.empty()) return;
    fs::create_directories(findings_);
    const fs::path kept = findings_ / fmt::format("whole-{}-{}-{}", seed_, n, seed.name);
    binosplat::test::write_text(kept, bytes);
    fmt::print("{}: {}\n", kept.string(), problem);
    std::fflush(stdout);
    ++found_;
  }

  int report() const {
    fmt::print("{:<10}{:>8}{:>8}{:>11}{:>11}{:>9}\n", "ending", "files", "taken", "converted", "most s",
               "most MB");
    for (const auto& [ending, tally] : tallies_)
      fmt::print("{:<10}{:>8}{:>8}{:>11}{:>11.2f}{:>9}\n", ending, tally.files, tally.taken, tally.converted,
                 tally.seconds, tally.kib / 1024);
    fmt::print("{} findings\n", found_);
    return found_ == 0 ? 0 : 1;
  }

 private:
  // Returns what is wrong with how a run ended, "" if nothing is.
  static std::string run(const std::vector<std::string>& arguments, std::initializer_list<int> codes,
                         Tally& tally, Outcome& outcome) {
    const auto start = std::chrono::steady_clock::now();
    outcome = run_program(arguments);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    tally.seconds = std::max(tally.seconds, seconds);
    tally.kib = std::max(tally.kib, outcome.peak_kib);
    const auto odd = [](unsigned char c) {
      return std::iscntrl(c) != 0 && c != '\n' && c != '\r' && c != '\t';
    };
    const std::string said = outcome.out + outcome.err;
    if (std::find(codes.begin(), codes.end(), outcome.code) == codes.end())
      return fmt::format("{} ended with {}: {}", arguments[0], outcome.code, outcome.err);
    if (outcome.err.find("internal error") != std::string::npos) return arguments[0] + ": " + outcome.err;
    if (outcome.code >= 2 && outcome.err.empty()) return arguments[0] + " failed and said nothing";
    if (std::any_of(said.begin(), said.end(), odd)) return arguments[0] + " printed control characters";
    if (seconds > max_seconds) return fmt::format("{} took {:.1f} s", arguments[0], seconds);
    if (outcome.peak_kib > max_kib)
      return fmt::format("{} took {} MB", arguments[0], outcome.peak_kib / 1024);
    return "";
  }

  static long gaussians(const Outcome& info) {
    const std::string label = "\nGaussians";  // The line break excludes the word within a title.
    std::size_t at = info.out.find(label);
    if (at == std::string::npos) return -1;
    at = info.out.find_first_not_of(' ', at + label.size());
    if (at == std::string::npos) return -1;
    long count = -1;
    std::from_chars(info.out.data() + at, info.out.data() + info.out.size(), count);
    return count;
  }

  static std::string try_model(const fs::path& file, const TempFolder& folder, const std::string& ending,
                               Tally& tally) {
    Outcome info, convert, back;
    std::string problem = run({"info", file}, {0, 2, 4}, tally, info);
    if (!problem.empty() || info.code != 0) return problem;
    tally.taken = 1;
    const std::string written = folder / ("written." + ending);
    problem = run({"convert", file, "-o", written}, {0, 2, 4}, tally, convert);
    if (!problem.empty()) return problem;
    for (const std::string& name : folder.files())
      if (name.find(".part-") != std::string::npos) return "left behind: " + name;
    if (convert.code != 0) return fs::exists(written) ? "convert failed and left " + written : "";
    tally.converted = 1;
    problem = run({"info", written}, {0}, tally, back);
    if (!problem.empty()) return problem + " of what convert wrote";
    if (gaussians(info) < 1 || gaussians(back) != gaussians(info))
      return fmt::format("{} Gaussians were written as {}, {} read back", gaussians(info), ending,
                         gaussians(back));
    return "";
  }

  std::uint64_t seed_;
  fs::path findings_;
  std::vector<Seed> seeds_;
  const std::vector<binosplat::ModelFormat> written_ = binosplat::written_formats();
  std::mutex mutex_;
  std::map<std::string, Tally> tallies_;
  int found_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 0;
  if (count < 1) {
    fmt::print(stderr, "fuzz_whole COUNT [SEED]\n");
    return 2;
  }
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  Campaign campaign(seed, fs::path(BINOSPLAT_SOURCE_DIR) / "build/fuzz/findings");
  fmt::print("{} files of {} seeds, seed {}\n", count, campaign.seeds(), seed);
  std::fflush(stdout);
  std::atomic<int> next = 0;
  std::vector<std::thread> threads;
  for (unsigned k = 0; k < std::max(1u, std::thread::hardware_concurrency()); ++k)
    threads.emplace_back([&] {
      for (int n = next++; n < count; n = next++) campaign.try_file(n);
    });
  for (std::thread& thread : threads) thread.join();
  return campaign.report();
}
