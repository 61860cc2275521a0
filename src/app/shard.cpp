#include "app/shard.h"

#include <CLI/CLI.hpp>

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
  return sub
      .add_option_function<std::string>(
          "--shard", [&shard](const std::string& text) { shard = parse_shard(text); }, help)
      ->type_name("I/N");
}

}  // namespace binosplat::app
