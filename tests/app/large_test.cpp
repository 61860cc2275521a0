// The sizes that matter, on whatever draws here.

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <nlohmann/json.hpp>

#include "support/program.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

TEST(Large, ACityOfFourMillionAtHeadsetSizeFitsIntoEightGigabytes) {
  if (!test::switched_on("BINOSPLAT_LONG")) GTEST_SKIP() << "a minute or two: set BINOSPLAT_LONG=1";
  const test::TempFolder folder;
  const test::Outcome outcome =
      test::run_program({"render", "demo:city", "--count", "4250000", "--mono", "--size", "4608x3456", "-o",
                         folder / "city.png", "--json", folder / "run.json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto run = nlohmann::json::parse(test::read_text(folder / "run.json"));
  EXPECT_EQ(run.at("scene").at("gaussians").get<std::size_t>(), 4'250'000u);
  EXPECT_GT(run.at("views")[0].at("pairs").get<std::size_t>(), 10'000'000u);
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  EXPECT_LT(usage.ru_maxrss, 8 << 20);  // KiB
  std::printf("peak %ld MiB\n", usage.ru_maxrss >> 10);
}

}  // namespace
}  // namespace binosplat
