#include "gl/gpu_clock.h"

#include <dlfcn.h>
#include <fmt/core.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stop_token>

namespace binosplat::gl {

namespace {

constexpr GLenum device_uuid = 0x9597;                     // GL_DEVICE_UUID_EXT
constexpr std::chrono::milliseconds between_readings{20};  // more frequent readings might delay the driver

/// Returns the UUID in NVML's format: "GPU-", then 8-4-4-4-12 hexadecimal digits.
std::string text_of(const GpuClock::Uuid& uuid) {
  std::string text = "GPU";
  for (std::size_t k = 0; k < uuid.size(); ++k) {
    if (k == 0 || k == 4 || k == 6 || k == 8 || k == 10) text += '-';
    text += fmt::format("{:02x}", uuid[k]);
  }
  return text;
}

std::optional<GpuClock::Uuid> uuid_of(const Context& context) {
  if (context.gl().GetUnsignedBytei_vEXT == nullptr || !has_extension(context.gl(), "GL_EXT_memory_object"))
    return std::nullopt;
  GpuClock::Uuid uuid{};
  context.gl().GetUnsignedBytei_vEXT(device_uuid, 0, uuid.data());
  return uuid;
}

}  // namespace

/// The functions of NVML (NVIDIA's management library) that are used here.
struct GpuClock::Library {
  using Device = struct nvmlDevice_st*;
  static constexpr int shader_clock = 1;

  ~Library() {
    if (is_begun) end();
    if (handle != nullptr) dlclose(handle);
  }

  /// Loads all functions. Returns false if one is missing.
  bool find() {
    const auto find_one = [&](const char* name, auto& function) {
      function = reinterpret_cast<std::decay_t<decltype(function)>>(dlsym(handle, name));
      return function != nullptr;
    };
    return find_one("nvmlInit_v2", begin) && find_one("nvmlShutdown", end) &&
           find_one("nvmlDeviceGetCount_v2", count) && find_one("nvmlDeviceGetHandleByIndex_v2", device_at) &&
           find_one("nvmlDeviceGetUUID", uuid) && find_one("nvmlDeviceGetClockInfo", clock);
  }

  void* handle = nullptr;
  bool is_begun = false;
  Device device = nullptr;
  int (*begin)() = nullptr;
  int (*end)() = nullptr;
  int (*count)(unsigned*) = nullptr;
  int (*device_at)(unsigned, Device*) = nullptr;
  int (*uuid)(Device, char*, unsigned) = nullptr;
  int (*clock)(Device, int, unsigned*) = nullptr;
};

GpuClock::GpuClock(const Context& context) {
  if (context.software()) {
    problem_ = "the CPU draws, so there is no GPU clock";
    return;
  }
  open("libnvidia-ml.so.1", uuid_of(context));
}

GpuClock::GpuClock(const char* library, const std::optional<Uuid>& uuid) { open(library, uuid); }

GpuClock::~GpuClock() = default;

void GpuClock::open(const char* library, const std::optional<Uuid>& uuid) {
  library_ = std::make_unique<Library>();
  Library& nvml = *library_;
  nvml.handle = dlopen(library, RTLD_NOW | RTLD_LOCAL);
  if (nvml.handle == nullptr || !nvml.find()) {
    problem_ = fmt::format("{} cannot be loaded", library);
    return;
  }
  nvml.is_begun = nvml.begin() == 0;
  unsigned devices = 0;
  if (!nvml.is_begun || nvml.count(&devices) != 0) {
    problem_ = fmt::format("{} finds no NVIDIA driver", library);
    return;
  }
  for (unsigned k = 0; k < devices; ++k) {
    Library::Device device = nullptr;
    std::array<char, 96> text{};
    if (nvml.device_at(k, &device) != 0 || nvml.uuid(device, text.data(), text.size() - 1) != 0) continue;
    if (uuid ? text_of(*uuid) == text.data() : devices == 1) nvml.device = device;
  }
  unsigned mhz = 0;
  if (nvml.device == nullptr) {
    problem_ = fmt::format("{} does not list the GPU of this OpenGL context", library);
  } else if (nvml.clock(nvml.device, Library::shader_clock, &mhz) != 0) {
    problem_ = fmt::format("{} does not report this GPU's clock", library);
  } else {
    mhz_ = mhz;
    thread_ = std::jthread([this](const std::stop_token& stop) {
      std::mutex mutex;
      std::unique_lock lock(mutex);
      std::condition_variable_any never;
      while (!never.wait_for(lock, stop, between_readings, [&] { return stop.stop_requested(); })) {
        unsigned now = 0;
        if (library_->clock(library_->device, Library::shader_clock, &now) == 0) mhz_ = now;
      }
    });
  }
}

std::optional<double> GpuClock::mhz() const {
  const unsigned mhz = mhz_;
  return mhz == 0 ? std::nullopt : std::optional<double>(mhz);
}

}  // namespace binosplat::gl
