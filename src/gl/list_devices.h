#pragma once
// Lists the OpenGL devices of this machine, for `binosplat devices`.

#include <string>
#include <vector>

#include "gl/context.h"

namespace binosplat::gl {

/// A way to open a context. list_devices() opens each briefly, to read its limits.
struct Device {
  std::string settings;  // that choose it, as in "`backend` osmesa"
  bool usable = false;
  std::string trouble;  // why it is not usable
  std::string renderer;
  std::string version;
  bool software = false;
  Limits limits;
  std::vector<std::string> lacks;  // missing optional features, each with the effect of its lack
};

/// Every EGL device (without EGL, an entry that says so), EGL's surfaceless platform, OSMesa. Never throws.
/// A driver that hangs ends the program (gl/driver_watch.h).
std::vector<Device> list_devices();

}  // namespace binosplat::gl
