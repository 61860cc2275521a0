// Cameras and rigs: read from files, made from a model, or given by numbers.

#include <fmt/ranges.h>

#include <cmath>
#include <memory>
#include <tuple>
#include <variant>
#include <vector>

#include "base/error.h"
#include "formats/cameras/cameras_file.h"
#include "formats/cameras/dataparser.h"
#include "formats/cameras/lens.h"
#include "formats/cameras/view_files.h"
#include "python/module.h"
#include "python/released_gil.h"
#include "scene/framing.h"

namespace binosplat::python {

stereo::EyePair Rig::pair(const ModelAxes& axes, double near_plane) const {
  if (eyes) return stereo::rig_from_eyes((*eyes)[0], (*eyes)[1], near_plane, axes);
  stereo::RigSettings of_frame = settings;
  of_frame.near_plane = near_plane;
  return stereo::make_rig(head, of_frame, axes);
}

namespace {

namespace fs = std::filesystem;
using Three = std::array<double, 3>;
using Rows = std::array<Three, 3>;

glm::dvec3 vector_of(const char* name, const Three& values) {
  for (const double value : values) {
    if (!std::isfinite(value)) fail("{} {}: expected finite numbers", name, fmt::join(values, ", "));
  }
  return {values[0], values[1], values[2]};
}

glm::dmat3 matrix_of(const Rows& rows) {
  return glm::transpose(glm::dmat3(vector_of("rotation", rows[0]), vector_of("rotation", rows[1]),
                                   vector_of("rotation", rows[2])));
}

Camera make_camera(int width, int height, double fx, const std::optional<double>& fy,
                   const std::optional<double>& cx, const std::optional<double>& cy, const Three& position,
                   const Rows& rotation, const fs::path& name) {
  Camera camera;
  camera.name = name.string();
  camera.width = width;
  camera.height = height;
  camera.fx = fx;
  camera.fy = fy.value_or(fx);
  camera.cx = cx.value_or(width / 2.0);
  camera.cy = cy.value_or(height / 2.0);
  camera.position = vector_of("position", position);
  camera.rotation = matrix_of(rotation);
  const std::string what = name.empty() ? "camera" : "camera " + camera.name;
  check_lens(what, camera);
  if (const std::string fault = rotation_fault(camera.rotation); !fault.empty())
    fail("{}: rotation: {}", what, fault);
  return camera;
}

void check_size(int width, int height) {
  check_lens("camera", {.width = width, .height = height, .fx = 1.0, .fy = 1.0});
}

void check_fov(double degrees) {
  if (!(degrees > 0.0 && degrees < 180.0)) fail("fov {}: expected degrees above 0 and below 180", degrees);
}

Camera looking_at(const Three& eye, const Three& at, int width, int height, const Three& up, double fov) {
  check_size(width, height);
  check_fov(fov);
  return look_at(vector_of("eye", eye), vector_of("at", at), vector_of("up", up), fov, width, height);
}

Camera framing(const std::shared_ptr<Model>& model, int width, int height, const std::optional<Three>& up,
               double fov) {
  check_size(width, height);
  check_fov(fov);
  const auto upwards = up ? std::optional(vector_of("up", *up)) : std::nullopt;
  if (up && !std::isnormal(glm::length(*upwards))) fail("up {}: expected a direction", fmt::join(*up, ", "));
  const ReleasedGil released;
  return frame_model(*model, width, height, fov, upwards);
}

std::vector<Camera> cameras_at(const fs::path& path, const std::optional<fs::path>& model) {
  const ReleasedGil released;
  std::vector<Camera> cameras = load_cameras(path);
  const auto dataparser = model ? find_dataparser(*model) : std::nullopt;
  if (dataparser) move_into_training(*dataparser, path, cameras);
  return cameras;
}

/// A read-only array with its own copy of the numbers.
py::array constant(const std::vector<py::ssize_t>& shape, const double* values) {
  py::array array = copied(shape, values);
  array.attr("flags").attr("writeable") = false;
  return array;
}

py::object class_of(const char* name) { return py::module_::import("binosplat").attr(name); }

}  // namespace

bool is_a(py::handle value, const char* name) { return py::isinstance(value, class_of(name)); }

py::object object_of(const Camera& c) {
  using namespace py::literals;
  const glm::dmat3 rows = glm::transpose(c.rotation);
  const py::object type = class_of("Camera");
  py::object made = type.attr("__new__")(type);
  made.attr("__dict__")
      .attr("update")("name"_a = text_of(c.name), "width"_a = c.width, "height"_a = c.height, "fx"_a = c.fx,
                      "fy"_a = c.fy, "cx"_a = c.cx, "cy"_a = c.cy, "time"_a = c.time,
                      "position"_a = constant({3}, &c.position.x),
                      "rotation"_a = constant({3, 3}, &rows[0].x), "_short_name"_a = text_of(c.short_name));
  return made;
}

Camera camera_of(py::handle value) {
  Camera c;
  const auto take = [&]<typename T>(T& to, const char* name) { to = value.attr(name).cast<T>(); };
  c.name = value.attr("name").cast<fs::path>().string();
  take(c.width, "width");
  take(c.height, "height");
  take(c.fx, "fx");
  take(c.fy, "fy");
  take(c.cx, "cx");
  take(c.cy, "cy");
  take(c.time, "time");
  c.short_name = value.attr("_short_name").cast<fs::path>().string();
  c.position = vector_of("position", value.attr("position").cast<Three>());
  c.rotation = matrix_of(value.attr("rotation").cast<Rows>());
  return c;
}

Rig rig_of(py::handle value) {
  using Parts =
      std::tuple<Camera, std::optional<std::array<Camera, 2>>, double, double, std::optional<double>, double>;
  const auto [head, eyes, ipd, units, convergence, cant] = value.attr("_parts").cast<Parts>();
  return {head, eyes, {ipd, units, convergence, cant}};
}

void add_cameras(py::module_& module) {
  module.def("camera", &make_camera, py::arg("width"), py::arg("height"), py::arg("fx"), py::arg("fy"),
             py::arg("cx"), py::arg("cy"), py::arg("position"), py::arg("rotation"), py::arg("name"));
  module.def(
      "resized",
      [](const Camera& camera, int width, int height) {
        check_size(width, height);
        return resized(camera, width, height);
      },
      py::arg("camera"), py::arg("width"), py::arg("height"));
  module.def("look_at", &looking_at, py::arg("eye"), py::arg("at"), py::arg("width"), py::arg("height"),
             py::arg("up"), py::arg("fov"));
  module.def("frame", &framing, py::arg("model"), py::arg("width"), py::arg("height"), py::arg("up"),
             py::arg("fov"));
  module.def("load_cameras", &cameras_at, py::arg("path"), py::arg("model"));
  module.def("test_split", [](const fs::path& source, const std::vector<Camera>& cameras, bool training) {
    const TestSplit split = test_split(resolve_cameras(source).string(), cameras, {});
    py::list names;
    for (const std::string& name : training ? split.training : split.test) names.append(text_of(name));
    return names;
  });
  module.def("fail_no_camera",
             [](const fs::path& name, const fs::path& source, const std::vector<Camera>& cameras) {
               fail_no_camera(name.string(), source.string(), cameras);
             });
  module.def(
      "find_cameras", [](const fs::path& model) { return text_of(find_cameras(model)); }, py::arg("model"));
  module.def(
      "find_photos", [](const fs::path& cameras) { return text_of(find_photos(cameras)); },
      py::arg("cameras"));
  module.def(
      "find_photo",
      [](const fs::path& folder, const std::variant<Camera, fs::path>& view) {
        return text_of(std::visit([&](const auto& of) { return find_view_photo(folder, of); }, view));
      },
      py::arg("folder"), py::arg("view"));
  module.def("eyes", [](const Rig& rig) {
    const auto pair = rig.pair();
    return py::make_tuple(pair.cameras[0], pair.cameras[1]);
  });
}

}  // namespace binosplat::python
