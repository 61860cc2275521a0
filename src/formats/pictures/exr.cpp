#include "formats/pictures/exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <half.h>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <mutex>
#include <thread>

#include "base/error.h"
#include "base/log.h"
#include "base/output_file.h"
#include "base/parallel.h"
#include "formats/pictures/picture_readers.h"

namespace binosplat {

namespace {

constexpr const char* encoding_name = "binosplatEncoding";
constexpr const char* coverage_name = "coverage";

/// OpenEXR compresses in threads of a global pool, which is empty by default.
void use_all_cores() {
  static std::once_flag once;
  std::call_once(once, Imf::setGlobalThreadCount, static_cast<int>(std::thread::hardware_concurrency()));
}

/// Indexed by ExrCompression.
constexpr Imf::Compression compressions[] = {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIP_COMPRESSION};

/// Keeps OpenEXR's output in memory, because the destructor of OpenEXR's file stream ignores a full disk.
class MemoryStream : public Imf::OStream {
 public:
  explicit MemoryStream(const char* name) : Imf::OStream(name) {}
  void write(const char bytes[], int size) override {
    const auto count = static_cast<std::size_t>(size);
    if (at_ + count > data_.size()) data_.resize(at_ + count);
    std::memcpy(&data_[at_], bytes, count);
    at_ += count;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t at) override { at_ = at; }
  std::string take() { return std::move(data_); }

