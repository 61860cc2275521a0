#include "app/shard.h"

#include <CLI/CLI.hpp>

#include "app/option_checks.h"
#include "base/error.h"
#include "base/numbers.h"

namespace binosplat::app {

namespace {

Shard parse_shard(const std::string& text) {
  const auto shard = two_numbers(text, '/');
  if (shard && shard->first >= 1 && shard->first <= shard->second) return {shard->first - 1, shard->second};
  fail("--shard {}: expected I/N with I from 1 to N, as in 2/8", text);
}

}  // namespace

CLI::Option* add_shard_option(CLI::App& sub, Shard& shard, const std::string& help) {
  return add_parsed(sub, "--shard", "I/N", shard, parse_shard, help);
}

}  // namespace binosplat::app
