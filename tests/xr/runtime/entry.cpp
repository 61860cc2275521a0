// What the loader finds: how the runtime is negotiated with, and the table of its functions.

#include <cstdio>
#include <cstring>

#include "xr/runtime/api.h"

namespace binosplat::xr_test {
namespace {

// As the loader's specification has it.
struct RuntimeRequest {
  std::uint32_t type, version;
  std::size_t size;
  std::uint32_t interface_version;
  XrVersion api_version;
  PFN_xrGetInstanceProcAddr get;
};
constexpr std::uint32_t type_loader_info = 1, type_runtime_request = 3, interface_version = 1;

template <std::size_t N>
struct Name {
  constexpr Name(const char (&from)[N]) {  // NOLINT(google-explicit-constructor): a literal names a function
    for (std::size_t k = 0; k < N; ++k) text[k] = from[k];
  }
  char text[N]{};
};

/// A function as the loader calls it.
template <Name name, auto function>
struct Entry;
template <Name name, typename... Arguments, XrResult (*function)(Arguments...)>
struct Entry<name, function> {
  static XrResult XRAPI_CALL call(Arguments... arguments) {
    return guarded(name.text, [&] { return function(arguments...); });
  }
};

struct Row {
  const char* name;
  PFN_xrVoidFunction function;
};

#define BINOSPLAT_ENTRY(name, function) \
  {"xr" #name, reinterpret_cast<PFN_xrVoidFunction>(&Entry<Name("xr" #name), &api::function>::call)},
const Row table[] = {BINOSPLAT_XR_TEST_FUNCTIONS(BINOSPLAT_ENTRY)};

XrResult XRAPI_CALL get_instance_proc_addr(XrInstance instance, const char* name,
                                           PFN_xrVoidFunction* function) {
  *function = nullptr;
  if (std::strcmp(name, "xrGetInstanceProcAddr") == 0) {
    *function = reinterpret_cast<PFN_xrVoidFunction>(&get_instance_proc_addr);
    return XR_SUCCESS;
  }
  for (const Row& row : table) {
    if (std::strcmp(row.name, name) != 0) continue;
    // That of an extension is there only with it.
    const Instance* at = runtime().instance();
    if (instance != XR_NULL_HANDLE && std::strcmp(name, "xrGetVisibilityMaskKHR") == 0 &&
        (at == nullptr || at->extensions.count(XR_KHR_VISIBILITY_MASK_EXTENSION_NAME) == 0)) {
      break;
    }
    *function = row.function;
    return XR_SUCCESS;
  }
  return XR_ERROR_FUNCTION_UNSUPPORTED;
}

}  // namespace
}  // namespace binosplat::xr_test

extern "C" __attribute__((visibility("default"))) XrResult XRAPI_CALL
xrNegotiateLoaderRuntimeInterface(  // NOLINT(readability-identifier-naming)
    const binosplat::xr_test::LoaderInfo* info, binosplat::xr_test::RuntimeRequest* request) {
  using namespace binosplat::xr_test;
  if (info == nullptr || request == nullptr || info->type != type_loader_info ||
      request->type != type_runtime_request || info->min_interface > interface_version ||
      info->max_interface < interface_version) {
    return XR_ERROR_INITIALIZATION_FAILED;
  }
  try {
    runtime();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "xr_test_runtime: %s\n", error.what());
    return XR_ERROR_INITIALIZATION_FAILED;
  }
  request->interface_version = interface_version;
  request->api_version = XR_MAKE_VERSION(1, 0, 0);
  request->get = &get_instance_proc_addr;
  return XR_SUCCESS;
}
