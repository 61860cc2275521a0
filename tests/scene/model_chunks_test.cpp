// A model whose chunks are replaced.

#include "scene/model_chunks.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "scene/reduce.h"
#include "scene/summary.h"
#include "support/models.h"

namespace binosplat {
namespace {

constexpr std::size_t block = ModelChunks::block;

bool equal(const Model& a, std::size_t i, const Model& b, std::size_t k) {
  const auto values = 3 * static_cast<std::size_t>(sh_count(a.degree));
  return a.position[i] == b.position[k] && a.scale[i] == b.scale[k] && a.rotation[i] == b.rotation[k] &&
         a.opacity[i] == b.opacity[k] &&
         std::equal(&a.sh[values * i], &a.sh[values * (i + 1)], &b.sh[values * k]);
}

/// Returns whether the model has each chunk's Gaussians at its blocks, and draws no others.
testing::AssertionResult holds(const Model& model, const ModelChunks& chunks,
                               const std::vector<Model>& wanted) {
  std::size_t drawn = 0, total = 0;
  for (std::size_t p = 0; p < wanted.size(); ++p) {
    total += wanted[p].count();
    const Model told = chunks.chunk(model, p);
    if (told.count() != wanted[p].count()) return testing::AssertionFailure() << told.count() << " of " << p;
    for (std::size_t k = 0; k < wanted[p].count(); ++k) {
      const std::size_t i = chunks.blocks(p).at(k / block) * block + k % block;
      if (!equal(model, i, wanted[p], k) || !equal(told, k, wanted[p], k))
        return testing::AssertionFailure() << k << " of chunk " << p;
      if (chunks.owners()[i / block] != p)
        return testing::AssertionFailure() << i << " is not of chunk " << p;
      drawn += wanted[p].opacity[k] > 0.0f ? 1 : 0;
    }
  }
  for (const float opacity : model.opacity) drawn -= opacity > 0.0f ? 1 : 0;
  if (drawn != 0) return testing::AssertionFailure() << "others are drawn, too";
  if (chunks.gaussians() != total) return testing::AssertionFailure() << chunks.gaussians() << " Gaussians";
  return testing::AssertionSuccess();
}

struct Chunks : testing::Test {
  Model like = [] {
    Model none;
    none.degree = 1;
    return none;
  }();
  Model model = like;
  ModelChunks chunks{5};
  std::vector<Model> wanted{5, like};
  std::uint32_t seed = 1;

  void replace(std::size_t chunk, int count) {
    wanted[chunk] = test::random_model(seed++, count, 1);
    chunks.replace(model, chunk, wanted[chunk]);
  }
  // Replaces several chunks at once, and stores the expected Gaussians.
  void replace_some(const std::vector<std::size_t>& some, const std::function<int()>& count) {
    std::vector<ModelChunks::Replacement> all;
    for (const std::size_t chunk : some) {
      wanted[chunk] = test::random_model(seed++, count(), 1);
      all.push_back({chunk, &wanted[chunk]});
    }
    chunks.replace(model, all);
  }
};

TEST_F(Chunks, AreAddedAndRemoved) {
  test::Uniform random(7);
  std::size_t most = 0;
  const auto check = [&] {
    ASSERT_TRUE(holds(model, chunks, wanted));
    std::size_t blocks = 0;
    for (std::size_t p = 0; p < 5; ++p) blocks += chunks.blocks(p).size();
    most = std::max(most, blocks);
  };
  for (int n = 0; n < 300; ++n) {
    const auto size = static_cast<std::size_t>(std::exp(random(0.0, 8.0)));
    replace(static_cast<std::size_t>(random(0.0, 5.0)), static_cast<int>(n % 11 == 0 ? 0 : size));
    check();
    if (n % 7 == 0) replace_some({4, 0, 2}, [&] { return static_cast<int>(random(0.0, 300.0)); });
    check();
  }
  EXPECT_LE(model.count(), (most + most / 8 + 1) * block) << "room that is free is used first";
  for (float& opacity : model.opacity) opacity *= 0.9f;  // injected
  EXPECT_FALSE(holds(model, chunks, wanted));
}

TEST_F(Chunks, ReportChangesOnly) {
  for (std::size_t p = 0; p < 5; ++p) replace(p, 700);
  chunks.take_changes();
  EXPECT_TRUE(chunks.take_changes().empty());
  test::Uniform random(8);
  for (int n = 0; n < 100; ++n) {
    const Model before = model;
    const std::size_t chunk = static_cast<std::size_t>(random(0.0, 5.0));
    replace_some({chunk, (chunk + 1) % 5}, [&] { return static_cast<int>(random(0.0, 1400.0)); });
    const ModelChunks::Changes changes = chunks.take_changes();
    std::set<std::size_t> told, empty;
    for (const auto& [first, count] : changes.filled) {
      for (std::size_t i = first; i < first + count; ++i) EXPECT_TRUE(told.insert(i).second);
    }
    for (const auto& [first, count] : changes.emptied) {
      for (std::size_t i = first; i < first + count; ++i) EXPECT_TRUE(told.insert(i).second);
      empty.insert(first);
      EXPECT_EQ(model.opacity[first], 0.0f);
    }
    for (std::size_t i = 0; i < model.count(); ++i) {
      if (told.count(i) != 0) continue;
      if (i < before.count()) {
        ASSERT_TRUE(equal(model, i, before, i)) << "not told: " << i;
      } else {
        ASSERT_EQ(model.opacity[i], 0.0f) << "not told: " << i;
      }
    }
  }
}

TEST_F(Chunks, KeepBounds) {
  for (std::size_t p = 0; p < 5; ++p) {
    wanted[p] = test::random_model(seed++, 1000, 1);
    for (glm::vec3& position : wanted[p].position) position += 100.0f;
  }
  const std::vector<ModelChunks::Replacement> replacements{
      {0, &wanted[0]}, {1, &wanted[1]}, {2, &wanted[2]}, {3, &wanted[3]}, {4, &wanted[4]}};
  chunks.replace(model, replacements);
  Model all = like;
  for (const Model& chunk : wanted) append(all, chunk, 0, chunk.count());
  EXPECT_GT(model.count(), all.count());
  EXPECT_EQ(summarise(model).all.low, summarise(all).all.low);
  EXPECT_EQ(summarise(model).all.high, summarise(all).all.high);
  EXPECT_EQ(core_bounds(model).low, core_bounds(all).low);
  EXPECT_EQ(core_bounds(model).high, core_bounds(all).high);
}

}  // namespace
}  // namespace binosplat
