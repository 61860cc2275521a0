// Where thresholds fail: every rule on every case, frame by frame against exact frames, with verdicts that
// follow from stated bounds. BINOSPLAT_LONG=1 prints the tables of
// bench/results/stability.md.

#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "base/statistics.h"
#include "formats/cameras_file.h"
#include "formats/model_file.h"
#include "lab/rule.h"
#include "lab/stability_cases.h"
#include "measure/depth_table.h"
#include "measure/metrics.h"
#include "render/frame.h"
#include "stereo/disagreement.h"
#include "support/gl.h"
#include "support/models.h"
#include "support/scenes.h"

namespace binosplat::lab {
namespace {

/// A case holds if none of these is broken.
struct StabilityBounds {
  double worst_db = 34.0;    // no frame below
  double settled_db = 37.0;  // the median of the last third of the frames
  double darkening = 0.004;  // no frame's mean signed error beyond, either way
  double drift_db =
      0.5;  // of a still camera from the second third to the last, of the medians: no fall beyond
  std::size_t settling = 3;  // frames after the event until, and for good, none is below settled_db and more
                             // than 1 dB below what is settled to
  double disagreement_db = 34.0;  // no frame below
};

struct StabilityResult {
  double worst_db = 0.0, settled_db = 0.0, drift_db = 0.0;
  double signed_mean = 0.0;  // of the frame where it is farthest from 0: below 0 is darker
  double disagreement_db = std::numeric_limits<double>::infinity();  // the least of any frame
  std::size_t settling = 0;
  double removed = 0.0;  // share of the exact frames' pairs
  std::string verdict;   // "holds", or the bounds that it breaks
};

struct ExactCase {
  std::vector<std::vector<Picture>> pictures;  // by frame; of a still camera one
  std::vector<double> pairs;
  DepthTable table;

