// Pictures as arrays: files, exposures of photos, and comparisons.

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <utility>

#include "base/error.h"
#include "formats/models/model_file.h"
#include "formats/pictures/image_file.h"
#include "formats/training/exposures.h"
#include "measure/comparison.h"
#include "python/module.h"
#include "python/released_gil.h"

namespace binosplat::python {

namespace {

/// Converts an array from the package's _picture().
Image image_of(const Dense<>& array) {
  const auto side = [&](py::ssize_t axis) {
    return static_cast<int>(array.ndim() > axis ? array.shape(axis) : 1);
  };
  Image image(side(1), side(0), side(2));
  std::copy_n(array.data(), array.size(), image.data.begin());
  return image;
}

py::array image_at(const std::filesystem::path& path) {
  Image image;
  {
    const ReleasedGil released;
    image = load_image(path);
  }
  return array_of(std::move(image));
}

void write_png(const std::filesystem::path& path, const Dense<>& picture, int bits) {
  const Image image = image_of(picture);
  const ReleasedGil released;
  save_png(path, image, {.bits = bits});
}

measure::Comparison compare_images(Image& first, Image& second, double pixels_per_degree,
                                   const std::optional<std::array<float, 3>>& background) {
  const ReleasedGil released;
  Background behind;
  if (background) behind = glm::vec3((*background)[0], (*background)[1], (*background)[2]);
  if (behind && glm::clamp(*behind, 0.0f, 1.0f) != *behind)
    fail("background: expected three numbers from 0 to 1");
  measure::prepare_comparison(first, second, behind);
  return measure::compare(first, second, pixels_per_degree);
}

/// The members of the package's Comparison, in its order.
py::tuple compare(const Dense<>& a, const Dense<>& b, double pixels_per_degree,
                  const std::optional<std::array<float, 3>>& background) {
  Image first = image_of(a), second = image_of(b);
  const auto found = compare_images(first, second, pixels_per_degree, background);
  const auto& largest = found.largest;
  return py::make_tuple(found.psnr, found.ssim, found.flip, largest.max,
                        py::make_tuple(largest.y, largest.x, largest.channel));
}

/// The exposure in the form of base/image.h: four columns of three numbers.
py::array columns_of(const Exposures& exposures, const std::filesystem::path& view) {
  const glm::mat4x3 columns = exposures.of(view.string());
  return copied({4, 3}, &columns[0].x);
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

void add_images(py::module_& module) {
  // Imports NumPy now: if two threads made their first arrays at once, they would deadlock.
  const py::array_t<float> first(0);
  module.def("load_image", &image_at, py::arg("path"));
  module.def("save_png", &write_png, py::arg("path"), py::arg("picture"), py::arg("bits"));
  module.def("quantised", [](const Dense<>& picture) { return array_of(quantised(image_of(picture))); });
  module.def("compare", &compare, py::arg("a"), py::arg("b"), py::arg("ppd"), py::arg("background"));
  py::class_<Exposures>(module, "Exposures")
      .def(py::init<const std::filesystem::path&>(), py::arg("path"))
      .def_property_readonly("count", &Exposures::count)
      .def("of", &columns_of, py::arg("view"));
  module.def(
      "find_exposures", [](const std::filesystem::path& model) { return text_of(find_exposures(model)); },
      py::arg("model"));
}

}  // namespace binosplat::python
