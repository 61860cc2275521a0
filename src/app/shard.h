#pragma once
// --shard I/N: work that is shared out among N runs, on as many machines or devices.

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "app/cli.h"

namespace binosplat::app {

/// Which things are this run's: those whose number leaves `index` when divided by `count`.
struct Shard {
  std::size_t index = 0;
  std::size_t count = 1;

  bool all() const { return count == 1; }
};

/// Adds --shard. Text that is no I/N ends the parsing with Error.
CLI::Option* add_shard_option(CLI::App& sub, Shard& shard, const std::string& help);

/// Leaves what is the shard's, in its order.
template <typename Thing>
void take_share(const Shard& shard, std::vector<Thing>& things) {
  std::vector<Thing> share;
  for (std::size_t i = shard.index; i < things.size(); i += shard.count)
    share.push_back(std::move(things[i]));
  things = std::move(share);
}

}  // namespace binosplat::app
