#pragma once
// An OpenXR runtime and the headset that it has.

#include <set>
#include <string>
#include <vector>

#include "xr/api.h"

namespace binosplat::xr {

class Instance {
 public:
  /// Connects to the runtime and finds a headset. Throws Error(no_gl), in one line, for no loader, no
  /// runtime, a runtime that takes no OpenGL, and no headset.
  Instance();
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  XrInstance handle() const { return instance_; }
  XrSystemId system() const { return system_; }
  const Api& api() const { return api_; }
  /// Whether the instance has an extension, one of those that are optional.
  bool has(const char* extension) const { return extensions_.contains(extension); }

  const std::string& runtime() const { return runtime_; }  // "Monado 21.0.0"
  const std::string& headset() const { return headset_; }  // its name

  /// Two views or, where the runtime has them, four: both eyes' context, then both insets.
  XrViewConfigurationType view_configuration() const { return view_configuration_; }
  /// Recommended and largest sizes, as they are now.
  std::vector<XrViewConfigurationView> views() const;
  XrEnvironmentBlendMode blend_mode() const;

  /// Whether the headset is there, maybe another time: the system is the one found now.
  bool find_again();

  XrPath path(const std::string& text) const;

 private:
  void find_headset();
  XrResult get_system();

  XrInstance instance_ = XR_NULL_HANDLE;
  XrSystemId system_ = XR_NULL_SYSTEM_ID;
  Api api_;
  std::set<std::string> extensions_;
  std::string runtime_, headset_;
  XrViewConfigurationType view_configuration_ = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
};

/// A list of OpenXR's, which `enumerate` tells by its count first, and then by its elements.
template <typename T, typename Enumerate>
std::vector<T> all_of(const char* call, const T& empty, const Enumerate& enumerate) {
  std::uint32_t count = 0;
  check(enumerate(0u, &count, static_cast<T*>(nullptr)), call);
  std::vector<T> all(count, empty);
  if (count > 0) check(enumerate(count, &count, all.data()), call);
  all.resize(count, empty);
  return all;
}

}  // namespace binosplat::xr
