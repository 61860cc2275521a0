#include "app/content_key.h"

#include <fmt/core.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <memory>
#include <new>
#include <vector>

#include "base/error.h"
#include "base/mapped_file.h"
#include "formats/files_of_model.h"
#include "formats/model_file.h"

namespace binosplat::app {

namespace fs = std::filesystem;

namespace {

class Hash {
 public:
  Hash() : state_(XXH3_createState(), XXH3_freeState) {
    if (state_ == nullptr || XXH3_128bits_reset(state_.get()) != XXH_OK) throw std::bad_alloc();
  }
  void add(const void* bytes, std::size_t count) { XXH3_128bits_update(state_.get(), bytes, count); }
  void add(const std::string& text) { add(text.c_str(), text.size() + 1); }
  std::string key() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
  }

 private:
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_;
};

std::string key_of(const fs::path& folder, std::vector<fs::path> files) {
  std::sort(files.begin(), files.end());
  Hash hash;
  for (const fs::path& name : files) {
    hash.add(name.lexically_relative(folder).string());
    const MappedFile file(name);
    hash.add(file.bytes().data(), file.bytes().size());
  }
  return hash.key();
}

}  // namespace

std::string content_key(const fs::path& path) {
  return key_of(file_of(path).parent_path(), files_of_model(path));
}

std::string text_key(const std::string& text) {
  Hash hash;
  hash.add(text);
  return hash.key();
}

std::string file_key(const fs::path& file) { return key_of(file.parent_path(), {file}); }

std::string pictures_key(const fs::path& folder) {
  std::error_code error, ignored;
  std::vector<fs::path> files;
  for (auto at = fs::directory_iterator(folder, error); !error && at != end(at); at.increment(error)) {
    if (at->is_regular_file(ignored)) files.push_back(at->path());
  }
  if (error) fail("{}: {}", folder.string(), error.message());
  return key_of(folder, files);
}

std::string content_key(std::span<const Camera> cameras) {
  Hash hash;
  for (const Camera& camera : cameras) {
    hash.add(camera.name);
    std::vector<double> numbers = {static_cast<double>(camera.width),
                                   static_cast<double>(camera.height),
                                   camera.fx,
                                   camera.fy,
                                   camera.cx,
                                   camera.cy};
    for (int c = 0; c < 3; ++c) {
      numbers.push_back(camera.position[c]);
      for (int r = 0; r < 3; ++r) numbers.push_back(camera.rotation[c][r]);
    }
    hash.add(numbers.data(), numbers.size() * sizeof(double));
  }
  return hash.key();
}

}  // namespace binosplat::app
