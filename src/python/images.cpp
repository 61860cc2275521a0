// Pictures as arrays: from files, with the exposures of photos, and how far two are apart.

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <memory>
#include <new>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/memory.h"
#include "formats/exposures.h"
#include "formats/image_file.h"
#include "formats/model_file.h"
#include "measure/comparison.h"
#include "python/help.h"
#include "python/module.h"
#include "python/unlocked.h"

namespace binosplat::python {

namespace {

using measure::Comparison;

template <typename T>
bool holds(const py::array& array) {
  return py::isinstance<py::array_t<T>>(array);
}

template <typename T>
void fill(Image& image, const py::array& array, float white) {
  if (!holds<T>(array)) return;
  const auto dense = py::array_t<T, py::array::c_style>::ensure(array);
  if (!dense) throw std::bad_alloc();  // which is what NumPy may lack: the type is right
  for (std::size_t k = 0; k < image.data.size(); ++k)
    image.data[k] = static_cast<float>(dense.data()[k]) / white;
}

/// A picture of the array's shape, all zeros.
Image empty_image(const py::array& array, const std::string& name) {
  constexpr double most_pixels = 2147483648.0;
  const auto side = [&](py::ssize_t axis) { return array.ndim() > axis ? array.shape(axis) : 1; };
  const bool is_picture = (array.ndim() == 2 || array.ndim() == 3) &&
                          (side(2) == 1 || side(2) == 3 || side(2) == 4) &&
                          static_cast<double>(side(0)) * static_cast<double>(side(1)) < most_pixels &&
                          side(0) < most_pixels && side(1) < most_pixels;
  if (!is_picture) {
    fail(
        "{}: an array of shape {} is no picture: expected (height, width) or (height, width, channels) with "
        "1, 3 or 4 channels",
        name, std::string(py::str(array.attr("shape"))));
  }
  if (4.0 * static_cast<double>(array.size()) > memory_bytes()) throw std::bad_alloc();
  return {static_cast<int>(side(1)), static_cast<int>(side(0)), static_cast<int>(side(2))};
}

/// Refuses floats that count to 255: a picture that is twice as bright as white in the mean, or that has
/// whole numbers only.
void check_white(const Image& image, const std::string& name) {
  double sum = 0.0;
  float largest = 0.0f;
  bool is_whole = true;
  for (const float v : image.data) {
    if (!std::isfinite(v)) return;
    sum += v;
    largest = std::max(largest, v);
    is_whole = is_whole && v == std::floor(v);
  }
  const double mean = sum / static_cast<double>(std::max<std::size_t>(1, image.data.size()));
  if (!(largest > 1.0f && is_whole) && !(mean > 2.0)) return;
  fail(
      "{}: floats have white 1, but these go up to {:.6g} with a mean of {:.3g}: divide them by their white, "
      "or "
      "pass uint8 or uint16; a picture that is so bright can be clipped to 0 to 1 before",
      name, largest, mean);
}

void check_png_name(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending != ".png") fail("{}: save_png writes PNG, so the name must end in .png", path.string());
}

Comparison compare(const py::object& a, const py::object& b, double pixels_per_degree,
                   const std::optional<std::array<float, 3>>& background) {
  Image first = image_of(a, "a"), second = image_of(b, "b");
  const Unlocked unlocked;
  Background behind;
  if (background) behind = glm::vec3((*background)[0], (*background)[1], (*background)[2]);
  if (behind && glm::clamp(*behind, 0.0f, 1.0f) != *behind)
    fail("background: expected three numbers from 0 to 1");
  measure::make_shown(first, second, behind);
  return measure::compare(first, second, pixels_per_degree);
}

using ExposureRows = std::array<std::array<float, 4>, 3>;

/// As exposure.json has them, and as exposed() of base/image.h takes them.
glm::mat4x3 exposure_of(const ExposureRows& rows) {
  glm::mat4x3 exposure;
  for (int i = 0; i < 3; ++i) {
    const auto& row = rows[static_cast<std::size_t>(i)];
    for (const float v : row)
      if (!std::isfinite(v)) fail("exposure: expected three rows of four finite numbers");
    exposure[i] = {row[0], row[1], row[2]};
    exposure[3][i] = row[3];
  }
  return exposure;
}

py::array rows_of(const glm::mat4x3& exposure) {
  py::array_t<float> rows({3, 4});
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) rows.mutable_at(i, j) = exposure[i][j];
    rows.mutable_at(i, 3) = exposure[3][i];
  }
  return rows;
}

py::array exposed_picture(const py::object& picture, const ExposureRows& exposure) {
  const Image image = image_of(picture, "picture");
  if (image.channels != 3) fail("picture: an exposure is of RGB, and this has {} channels", image.channels);
  return array_of(exposed(image, exposure_of(exposure)));
}

