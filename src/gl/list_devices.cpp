#include "gl/list_devices.h"

#include <fmt/core.h>

#include "base/error.h"
#include "gl/driver_watch.h"

namespace binosplat::gl {

namespace {

std::vector<std::string> missing(const Limits& limits, bool software) {
  std::vector<std::string> lacks;
  if (!limits.subgroups_of_32 && !software)
    lacks.push_back(
        fmt::format("subgroups of 32 invocations ({}): frames take longer", limits.why_no_subgroups));
  if (limits.timestamp_bits == 0) lacks.emplace_back("timestamps: stages are not timed");
  if (limits.program_binaries == 0)
    lacks.emplace_back("program binaries: shaders are compiled at every start");
  if (limits.storage_block_bytes < std::int64_t{1} << 31) {
    lacks.push_back(
        fmt::format("bindings of 2 GiB: each buffer is limited to {} MiB", limits.storage_block_bytes >> 20));
  }
  return lacks;
}

Device look_at(Backend backend, int number, std::string settings) {
  Device device;
  device.settings = std::move(settings);
  try {
    const std::jthread watch = watch_driver();
    const auto context = Context::open(backend, number);
    device.usable = true;
    device.renderer = context->renderer();
    device.version = context->version();
    device.software = context->software();
    device.limits = context->limits();
    device.lacks = missing(device.limits, device.software);
  } catch (const Error& error) {
    device.trouble = error.what();
  }
  return device;
}

}  // namespace

std::vector<Device> list_devices() {
  std::vector<Device> devices;
  int count = 0;
  try {
    count = Context::device_count();
  } catch (const Error& error) {
    devices.push_back({.settings = "EGL", .trouble = error.what()});
    devices.push_back(look_at(Backend::osmesa, -1, "`backend` osmesa"));
    return devices;
  }
  for (int i = 0; i < count; ++i)
    devices.push_back(look_at(Backend::device, i, fmt::format("`backend` device `device` {}", i)));
  devices.push_back(look_at(Backend::surfaceless, -1, "`backend` surfaceless"));
  devices.push_back(look_at(Backend::osmesa, -1, "`backend` osmesa"));
  return devices;
}

}  // namespace binosplat::gl
