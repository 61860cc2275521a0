#include "formats/models/sog_cache.h"

#include <gtest/gtest.h>

#include <map>
#include <mutex>
#include <nlohmann/json.hpp>

#include "base/mapped_file.h"
#include "support/fixtures.h"

namespace binosplat {
namespace {

TEST(SogCache, KeepsMostRecentlyUsed) {
  REQUIRE_FIXTURES(folder);
  const std::filesystem::path sog = folder / "sog/st-lod/0_0";
  std::map<std::string, int> reads;
  std::mutex counting;  // Several threads read pictures.
  const auto read = [&](const std::string& name) {
    {
      const std::lock_guard lock(counting);
      ++reads[name];
    }
    const MappedFile file(sog / name);
    return std::vector(file.bytes().begin(), file.bytes().end());
  };
  const MappedFile meta(sog / "meta.json");
  const SogSource source("meta.json",
                         nlohmann::json::parse(std::string(reinterpret_cast<const char*>(meta.bytes().data()),
                                                           meta.bytes().size())),
                         read);
  const std::size_t bytes = source.textures()->bytes();
  EXPECT_GT(bytes, source.count() * 20);
  SogCache cache(2 * bytes);
  reads.clear();
  const auto first = cache.textures(0, source);
  EXPECT_EQ(cache.textures(0, source), first);
  EXPECT_EQ(reads["quats.webp"], 1);
  cache.textures(1, source);
  EXPECT_EQ(cache.textures(0, source), first) << "used last";
  cache.textures(2, source);
  EXPECT_TRUE(cache.has(0));
  EXPECT_FALSE(cache.has(1));
  EXPECT_TRUE(cache.has(2));
  EXPECT_EQ(reads["quats.webp"], 3);
  SogCache none(bytes - 1);
  EXPECT_EQ(none.textures(0, source)->data, first->data);
  EXPECT_FALSE(none.has(0)) << "it alone is too much";
}

}  // namespace
}  // namespace binosplat
