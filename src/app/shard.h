#pragma once
// --shard I/N: divides work among N runs on several machines or devices.

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "app/cli.h"

namespace binosplat::app {

/// The items of this run: those whose number modulo `count` is `index`.
struct Shard {
  std::size_t index = 0;
  std::size_t count = 1;

  bool all() const { return count == 1; }
};

/// Adds --shard. Text that is not I/N throws Error.
CLI::Option* add_shard_option(CLI::App& sub, Shard& shard, const std::string& help);

/// Keeps only the shard's items, in order.
template <typename Thing>
void take_share(const Shard& shard, std::vector<Thing>& things) {
  std::vector<Thing> share;
  for (std::size_t i = shard.index; i < things.size(); i += shard.count)
    share.push_back(std::move(things[i]));
  things = std::move(share);
}

}  // namespace binosplat::app
