// Photos in other formats and with other endings, and how unreadable ones are named.

#include <gtest/gtest.h>

#include "formats/cameras/view_files.h"
#include "formats/pictures/image_file.h"
#include "support/broken.h"
#include "support/jpeg.h"

namespace binosplat {
namespace {

using namespace std::string_literals;
using test::TempFolder;
using test::write_text;

TEST(PhotoFiles, AreFoundInAnyCase) {
  for (const char* name : {"v.jpg", "v.Jpg", "v.JPEG", "v.Png", "v.PNG", "v.Exr", "v.webp", "v.WEBP", "v.TIF",
                           "v.tiff", "v.HEIC", "v.avif", "v.jxl"}) {
    const TempFolder folder;
    write_text(folder / name, "");
    for (const char* view : {"v", "v.png", "v.JPG", "v.webp", "v.heic"})
      EXPECT_EQ(find_view_photo(folder.path(), view), folder / name) << view;
    EXPECT_FALSE(find_view_photo(folder.path(), "w.png").has_value());
  }
  const TempFolder folder;
  for (const char* name : {"v.avif", "v.TIF", "v.PNG", "v.txt"}) write_text(folder / name, "");
  EXPECT_EQ(find_view_photo(folder.path(), "v"), folder / "v.PNG") << "those that can be read come first";
}

TEST(PhotoFiles, NameUnsupportedKinds) {
  const TempFolder folder;
  const std::pair<std::string, std::string> kinds[] = {{"II*\0\x08\0\0\0"s, "a TIFF picture"},
                                                       {"\0\0\0\x18"
                                                        "ftypheic\0\0\0\0"s,
                                                        "a HEIF or AVIF picture"},
                                                       {"\0\0\0\x18"
                                                        "ftypavif\0\0\0\0"s,
                                                        "a HEIF or AVIF picture"},
                                                       {"\0\0\0\x0cJXL \r\n\x87\n"s, "a JPEG XL picture"},
                                                       {"RIFF\x10\0\0\0WEBPVP8 "s, "a WebP picture"},
                                                       {"\xff\x0a\x01\x02"s, "something unknown"}};
  for (const auto& [bytes, words] : kinds) {
    write_text(folder / "v.pic", bytes);
    for (const auto& read : {+[](const std::filesystem::path& p) { load_image(p); },
                             +[](const std::filesystem::path& p) { picture_size(p); }})
      EXPECT_ERROR(read(folder / "v.pic"), "v.pic", "expected PNG, JPEG or OpenEXR (convert it to PNG)",
                   "it looks like " + words);
  }
}

/// Returns a JPEG with an EXIF of one other entry and the orientation.
std::string turned_jpeg(int orientation, bool is_little) {
  const auto number = [&](std::size_t value, std::size_t size) {
    std::string bytes(size, '\0');
    for (std::size_t k = 0; k < size; ++k)
      bytes[is_little ? k : size - 1 - k] = static_cast<char>(value >> (8 * k));
    return bytes;
  };
  const auto entry = [&](std::size_t tag, std::size_t value) {
    return number(tag, 2) + number(3, 2) + number(1, 4) + number(value, 2) + "\0\0"s;
  };
  const std::string tiff = (is_little ? "II" : "MM") + number(42, 2) + number(8, 4) + number(2, 2) +
                           entry(0x100, 6) + entry(0x112, static_cast<std::size_t>(orientation)) +
                           number(0, 4);
  const std::string exif = "Exif\0\0"s + tiff,
                    good = test::encode_jpeg(std::vector<unsigned char>(3 * 64, 100), 8, 8, TJPF_RGB,
                                             TJSAMP_444, 90);
  const std::size_t length = exif.size() + 2;
  return good.substr(0, 2) + "\xff\xe1" + static_cast<char>(length >> 8) + static_cast<char>(length) + exif +
         good.substr(2);
}

/// Reads the photo's size and pixels, twice, in a process of its own.
[[noreturn]] void read_twice(const std::string& bytes) {
  const TempFolder folder;
  for (const char* name : {"v.jpg", "w.jpg"}) {
    write_text(folder / name, bytes);
    if (picture_size(folder / name) != glm::ivec2(8, 8) || load_image(folder / name).channels != 3)
      std::exit(1);
  }
  std::exit(0);
}

TEST(PhotoFilesDeathTest, WarnsOnceOfExifRotation) {
  const testing::ExitedWithCode good(0);
  for (const bool is_little : {false, true}) {
    for (const int turn : {2, 6, 8}) {
      const std::string said =
          "^[^\n]*v.jpg: its EXIF turns it .orientation " + std::to_string(turn) + "[^\n]*\n$";
      EXPECT_EXIT(read_twice(turned_jpeg(turn, is_little)), good, said);
    }
    for (const int upright : {0, 1, 9}) EXPECT_EXIT(read_twice(turned_jpeg(upright, is_little)), good, "^$");
  }
  const std::string whole = turned_jpeg(6, true);
  const std::size_t value = whole.find("\x12\1\3\0\1\0\0\0"s) + 8;
  EXPECT_ERROR(
      {
        const TempFolder folder;
        write_text(folder / "v.jpg", whole.substr(0, value));
        load_image(folder / "v.jpg");
      },
      "v.jpg", "broken JPEG");  // ends before the entry's value
}

}  // namespace
}  // namespace binosplat
