#include "study/stability_page.h"

#include <gtest/gtest.h>

namespace binosplat::study {
namespace {

using nlohmann::ordered_json;

ordered_json rule(const std::string& verdict, double worst) {
  return {{"verdict", verdict},          {"worst_db", worst},          {"worst_frame", 3},
          {"settled_db", 41.5},          {"settling_frames", 2},       {"largest_error", 0.25},
          {"mean_signed_error", -0.001}, {"disagreement_db", nullptr}, {"pairs_removed", 0.5}};
}

ordered_json results() {
  ordered_json json = {{"scene", "fox"},
                       {"device", "llvmpipe"},
                       {"target_db", 40.0},
                       {"bounds", {{"dips: a frame below dB", 34.0}}},
                       {"losses", {{"tau", 0.0}, {"one", 2.0}, {"last", 0.5}}}};
  json["cases"]["jump"] = {
      {"fear", "a cut"},
      {"rules", {{"tau", rule("holds", 99)}, {"one", rule("dips", 30)}, {"last", rule("holds", 38)}}}};
  json["cases"]["mist"] = {
      {"fear", "faint crowds"},
      {"rules", {{"tau", rule("holds", 99)}, {"one", rule("holds", 39)}, {"last", rule("holds", 37)}}}};
  return json;
}

TEST(StabilityPage, SaysWhichRulesHold) {
  const Page page = stability_page(results());
  ASSERT_EQ(page.sections.size(), 4u);
  EXPECT_NE(page.sentence.find("“last” holds in 2 of them"), std::string::npos) << page.sentence;
  const Table& verdicts = *page.sections[0].table;
  EXPECT_EQ(verdicts.columns, (std::vector<std::string>{"rule", "loss", "cases that hold", "jump", "mist"}));
  EXPECT_EQ(verdicts.rows[1], ordered_json({"one", 2.0, 1, "dips", "holds"}));
  EXPECT_EQ(verdicts.rows[2], ordered_json({"last", 0.5, 2, "holds", "holds"}));
  EXPECT_EQ(page.sections[3].id, "case-mist");
  EXPECT_EQ(page.sections[3].table->rows[2],
            ordered_json({"last", 37.0, 3, 41.5, 2, 0.25, -0.001, nullptr, 50.0, "holds"}));
  EXPECT_EQ(page.data, results());
  // Broken everywhere: nothing is praised.
  ordered_json bad = results();
  for (auto& [name, one] : bad["cases"].items())
    one["rules"]["last"]["verdict"] = one["rules"]["one"]["verdict"] = "dips";
  EXPECT_EQ(stability_page(bad).sentence.find("“"), std::string::npos) << stability_page(bad).sentence;
}

}  // namespace
}  // namespace binosplat::study
