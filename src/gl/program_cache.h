#pragma once
// Stores compiled programs on disk. NVIDIA compiles a shader in a third of a second, and loads its binary in
// a few milliseconds. Also stores the results of tests of a driver.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "gl/functions.h"

namespace binosplat::gl {

/// A folder of program binaries. No failure here is an error. A binary that is missing, damaged, refused, or
/// of another driver is compiled again. A folder that cannot be written stays unchanged.
class ProgramCache {
 public:
  /// An empty folder turns the cache off. `driver` names the driver and its version; binaries of others are
  /// never loaded.
  ProgramCache(std::filesystem::path folder, std::string driver);

  /// The user's folder: $XDG_CACHE_HOME/binosplat/programs or ~/.cache/binosplat/programs; empty without a
  /// home.
  static std::filesystem::path default_folder();

  /// Loads the binary of a program that was compiled from `source`. If it returns false, compile it.
  bool load(const Functions& gl, std::uint32_t program, const std::string& source) const;

  /// Stores a linked program. Does nothing for drivers without program binaries.
  void store(const Functions& gl, std::uint32_t program, const std::string& source) const;

  /// Returns the result that store_result() stored for this driver; none if there is none yet. `test_name`
  /// identifies the test, such as by its shaders' sources.
  std::optional<std::string> load_result(const std::string& test_name) const;
  void store_result(const std::string& test_name, const std::string& found) const;

 private:
  std::string key(const std::string& source) const;
  std::filesystem::path file(const std::string& key) const;
  std::optional<std::string> read(const std::string& wanted) const;
  void write(const std::string& wanted, const std::string& kept) const;

  std::filesystem::path folder_;
  std::string driver_;
};

}  // namespace binosplat::gl