void add_exposures(py::module_& module) {
  py::class_<Exposures>(module, "Exposures", "What a training made of each picture before it saw the photo.")
      .def_property_readonly(
          "source", [](const Exposures& e) { return e.file().string(); }, "The file.")
      .def("__len__", &Exposures::count)
      .def(
          "of", [](const Exposures& e, const std::string& view) { return rows_of(e.of(view)); },
          py::arg("view"),
          "Three rows of four numbers, for exposed(); those that change nothing for a view without one.");
  module.def(
      "load_exposures", [](const std::filesystem::path& path) { return Exposures(path); }, py::arg("path"),
      help::load_exposures);
  module.def("find_exposures", &find_exposures, py::arg("model"),
             "The exposure.json of a model's training, beside the model's path; None without.");
  module.def("exposed", &exposed_picture, py::arg("picture"), py::arg("exposure"), help::exposed);
}

std::string describe_comparison(const Comparison& found) {
  return fmt::format("Comparison(psnr={:.4f}, ssim={:.6f}, flip={:.6f}, largest_error={:.6f})", found.psnr,
                     found.ssim, found.flip, found.largest.max);
}

}  // namespace

py::array array_of(Image&& image) {
  auto owner = std::make_unique<Image>(std::move(image));
  std::vector<py::ssize_t> shape = {owner->height, owner->width};
  if (owner->channels != 1) shape.push_back(owner->channels);
  const float* const data = owner->data.data();
  const py::capsule keep(owner.get(), [](void* kept) { delete static_cast<Image*>(kept); });
  static_cast<void>(owner.release());
  return py::array_t<float>(shape, data, keep);
}

Image image_of(const py::object& picture, const std::string& name) {
  refuse_masked(picture, name);
  const py::array array = py::array::ensure(picture);
  if (!array) throw py::type_error(name + ": expected an array");
  if (!holds<float>(array) && !holds<double>(array) && !holds<std::uint8_t>(array) &&
      !holds<std::uint16_t>(array)) {
    throw py::type_error(fmt::format("{}: pictures are arrays of float32, float64, uint8 or uint16, not {}",
                                     name, std::string(py::str(array.dtype()))));
  }
  Image image = empty_image(array, name);
  fill<float>(image, array, 1.0f);
  fill<double>(image, array, 1.0f);
  if (holds<float>(array) || holds<double>(array)) check_white(image, name);
  fill<std::uint8_t>(image, array, 255.0f);
  fill<std::uint16_t>(image, array, 65535.0f);
  return image;
}

void add_images(py::module_& module) {
  // Looks NumPy up, once: two threads whose first arrays come at the same time would wait for each other.
  const py::array_t<float> first(0);
  module.def(
      "load_image",
      [](const std::filesystem::path& path) {
        Image image;
        {
          const Unlocked unlocked;
          image = load_image(path);
        }
        return array_of(std::move(image));
      },
      py::arg("path"), help::load_image);
  module.def(
      "save_png",
      [](const std::filesystem::path& path, const py::object& picture, int bits) {
        check_png_name(path);
        if (bits != 8 && bits != 16) fail("bits {}: expected 8 or 16", bits);
        const Image image = image_of(picture, "picture");
        const Unlocked unlocked;
        save_png(path, image, {.bits = bits});
      },
      py::arg("path"), py::arg("picture"), py::arg("bits") = 8, help::save_png);
  module.def(
      "quantised",
      [](const py::object& picture) { return array_of(quantised(image_of(picture, "picture"))); },
      py::arg("picture"), help::quantised);

  add_exposures(module);
  py::class_<Comparison>(module, "Comparison", "By how much two pictures differ.")
      .def_readonly("psnr", &Comparison::psnr,
                    "dB; inf for equal pictures, nan where one holds a NaN or an infinity.")
      .def_readonly(
          "ssim", &Comparison::ssim,
          "At most 1, that of equal pictures; nan for pictures below 11 x 11 px or with such a value.")
      .def_readonly("flip", &Comparison::flip, "Mean of FLIP's map, 0 to 1; nan likewise.")
      .def_property_readonly(
          "largest_error", [](const Comparison& c) { return c.largest.max; },
          "Of a channel, absolute, of white 1.")
      .def_property_readonly(
          "at",
          [](const Comparison& c) { return py::make_tuple(c.largest.y, c.largest.x, c.largest.channel); },
          "Row, column and channel of the largest error, or of the first NaN or infinity.")
      .def("__repr__", &describe_comparison);
  module.def("compare", &compare, py::arg("a"), py::arg("b"),
             py::arg("ppd") = measure::flip_pixels_per_degree, py::arg("background") = py::none(),
             help::compare);
}

}  // namespace binosplat::python
