#include "formats/cameras/ply_camera.h"

#include <cmath>
#include <optional>
#include <vector>

#include "base/error.h"
#include "base/numbers.h"
#include "base/text.h"
#include "formats/cameras/lens.h"
#include "formats/models/ply_binary_numbers.h"
#include "formats/models/ply_rows.h"

namespace binosplat {

namespace {

using Numbers = std::vector<double>;

/// Reads elements whose rows have one number.
class CameraRows {
 public:
  explicit CameraRows(const OpenedFile& file) : path_(file.path), bytes_(file.bytes()), header_(file.ply()) {}

  /// Returns the numbers of the element `name`, in its property `name`; nothing if there is no such element.
  std::optional<Numbers> read(const char* name) const {
    constexpr std::size_t most = 16;  // largest number of rows of a camera's elements
    const PlyElement* element = header_.find(name);
    if (element == nullptr || element->find(name) == nullptr) return std::nullopt;
    if (element->properties.size() != 1 || element->has_list() || element->count > most)
      fail(*element, "expected at most 16 rows of one number");
    Numbers numbers = header_.format == PlyFormat::ascii ? read_text(*element) : read_binary(*element);
    for (const double number : numbers) {
      if (!std::isfinite(number)) fail(*element, "expected finite numbers");
    }
    return numbers;
  }

  std::string source() const { return path_.string(); }
  [[noreturn]] void fail(const PlyElement& element, const std::string& what) const {
    binosplat::fail("{}, element '{}' (a camera's): {}", path_, element.name, what);
  }
  [[noreturn]] void fail(const char* name, const std::string& what) const { fail(*header_.find(name), what); }

 private:
  Numbers read_binary(const PlyElement& wanted) const {
    std::size_t at = header_.data;
    for (const PlyElement& element : header_.elements) {
      if (&element == &wanted) break;
      if (element.has_list()) fail(wanted, "expected only elements without lists before it");
      at = end_of_rows(path_, bytes_, element, at);
    }
    const PlyType type = wanted.properties[0].type;
    end_of_rows(path_, bytes_, wanted, at);
    Numbers numbers;
    for (std::size_t i = 0; i < wanted.count; ++i)
      numbers.push_back(load_ply_number(type, &bytes_[at + i * size_of(type)], is_swapped(header_.format)));
    return numbers;
  }

  Numbers read_text(const PlyElement& wanted) const {
    PlyLines lines(path_, as_text(bytes_), header_);
    for (const PlyElement& element : header_.elements) {
      if (&element == &wanted) break;
      for (std::uint64_t i = 0; i < element.count && !element.properties.empty(); ++i) lines.next(element, i);
    }
    Numbers numbers;
    for (std::uint64_t i = 0; i < wanted.count; ++i) {
      const std::vector<std::string_view> words = words_of(lines.next(wanted, i));
      const std::optional<double> value = parse_real(words[0]);
      if (words.size() != 1 || !value) fail(wanted, "expected rows of one number");
      numbers.push_back(*value);
    }
    return numbers;
  }

  const std::filesystem::path& path_;
  std::span<const std::byte> bytes_;
  const PlyHeader& header_;
};

int pixels(const CameraRows& rows, const char* element, double value) {
  if (!(value >= 1.0 && value <= 2147483647.0) || value != std::floor(value))
    rows.fail(element, fmt::format("{} is not a number of pixels", value));
  return static_cast<int>(value);
}

void set_lens(const CameraRows& rows, const Numbers& intrinsic, Camera& camera) {
  const auto size = rows.read("image_size");
  if (!size) {
    if (intrinsic.size() != 4)
      rows.fail("intrinsic",
                fmt::format("{} numbers; expected 4, or 9 and an element image_size", intrinsic.size()));
    camera.width = pixels(rows, "intrinsic", intrinsic[2]);
    camera.height = pixels(rows, "intrinsic", intrinsic[3]);
    camera.fx = intrinsic[0];
    camera.fy = intrinsic[1];
    camera.cx = 0.5 * camera.width;
    camera.cy = 0.5 * camera.height;
    return;
  }
  if (size->size() != 2)
    rows.fail("image_size", fmt::format("{} numbers; expected width and height", size->size()));
  if (intrinsic.size() != 9)
    rows.fail("intrinsic", fmt::format("{} numbers; expected the 9 of a matrix", intrinsic.size()));
  camera.width = pixels(rows, "image_size", (*size)[0]);
  camera.height = pixels(rows, "image_size", (*size)[1]);
  camera.fx = intrinsic[0];
  camera.fy = intrinsic[4];
  camera.cx = intrinsic[2];
  camera.cy = intrinsic[5];
}

void set_pose(const CameraRows& rows, Camera& camera) {
  const auto extrinsic = rows.read("extrinsic");
  if (!extrinsic) return;
  const bool first_version = extrinsic->size() == 12;
  if (!first_version && extrinsic->size() != 16)
    rows.fail("extrinsic", fmt::format("{} numbers; expected the 16 of a matrix (or 12)", extrinsic->size()));
  // The matrix is world-to-camera, so its rows are the camera's axes; glm stores them as columns here.
  glm::dmat3 axes;
  glm::dvec3 shift;
  for (int row = 0; row < 3; ++row) {
    const double* const values = extrinsic->data() + 4 * static_cast<std::size_t>(row);
    axes[row] = {values[0], values[1], values[2]};
    shift[row] = values[3];
  }
  if (first_version) axes = glm::transpose(axes);
  camera.position = -(glm::inverse(glm::transpose(axes)) * shift);
  if (const std::string fault = make_rotation(rows.source(), axes); !fault.empty())
    rows.fail("extrinsic", fault);
  camera.rotation = axes;
}

}  // namespace

bool has_ply_camera(const PlyHeader& header) {
  const PlyElement* element = header.find("intrinsic");
  return element != nullptr && element->find("intrinsic") != nullptr;
}

Camera load_ply_camera(const OpenedFile& file) {
  const CameraRows rows(file);
  const auto intrinsic = rows.read("intrinsic");
  if (!intrinsic)
    fail("{} is a model without a camera: it lacks the element 'intrinsic', which SHARP writes",
         rows.source());
  Camera camera;
  camera.name = ply_camera_name;
  set_lens(rows, *intrinsic, camera);
  check_lens(fmt::format("{}, element 'intrinsic' (a camera's)", rows.source()), camera);
  set_pose(rows, camera);
  return camera;
}

}  // namespace binosplat