 private:
  std::string data_;
  std::size_t at_ = 0;
};

/// One channel's values, rows from the top.
struct Plane {
  std::string name;
  std::vector<float> values;
  std::vector<half> halves;  // replaces `values` if the channel is stored as halves
};

std::vector<Plane> planes_of(const Picture& picture, const std::string& prefix, const ExrOptions& options) {
  const Image image = composite(picture, options.background);
  const std::size_t count = picture.colour.size(), channels = static_cast<std::size_t>(image.channels);
  std::vector<Plane> planes{{"R", {}, {}}, {"G", {}, {}}, {"B", {}, {}}, {"A", {}, {}}};
  if (options.background) planes.push_back({coverage_name, {}, {}});
  for (Plane& plane : planes) {
    plane.halves.resize(options.half ? count : 0);
    plane.values.resize(options.half ? 0 : count);
  }
  const auto put = [&](std::size_t plane, std::size_t k, float value) {
    if (options.half) {
      planes[plane].halves[k] = value;
    } else {
      planes[plane].values[k] = value;
    }
  };
  constexpr std::size_t min_pixels_per_thread = 4096;
  parallel_for(
      count,
      [&](std::size_t k) {
        const float coverage = 1.0f - picture.colour[k].a;
        const float alpha = options.background ? 1.0f : coverage;
        for (std::size_t c = 0; c < 3; ++c) {
          const double v = image.data[k * channels + c];
          put(c, k, static_cast<float>(alpha * (options.display ? v : srgb_to_linear(v))));
        }
        put(3, k, alpha);
        if (options.background) put(4, k, coverage);
      },
      min_pixels_per_thread);
  planes.push_back({"Z", depth_map(picture).data, {}});
  for (Plane& plane : planes) plane.name = prefix + plane.name;
  return planes;
}

void write_planes(Imf::OStream& stream, int width, int height, std::vector<Plane>& planes,
                  const Imf::StringVector& views, const ExrOptions& options) {
  Imf::Header header(width, height);
  if (!views.empty()) Imf::addMultiView(header, views);
  header.compression() = compressions[static_cast<int>(options.compression)];
  for (const auto& [key, value] : options.notes) header.insert(key, Imf::StringAttribute(value));
  header.insert(encoding_name, Imf::StringAttribute(options.display ? "display" : "linear"));
  Imf::FrameBuffer frame;
  for (Plane& plane : planes) {
    const bool halves = !plane.halves.empty();
    const Imf::PixelType type = halves ? Imf::HALF : Imf::FLOAT;
    char* base =
        halves ? reinterpret_cast<char*>(plane.halves.data()) : reinterpret_cast<char*>(plane.values.data());
    const std::size_t step = halves ? sizeof(half) : sizeof(float);
    header.channels().insert(plane.name, Imf::Channel(type));
    frame.insert(plane.name, Imf::Slice(type, base, step, step * static_cast<std::size_t>(width)));
  }
  Imf::OutputFile file(stream, header);
  file.setFrameBuffer(frame);
  file.writePixels(height);
}

/// Returns the channels of an Image: R G B or Y, and A unless the colours include the background.
std::vector<std::string> wanted_channels(const std::filesystem::path& path,
                                         const Imf::ChannelList& channels) {
  std::vector<std::string> wanted;
  const auto has = [&](const char* name) { return channels.findChannel(name) != nullptr; };
  const bool alpha = has("A") && !has(coverage_name);
  if (has("R") && has("G") && has("B")) {
    wanted = {"R", "G", "B"};
  } else if (has("Y") && (has("RY") || has("BY"))) {
    fail("{}: it stores luminance and chroma (Y, RY, BY), which cannot be read; convert it to RGB", path);
  } else if (has("Y") && !alpha) {
    wanted = {"Y"};
  } else if (has("Y")) {
    wanted = {"Y", "Y", "Y"};
  } else {
    std::string names;
    for (auto channel = channels.begin(); channel != channels.end(); ++channel)
      names += std::string(" ") + channel.name();
    fail("{}: no channels R, G, B or Y in this OpenEXR file; it has:{}", path, names);
  }
  if (alpha) wanted.emplace_back("A");
  for (const std::string& name : wanted) {
    const Imf::Channel& channel = channels[name];
    if (channel.xSampling != 1 || channel.ySampling != 1)
      fail("{}: channel {} is stored at a lower resolution, which cannot be read", path, name);
  }
  return wanted;
}

glm::ivec2 size_of(const Imath::Box2i& window) {
  return {window.max.x - window.min.x + 1, window.max.y - window.min.y + 1};
}

/// Crops a picture of the data window to the display window, and fills the rest with 0.
Image in_display_window(const Image& stored, const Imath::Box2i& data, const Imath::Box2i& display) {
  const glm::ivec2 size = size_of(display);
  Image image(size.x, size.y, stored.channels);
  const auto place = [](const Image& of, int x, int y) {
    return (static_cast<std::size_t>(y) * of.width + x) * of.channels;
  };
  const Imath::Box2i both({std::max(data.min.x, display.min.x), std::max(data.min.y, display.min.y)},
                          {std::min(data.max.x, display.max.x), std::min(data.max.y, display.max.y)});
  for (int y = both.min.y; !both.isEmpty() && y <= both.max.y; ++y) {
    const float* from = &stored.data[place(stored, both.min.x - data.min.x, y - data.min.y)];
    const std::size_t count = static_cast<std::size_t>(size_of(both).x) * stored.channels;
    std::copy_n(from, count, &image.data[place(image, both.min.x - display.min.x, y - display.min.y)]);
  }
  return image;
}

/// Reads the wanted channels of the data window, unconverted.
Image read_channels(Imf::InputFile& file, const std::vector<std::string>& wanted) {
  const Imath::Box2i window = file.header().dataWindow();
  const glm::ivec2 size = size_of(window);
  Image image(size.x, size.y, static_cast<int>(wanted.size()));
  const std::size_t step = sizeof(float) * wanted.size();
  // OpenEXR fills one slice a channel; Y is copied to R, G and B below.
  Imf::FrameBuffer frame;
  for (std::size_t c = 0; c < wanted.size(); ++c) {
    frame.insert(wanted[c], Imf::Slice::Make(Imf::FLOAT, &image.data[c], window, step,
                                             step * static_cast<std::size_t>(size.x)));
  }
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);
  if (wanted[0] == "Y" && wanted.size() == 4) {
    for (std::size_t i = 0; i < image.data.size(); i += 4)
      image.data[i] = image.data[i + 1] = image.data[i + 2];
  }
  return image;
}

/// Reads the first and the last line, to detect cut files: one of these lines is at the end of the file.
void read_ends(Imf::InputFile& file, const std::vector<std::string>& wanted) {
  const Imath::Box2i window = file.header().dataWindow();
  std::vector<float> line(static_cast<std::size_t>(size_of(window).x));
  char* const base =
      reinterpret_cast<char*>(line.data()) - std::ptrdiff_t{window.min.x} * std::ptrdiff_t{sizeof(float)};
  Imf::FrameBuffer frame;
  for (const std::string& name : wanted) frame.insert(name, Imf::Slice(Imf::FLOAT, base, sizeof(float), 0));
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y);
  file.readPixels(window.max.y);
}

bool is_display(const Imf::Header& header) {
  const auto* encoding = header.findTypedAttribute<Imf::StringAttribute>(encoding_name);
  return encoding != nullptr && encoding->value() == "display";
}

/// Calls `work`. Replaces errors of OpenEXR, which name no file, by errors that begin with `what`.
template <typename Work>
auto with_errors(const std::string& what, const Work& work) {
  use_all_cores();
  try {
    return work();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    fail("{}: {}", what, error.what());
  }
}