  const std::vector<Picture>& of(std::size_t n) const {
    return pictures.size() == 1 ? pictures[0] : pictures[n];
  }
};

bool is_still(const StabilityCase& one) {
  const Camera &first = one.frames.front().cameras[0], &last = one.frames.back().cameras[0];
  return first.position == last.position && first.rotation == last.rotation;
}

ExactCase exact_case(render::Frame& frame, const StabilityCase& one) {
  ExactCase exact;
  for (const stereo::EyePair& eyes : one.frames) {
    const bool again = is_still(one) && !exact.pairs.empty();
    exact.pairs.push_back(again ? exact.pairs[0] : static_cast<double>(frame.draw(eyes.views).pairs));
    if (!again) exact.pictures.push_back(frame.read_pictures());
  }
  exact.table = measure::measure_depth_table(frame, one.frames[0].views);
  return exact;
}

double median(const std::vector<double>& values, std::size_t begin, std::size_t end) {
  return quantile({values.begin() + static_cast<std::ptrdiff_t>(begin),
                   values.begin() + static_cast<std::ptrdiff_t>(end)},
                  0.5);
}

double mean_signed(const std::vector<Picture>& drawn, const std::vector<Picture>& exact) {
  double sum = 0.0, count = 0.0;
  for (std::size_t eye = 0; eye < exact.size(); ++eye) {
    const Image a = measure::clamped(on_black(drawn[eye])), b = measure::clamped(on_black(exact[eye]));
    for (std::size_t k = 0; k < a.data.size(); ++k) sum += double{a.data[k]} - double{b.data[k]};
    count += static_cast<double>(a.data.size());
  }
  return sum / count;
}

std::string verdict_of(const StabilityResult& r, const StabilityBounds& bounds) {
  std::vector<std::string> broken;
  if (r.worst_db < bounds.worst_db) broken.emplace_back("dip");
  if (r.settled_db < bounds.settled_db) broken.emplace_back("wrong");
  if (r.drift_db < -bounds.drift_db) broken.emplace_back("drift");
  if (r.settling > bounds.settling) broken.emplace_back("slow");
  if (r.signed_mean < -bounds.darkening) broken.emplace_back("dark");
  if (r.signed_mean > bounds.darkening) broken.emplace_back("bright");
  if (r.disagreement_db < bounds.disagreement_db) broken.emplace_back("rivalry");
  return broken.empty() ? "holds" : fmt::format("{}", fmt::join(broken, ", "));
}

StabilityResult run_rule(render::Frame& frame, const StabilityCase& one, const ExactCase& exact,
                         const Rule& rule, const StabilityBounds& bounds) {
  render::FrameSettings settings = rule.settings();
  settings.depth_table = exact.table;
  // Of a still camera the frames that do not measure show what the next one shows: nothing new.
  if (is_still(one)) settings.measure_every = 1;
  frame.forget();
  StabilityResult r;
  std::vector<double> db;
  double pairs = 0.0, exact_pairs = 0.0;
  for (std::size_t n = 0; n < one.frames.size(); ++n) {
    pairs += static_cast<double>(frame.draw(one.frames[n].views, settings).pairs);
    exact_pairs += exact.pairs[n];
    const std::vector<Picture> drawn = frame.read_pictures();
    db.push_back(measure::psnr(drawn, exact.of(n), glm::vec3(0.0f)));
    const double signed_mean = mean_signed(drawn, exact.of(n));
    if (std::abs(signed_mean) > std::abs(r.signed_mean)) r.signed_mean = signed_mean;
    // Not a number where the eyes have no depth in common.
    const double apart = stereo::disagreement(one.frames[n].views, exact.of(n), drawn).db;
    if (apart < r.disagreement_db) r.disagreement_db = apart;
  }
  r.removed = 1.0 - pairs / exact_pairs;
  r.worst_db = *std::min_element(db.begin(), db.end());
  const std::size_t third = std::max<std::size_t>(1, db.size() / 3);
  r.settled_db = median(db, db.size() - third, db.size());
  if (is_still(one) && db.size() >= 3 && std::isfinite(r.settled_db))
    r.drift_db = r.settled_db - median(db, db.size() - 2 * third, db.size() - third);
  for (std::size_t n = one.event; n < db.size(); ++n) {
    if (db[n] < std::min(r.settled_db - 1.0, bounds.settled_db)) r.settling = n + 1 - one.event;
  }
  r.verdict = verdict_of(r, bounds);
  return r;
}

StabilityResult run_one(const StabilityCase& one, const Rule& rule, const StabilityBounds& bounds = {}) {
  render::Frame frame(test::gl_context(), *one.model);
  return run_rule(frame, one, exact_case(frame, one), rule, bounds);
}

StabilityCase small_case(std::size_t frames) {
  Camera head = test::front_camera(64, 48, 60);
  StabilityCase one{"small", std::make_shared<const Model>(test::random_model(71, 2500, 0)), {}, 0};
  for (std::size_t n = 0; n < frames; ++n) {
    one.frames.push_back(stereo::make_rig(head, {.ipd = 0.05}));
    head.position.x += 0.002;
  }
  return one;
}

TEST(Stability, EveryRuleIsThereOnce) {
  std::set<std::string> names;
  for (const Rule& rule : all_rules()) names.insert(rule.name());
  EXPECT_EQ(names.size(), all_rules().size());
  EXPECT_EQ(names.size(), 1u + 2 * 3);  // tau; both thresholds by 3 sources
  EXPECT_TRUE(names.count("squared, last"));
  EXPECT_EQ(all_rules().front().th, TH_TAU);
}

TEST(Stability, ExactFramesHoldWhateverTheBounds) {
  const StabilityResult r = run_one(small_case(4), {.th = TH_TAU});
  EXPECT_EQ(r.verdict, "holds");
  EXPECT_TRUE(std::isinf(r.worst_db));
  EXPECT_EQ(r.removed, 0.0);
  EXPECT_EQ(r.drift_db, 0.0);
}

TEST(Stability, VerdictsFollowFromTheirBounds) {
  const StabilityCase one = small_case(6);
  const Rule rough{.th = TH_SQUARED, .transmittance = TRANSMITTANCE_LAST, .tolerance = 2.0f};
  const StabilityResult r = run_one(one, rough);
  EXPECT_GT(r.removed, 0.1);
  EXPECT_LT(r.signed_mean, 0.0);
  // Bounds on either side of what was measured, one at a time.
  const StabilityBounds wide{0.0, 0.0, 1.0, 100.0, 100, 0.0};
  EXPECT_EQ(verdict_of(r, wide), "holds");
  StabilityBounds tight = wide;
  tight.worst_db = r.worst_db + 0.1;
  EXPECT_EQ(verdict_of(r, tight), "dip");
  tight = wide;
  tight.settled_db = r.settled_db + 0.1;
  EXPECT_EQ(verdict_of(r, tight), "wrong");
  tight = wide;
  tight.darkening = -0.9 * r.signed_mean;
  EXPECT_EQ(verdict_of(r, tight), "dark");
  tight = wide;
  tight.disagreement_db = r.disagreement_db + 0.1;
  EXPECT_EQ(verdict_of(r, tight), "rivalry");
}

TEST(Stability, AJumpIsWhereSettlingIsCountedFrom) {
  // Frames of another place at the end: what is settled to is theirs, and the ones before the jump do not
  // count.
  StabilityCase one = small_case(9);
  Camera there = test::front_camera(64, 48, 60);
  there.position.z = 1.5;
  for (std::size_t n = 3; n < 9; ++n) one.frames[n] = stereo::make_rig(there, {.ipd = 0.05});
  one.event = 3;
  const StabilityResult r =
      run_one(one, {.th = TH_SQUARED, .transmittance = TRANSMITTANCE_LAST, .tolerance = 0.5f});
  EXPECT_LE(r.settling, 5u);
  EXPECT_NEAR(r.drift_db, 0.0, 1.5);
}

TEST(Stability, TheCasesShowSomething) {
  std::set<std::string> names;
  for (const StabilityCase& one : built_in_cases()) {
    names.insert(one.name);
    EXPECT_GE(one.frames.size(), 24u) << one.name;
    render::Frame frame(test::gl_context(), *one.model);
    frame.draw(one.frames.front().views);
    double covered = 0;
    for (const Picture& eye : frame.read_pictures()) {
      for (const glm::vec4& pixel : eye.colour) covered += 1.0 - pixel.a;
    }
    EXPECT_GT(covered, 0.5 * 2 * 128 * 96) << one.name << " covers too little of the picture";
  }
  EXPECT_EQ(names.size(), 8u);
}

/// The tolerances that come to 40 dB on a pair of fox that stands still, by rule.
const std::map<std::string, float> fox_tolerances = {{"tau", 0.0f},
                                                     {"peripheral, one", 0.2535f},
                                                     {"peripheral, depth", 0.2535f},
                                                     {"peripheral, last", 0.2259f},
                                                     {"squared, one", 0.00985f},
                                                     {"squared, depth", 0.00985f},
                                                     {"squared, last", 0.00754f}};

/// What is broken, by case and rule: by thousands of faint Gaussians that lie one behind the other, and by a
/// wall of small ones, whose tails are left out of tiles and blocks. All else holds.
const std::map<std::pair<std::string, std::string>, std::string> broken_verdicts = {
    {{"far-wall", "squared, one"}, "dark"},           {{"far-wall", "squared, depth"}, "dark"},
    {{"far-wall", "squared, last"}, "dark"},          {{"mist", "squared, one"}, "dark"},
    {{"mist", "squared, depth"}, "dip, wrong, dark"}, {{"mist", "squared, last"}, "dip, wrong, dark"}};

TEST(Stability, EveryRuleOnEveryCaseIsAsTheTableSays) {
  if (!test::switched_on("BINOSPLAT_LONG")) GTEST_SKIP() << "minutes on llvmpipe: set BINOSPLAT_LONG=1";
  REQUIRE_SCENE("fox", folder);
  const auto fox = std::make_shared<const Model>(load_model(folder / "fox.ply"));
  Camera head = load_cameras(folder / "cameras.json").front();
  head = resized(head, 120, 200);
  std::vector<StabilityCase> cases = built_in_cases();
  for (StabilityCase& one : cases_in(fox, head, {.ipd = 0.11})) cases.push_back(std::move(one));
  std::map<std::string, std::string> rows;
  for (const StabilityCase& one : cases) {
    render::Frame frame(test::gl_context(), *one.model);
    const ExactCase exact = exact_case(frame, one);
    for (Rule rule : all_rules()) {
      const std::string name = rule.name();
      rule.tolerance = fox_tolerances.at(name);
      const StabilityResult r = run_rule(frame, one, exact, rule, {});
      const auto broken = broken_verdicts.find({one.name, name});
      EXPECT_EQ(r.verdict, broken != broken_verdicts.end() ? broken->second : "holds")
          << one.name << ": " << name << ", signed " << r.signed_mean;
      rows[name] += fmt::format(" {:.1f} / {:.1f}{} |", r.worst_db, r.settled_db,
                                r.verdict == "holds" ? "" : " **" + r.verdict + "**");
    }
  }
  fmt::print("| rule |");
  for (const StabilityCase& one : cases) fmt::print(" {} |", one.name);
  for (const Rule& rule : all_rules()) fmt::print("\n| {} |{}", rule.name(), rows[rule.name()]);
  fmt::print("\n");
}

}  // namespace
}  // namespace binosplat::lab
