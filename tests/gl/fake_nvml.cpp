// Replaces NVIDIA's management library: two GPUs, of which the second one's clock falls by 15 MHz at each
// query.

#include <atomic>
#include <cstring>

// NOLINTBEGIN(readability-identifier-naming): the names are NVML's.
extern "C" {

int nvmlInit_v2() { return 0; }
int nvmlShutdown() { return 0; }
int nvmlDeviceGetCount_v2(unsigned* count) {
  *count = 2;
  return 0;
}
int nvmlDeviceGetHandleByIndex_v2(unsigned index, void** device) {
  static char devices[2];
  *device = &devices[index];
  return 0;
}
int nvmlDeviceGetUUID(void* device, char* text, unsigned room) {
  void* second = nullptr;
  nvmlDeviceGetHandleByIndex_v2(1, &second);
  std::strncpy(text, device == second ? "GPU-00010203-0405-0607-0809-0a0b0c0d0e0f" : "GPU-other", room);
  return 0;
}
int nvmlDeviceGetClockInfo(void*, int, unsigned* mhz) {
  static std::atomic<unsigned> asked = 0;
  *mhz = 1980 - 15 * asked++;
  return 0;
}
}
// NOLINTEND(readability-identifier-naming)
