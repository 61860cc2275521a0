#pragma once
// What this machine has to draw with, for `binosplat devices`.

#include <string>
#include <vector>

#include "gl/context.h"

namespace binosplat::gl {

/// One way to a context: opened for a moment and closed again.
struct Device {
  std::string options;  // the command line that chooses it
  bool usable = false;
  std::string trouble;  // why not, where it is not usable
  std::string renderer;
  std::string version;
  bool software = false;
  Limits limits;
  std::vector<std::string> lacks;  // what binosplat can do without, at a cost that each says
};

/// Every EGL device, then EGL's surfaceless platform, then OSMesa. Without EGL one entry says so; nothing is
/// thrown.
std::vector<Device> list_devices();

}  // namespace binosplat::gl
