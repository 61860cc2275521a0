#include "lab/stability_page.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace binosplat::lab {
namespace {

StabilityResult result(const std::string& verdict, double worst) {
  return {.worst_db = worst,
          .worst_frame = 3,
          .settled_db = 41.5,
          .largest = 0.25,
          .signed_mean = -0.001,
          .disagreement_db = INFINITY,
          .settling = 2,
          .removed = 0.5,
          .verdict = verdict};
}

StabilityStudy stability_results() {
  return {
      .scene = "fox",
      .device = "llvmpipe",
      .target = 40.0,
      .rules = {{.th = TH_TAU},
                {.tolerance = 2.0f},
                {.transmittance = TRANSMITTANCE_LAST, .tolerance = 0.5f}},
      .cases = {{"jump", "a cut", {result("holds", 99), result("dips", 30), result("holds", 38)}},
                {"mist", "faint crowds", {result("holds", 99), result("holds", 39), result("holds", 37)}}}};
}

TEST(StabilityPage, SaysWhichRulesHold) {
  const Page page = stability_page(stability_results());
  ASSERT_EQ(page.sections.size(), 4u);
  EXPECT_NE(page.sentence.find("“squared, last” holds in 2 of them"), std::string::npos) << page.sentence;
  const Table& verdicts = *page.sections[0].table;
  EXPECT_EQ(verdicts.columns,
            (std::vector<std::string>{"rule", "tolerance", "cases that hold", "jump", "mist"}));
  EXPECT_EQ(verdicts.rows[1], row("squared, one", 2.0, 1, "dips", "holds"));
  EXPECT_EQ(verdicts.rows[2], row("squared, last", 0.5, 2, "holds", "holds"));
  EXPECT_EQ(page.sections[3].id, "case-mist");
  EXPECT_EQ(page.sections[3].table->rows[2],
            row("squared, last", 37.0, 3, 41.5, 2, 0.25, -0.001, INFINITY, 50.0, "holds"));
  const nlohmann::ordered_json json = nlohmann::ordered_json::parse(to_json(stability_results()).dump());
  EXPECT_EQ(json["bounds"]["dips: a frame below dB"], 34.0);
  EXPECT_EQ(json["tolerances"]["squared, last"], 0.5);
  EXPECT_TRUE(json["cases"]["mist"]["rules"]["squared, last"]["disagreement_db"].is_null());
  // Broken everywhere: nothing is praised.
  StabilityStudy bad = stability_results();
  for (StabilityStudy::Case& one : bad.cases) one.results[1].verdict = one.results[2].verdict = "dips";
  EXPECT_EQ(stability_page(bad).sentence.find("“"), std::string::npos) << stability_page(bad).sentence;
}

}  // namespace
}  // namespace binosplat::lab
