#pragma once
// How xr/client.cpp calls OpenXR and says what failed.

#include <cstdio>
#include <set>
#include <string>

#include "xr/runtime/openxr.h"

namespace binosplat::xr_test {

inline XrInstance instance = XR_NULL_HANDLE;

/// The program's arguments.
inline std::set<std::string> words;
inline bool has(const char* word) { return words.count(word) != 0; }

inline XrResult say(const char* call, XrResult result) {
  if (result == XR_SUCCESS || result == XR_EVENT_UNAVAILABLE) return result;
  char text[XR_MAX_RESULT_STRING_SIZE] = "?";
  if (instance != XR_NULL_HANDLE) xrResultToString(instance, result, text);
  std::printf("%s: %s\n", call, instance != XR_NULL_HANDLE ? text : std::to_string(result).c_str());
  std::fflush(stdout);
  return result;
}
#define XR(name, ...) ::binosplat::xr_test::say(#name, name(__VA_ARGS__))

}  // namespace binosplat::xr_test