template <typename Read>
auto read_file(const std::filesystem::path& path, const Read& read) {
  return with_errors(path.string() + ": broken OpenEXR", [&] {
    Imf::InputFile file(path.c_str());
    return read(file);
  });
}

/// Encodes one picture, or a default view and further named views.
std::string bytes_of(const std::filesystem::path& path, const std::vector<const Picture*>& pictures,
                     const Imf::StringVector& views, const ExrOptions& options) {
  return with_errors("cannot write " + path.string(), [&] {
    MemoryStream stream(path.c_str());
    std::vector<Plane> planes;
    for (std::size_t k = 0; k < pictures.size(); ++k) {
      std::vector<Plane> more = planes_of(*pictures[k], k == 0 ? "" : views[k] + ".", options);
      std::move(more.begin(), more.end(), std::back_inserter(planes));
    }
    write_planes(stream, pictures[0]->width, pictures[0]->height, planes, views, options);
    return stream.take();
  });
}

}  // namespace

std::string exr_bytes(const std::filesystem::path& path, const Picture& picture, const ExrOptions& options) {
  return bytes_of(path, {&picture}, {}, options);
}

std::string exr_bytes(const std::filesystem::path& path, const Picture& left, const Picture& right,
                      const ExrOptions& options) {
  if (left.width != right.width || left.height != right.height) {
    fail("cannot write {}: the views of one OpenEXR file have one size, not {} x {} and {} x {} px", path,
         left.width, left.height, right.width, right.height);
  }
  return bytes_of(path, {&left, &right}, {"left", "right"}, options);
}

void save_exr(const std::filesystem::path& path, const Picture& picture, const ExrOptions& options) {
  write_file(path, exr_bytes(path, picture, options));
}

void save_exr(const std::filesystem::path& path, const Picture& left, const Picture& right,
              const ExrOptions& options) {
  write_file(path, exr_bytes(path, left, right, options));
}

Image load_exr(const std::filesystem::path& path, std::span<const std::byte> bytes,
               const PictureLimit& limit) {
  check_exr_header(path, bytes, limit);
  bool display = false;
  Image image = read_file(path, [&](Imf::InputFile& file) {
    const Imf::Header& header = file.header();
    display = is_display(header);
    if (Imf::hasMultiView(header) && Imf::multiView(header).size() > 1) {
      const Imf::StringVector& views = Imf::multiView(header);
      log_info("{} has {} views; only the default one, {}, is read", path, views.size(), views[0]);
    }
    Image stored = read_channels(file, wanted_channels(path, header.channels()));
    const Imath::Box2i &data = header.dataWindow(), &shown = header.displayWindow();
    if (data == shown) return stored;
    if (!data.intersects(shown))
      log_warning("{}: its pixels lie outside its display window: the picture is empty", path);
    return in_display_window(stored, data, shown);
  });
  const auto channels = static_cast<std::size_t>(image.channels);
  const std::size_t colours = channels == 4 ? 3 : channels;
  parallel_for(image.data.size() / channels, [&](std::size_t k) {
    float* pixel = &image.data[k * channels];
    const float alpha = channels == 4 ? pixel[3] : 1.0f;
    for (std::size_t c = 0; c < colours; ++c) {
      const float straight = alpha > 0.0f ? pixel[c] / alpha : 0.0f;
      pixel[c] = display ? straight : static_cast<float>(linear_to_srgb(straight));
    }
  });
  return image;
}

glm::ivec2 exr_size(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  check_exr_header(path, bytes, {});
  return read_file(path, [&](Imf::InputFile& file) {
    const std::vector<std::string> wanted = wanted_channels(path, file.header().channels());
    if (!file.isComplete()) fail("{}: broken OpenEXR: the file is cut short", path);
    read_ends(file, wanted);
    return size_of(file.header().displayWindow());
  });
}

bool is_whole_exr(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  check_exr_header(path, bytes, {});
  return read_file(path, [](Imf::InputFile& file) {
    // Number of lines in a block, for files that binosplat writes.
    const int lines = file.header().compression() == Imf::ZIP_COMPRESSION ? 16 : 1;
    const Imath::Box2i window = file.header().dataWindow();
    for (int y = window.min.y; y <= window.max.y; y += lines) {
      const char* block = nullptr;
      int size = 0;
      file.rawPixelData(y, block, size);  // throws if the block is cut short
    }
    return file.isComplete();
  });
}

}  // namespace binosplat
