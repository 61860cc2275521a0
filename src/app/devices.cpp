// binosplat devices: lists the OpenGL devices of this machine.

#include "gl/list_devices.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <algorithm>

#include "app/command.h"
#include "lab/fields.h"

namespace binosplat::app {

namespace {

using nlohmann::ordered_json;

void print_device(const gl::Device& device) {
  fmt::print("{}\n", with_options(device.settings));
  if (!device.usable) {
    fmt::print("  cannot be used: {}\n", device.trouble);
    return;
  }
  const gl::Limits& l = device.limits;
  fmt::print("  {}{}, OpenGL {}\n", device.renderer, device.software ? " (software)" : "", device.version);
  fmt::print("  {} MiB of one buffer, {} groups, {} invocations a group, {} KiB shared, {} storage blocks\n",
             l.storage_block_bytes >> 20, l.groups, l.invocations, l.shared_bytes >> 10, l.storage_blocks);
  for (const std::string& lack : device.lacks) fmt::print("  lacks {}\n", lack);
}

ordered_json device_json(const gl::Device& device) {
  if (!device.usable)
    return lab::object("options", with_options(device.settings), "usable", false, "trouble", device.trouble);
  const gl::Limits& l = device.limits;
  return lab::object(
      "options", with_options(device.settings), "usable", true, "renderer", device.renderer, "version",
      device.version, "software", device.software, "limits",
      lab::object("storage_block_bytes", l.storage_block_bytes, "groups", l.groups, "invocations",
                  l.invocations, "shared_bytes", l.shared_bytes, "storage_blocks", l.storage_blocks,
                  "program_binaries", l.program_binaries, "timestamp_bits", l.timestamp_bits, "subgroups",
                  l.subgroups_of_32, "why_no_subgroups", l.why_no_subgroups),
      "lacks", device.lacks);
}

ExitCode devices(const Options& o) {
  const std::vector<gl::Device> list = gl::list_devices();
  ordered_json all = ordered_json::array();
  for (const gl::Device& device : list) {
    print_device(device);
    all.push_back(device_json(device));
  }
  if (!o.json.empty()) save_json(o.json, all);
  const bool any = std::any_of(list.begin(), list.end(), [](const gl::Device& d) { return d.usable; });
  return any ? ExitCode::done : ExitCode::no_gl;
}

}  // namespace

void add_devices(CLI::App& program, Command& command) {
  add_command(program, command,
              {"devices", in::devices, "List what this machine has to draw with",
               "The lines without indent are the options that choose a device in `binosplat render`."},
              devices);
}

}  // namespace binosplat::app
