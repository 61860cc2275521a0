#pragma once
// What the parts of `import binosplat` share.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "base/choices.h"
#include "base/image.h"
#include "scene/model.h"

namespace binosplat::python {

namespace py = pybind11;

// Each adds its classes and functions to the module.
void add_errors(py::module_& module);
void add_images(py::module_& module);
void add_models(py::module_& module);
void add_model_arrays(py::class_<Model, std::shared_ptr<Model>>& model);
void add_cameras(py::module_& module);
void add_renderer(py::module_& module);

/// Throws Error for masked arrays (numpy.ma) with a value that is masked; `name` begins its text.
void refuse_masked(const py::object& array, const std::string& name);

/// The picture as float32 of (height, width, channels), of one channel as (height, width). Takes its memory
/// over.
py::array array_of(Image&& image);

/// The picture that an array is, (height, width) or (height, width, 1, 3 or 4): uint8 and uint16 by their
/// white, floats as they are. `name` begins the texts of errors: TypeError for other types, Error for other
/// shapes.
Image image_of(const py::object& picture, const std::string& name);

/// The number of a choice; nothing for none.
inline std::optional<int> choice(const char* name, const std::optional<std::string>& value,
                                 std::span<const Choice> choices) {
  return value ? std::optional(find_choice(name, *value, choices)) : std::nullopt;
}

}  // namespace binosplat::python
