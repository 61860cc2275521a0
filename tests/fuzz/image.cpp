// Pictures: load_image, and with it PNG, JPEG and OpenEXR, whose libraries are not instrumented.

#include "formats/image_file.h"
#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace binosplat;
  fuzz::feed_file(fuzz::bytes_of(data, size), [](const std::filesystem::path& path) {
    const Image image = load_image(path);
    const int channels = image.channels;
    fuzz::demand(image.width >= 1 && image.height >= 1, "a picture without pixels");
    fuzz::demand(channels == 1 || channels == 3 || channels == 4, "a number of channels that is none");
    fuzz::demand(image.data.size() == static_cast<std::size_t>(image.width) *
                                          static_cast<std::size_t>(image.height) *
                                          static_cast<std::size_t>(channels),
                 "values missing");
  });
  return 0;
}
