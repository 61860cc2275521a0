#pragma once
// NumPy's .npz archives, as far as fixtures need them: arrays of float32 or bool.

#include <zip.h>

#include <cstring>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace binosplat::test {

/// An array's elements, flat, in C order.
inline std::vector<float> parse_npy(const std::string& bytes) {
  if (bytes.size() < 10 || bytes.substr(1, 5) != "NUMPY") throw std::runtime_error("no .npy");
  const std::size_t header =
      static_cast<unsigned char>(bytes[8]) + 256u * static_cast<unsigned char>(bytes[9]);
  const bool bools = bytes.substr(10, header).find("'|b1'") != std::string::npos;
  const std::string data = bytes.substr(10 + header);
  if (bools) return {data.begin(), data.end()};
  if (bytes.substr(10, header).find("'<f4'") == std::string::npos)
    throw std::runtime_error("neither f4 nor b1");
  std::vector<float> values(data.size() / 4);
  std::memcpy(values.data(), data.data(), 4 * values.size());
  return values;
}

inline std::map<std::string, std::vector<float>> load_npz(const std::filesystem::path& path) {
  int error = 0;
  zip_t* archive = zip_open(path.c_str(), ZIP_RDONLY, &error);
  if (archive == nullptr) throw std::runtime_error("cannot read " + path.string());
  std::map<std::string, std::vector<float>> arrays;
  for (zip_int64_t i = 0; i < zip_get_num_entries(archive, 0); ++i) {
    zip_stat_t status;
    zip_stat_index(archive, static_cast<zip_uint64_t>(i), 0, &status);
    std::string bytes(status.size, '\0');
    zip_file_t* file = zip_fopen_index(archive, static_cast<zip_uint64_t>(i), 0);
    zip_fread(file, bytes.data(), bytes.size());
    zip_fclose(file);
    const std::string name = status.name;
    arrays[name.substr(0, name.find(".npy"))] = parse_npy(bytes);
  }
  zip_discard(archive);
  return arrays;
}

}  // namespace binosplat::test
