#pragma once
// Shared declarations of the private module _binosplat. binosplat/__init__.py is its public side, with types,
// documentation, defaults of arguments and checks of arrays.
// Functions here run no Python code, such as pathlib, and none of NumPy's copies: both may release Python's
// lock. If Python ends meanwhile, it ends the thread by an exception, which destroys Python's objects without
// the lock.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "base/image.h"
#include "scene/model.h"
#include "stereo/rig.h"

namespace binosplat::python {

namespace py = pybind11;

// Each adds its classes and functions to the module.
void add_errors();
void add_images(py::module_& module);
void add_models(py::module_& module);
void add_cameras(py::module_& module);
void add_renderer(py::module_& module);

template <typename T = float>
using Dense = py::array_t<T, py::array::c_style>;

/// An array with its own copy of the values.
template <typename T>
Dense<T> copied(const std::vector<py::ssize_t>& shape, const T* values) {
  Dense<T> array(shape);
  std::copy_n(values, array.size(), array.mutable_data());
  return array;
}

/// A name, or the path that was found. Bytes that are not UTF-8 become surrogates, as in Python's paths.
inline std::optional<py::str> text_of(const std::optional<std::filesystem::path>& name) {
  if (!name) return std::nullopt;
  return py::reinterpret_steal<py::str>(PyUnicode_DecodeFSDefault(name->c_str()));
}

/// Returns the picture as float32: (height, width, channels), or (height, width) for one channel. Takes over
/// the picture's memory.
py::array array_of(Image&& image);

/// Both eyes of a head, as the package's class Rig stores them.
struct Rig {
  Camera head;                                // used if there are no `eyes`
  std::optional<std::array<Camera, 2>> eyes;  // two given eyes
  stereo::RigSettings settings;

  /// Returns the eyes, with the views of a model with these axes (scene/axes.h). Throws Error as
  /// stereo::make_rig does.
  stereo::EyePair pair(const ModelAxes& axes = {}, double near_plane = near_default) const;
};

bool is_a(py::handle value, const char* name);
Camera camera_of(py::handle value);
py::object object_of(const Camera& camera);
Rig rig_of(py::handle value);

}  // namespace binosplat::python

namespace pybind11::detail {

template <>
struct type_caster<binosplat::Camera> {
  PYBIND11_TYPE_CASTER(binosplat::Camera, const_name("binosplat.Camera"));
  bool load(handle from, bool) {
    const bool is_camera = binosplat::python::is_a(from, "Camera");
    if (is_camera) value = binosplat::python::camera_of(from);
    return is_camera;
  }
  static handle cast(const binosplat::Camera& camera, return_value_policy, handle) {
    return binosplat::python::object_of(camera).release();
  }
};

template <>
struct type_caster<binosplat::python::Rig> {
  PYBIND11_TYPE_CASTER(binosplat::python::Rig, const_name("binosplat.Rig"));
  bool load(handle from, bool) {
    const bool is_rig = binosplat::python::is_a(from, "Rig");
    if (is_rig) value = binosplat::python::rig_of(from);
    return is_rig;
  }
};

}  // namespace pybind11::detail
