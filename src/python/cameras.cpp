// Cameras and rigs: from files, made up for a model, or given by numbers.

#include <algorithm>
#include <cmath>
#include <memory>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "base/error.h"
#include "formats/cameras_file.h"
#include "formats/dataparser.h"
#include "formats/lens.h"
#include "formats/view_files.h"
#include "python/help.h"
#include "python/module.h"
#include "python/rig.h"
#include "python/unlocked.h"
#include "scene/axes.h"
#include "scene/framing.h"

namespace binosplat::python {

stereo::EyePair Rig::pair(const ModelAxes& axes, double near_plane) const {
  if (eyes)
    return stereo::rig_from_eyes(into_axes((*eyes)[0], axes), into_axes((*eyes)[1], axes), near_plane);
  stereo::RigSettings of_frame = settings;
  of_frame.near_plane = near_plane;
  return stereo::make_rig(into_axes(head, axes), of_frame);
}

namespace {

using Three = std::array<double, 3>;
using Rows = std::array<Three, 3>;

/// All cameras of a file, by number and by name.
struct Cameras {
  std::string source;
  std::vector<Camera> list;

  const Camera& by_number(std::ptrdiff_t i) const {
    const auto count = static_cast<std::ptrdiff_t>(list.size());
    if (i < -count || i >= count) throw py::index_error(fmt::format("camera {} of {}", i, count));
    return list[static_cast<std::size_t>(i < 0 ? i + count : i)];
  }
  const Camera& by_name(const std::string& name) const {
    const auto found = std::ranges::find(list, name, &Camera::name);
    if (found == list.end()) fail_no_camera(name, source, list);
    return *found;
  }
};

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
                   const Rows& rotation, const std::string& name) {
  Camera camera;
  camera.name = name;
  camera.width = width;
  camera.height = height;
  camera.fx = fx;
  camera.fy = fy.value_or(fx);
  camera.cx = cx.value_or(width / 2.0);
  camera.cy = cy.value_or(height / 2.0);
  camera.position = vector_of("position", position);
  camera.rotation = matrix_of(rotation);
  const std::string what = name.empty() ? "camera" : "camera " + name;
  check_lens(what, camera);
  if (const std::string fault = rotation_fault(camera.rotation); !fault.empty())
    fail("{}: rotation: {}", what, fault);
  return camera;
}

void check_size(int width, int height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = 1.0;
  check_lens("camera", camera);
}

void check_fov(double degrees) {
  if (!(degrees > 0.0 && degrees < 180.0)) fail("fov {}: expected degrees above 0 and below 180", degrees);
}

py::array_t<double> to_array(const glm::dvec3& vector) { return py::array_t<double>(3, &vector.x); }

py::array_t<double> to_array(const glm::dmat3& matrix) {
  const glm::dmat3 rows = glm::transpose(matrix);
  return py::array_t<double>({3, 3}, &rows[0].x);
}

std::string describe_camera(const Camera& c) {
  return fmt::format("<binosplat.Camera {}: {} x {} px at {:.4g}, {:.4g}, {:.4g}>", c.name, c.width, c.height,
                     c.position.x, c.position.y, c.position.z);
}

/// What a pickle has of a camera: every number as it is.
py::tuple state_of(const Camera& c) {
  return py::make_tuple(c.name, c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.time, to_array(c.position),
                        to_array(c.rotation));
}

Camera camera_of(const py::tuple& state) {
  using State =
      std::tuple<std::string, int, int, double, double, double, double, std::optional<double>, Three, Rows>;
  Camera c;
  Three position;
  Rows rotation;
  std::tie(c.name, c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.time, position, rotation) =
      py::cast<State>(state);
  c.position = vector_of("position", position);
  c.rotation = matrix_of(rotation);
  return c;
}

py::tuple state_of_rig(const Rig& rig) {
  const auto& s = rig.settings;
  return py::make_tuple(rig.head, rig.eyes, s.ipd, s.units_per_metre, s.convergence, s.cant_degrees);
}

Rig rig_of(const py::tuple& state) {
  return {state[0].cast<Camera>(),
          state[1].cast<std::optional<std::array<Camera, 2>>>(),
          {state[2].cast<double>(), state[3].cast<double>(), state[4].cast<std::optional<double>>(),
           state[5].cast<double>()}};
}

Rig make_rig(const Camera& head, double ipd, double units_per_metre, const std::optional<double>& convergence,
             double cant) {
  Rig rig{head, {}, {ipd, units_per_metre, convergence, cant}};
  rig.pair();  // throws for what makes no rig
  return rig;
}

constexpr Three up_in_colmap = {default_up.x, default_up.y, default_up.z};

void add_camera(py::module_& module) {
  py::class_<Camera>(module, "Camera", help::camera)
      .def(py::init(&make_camera), py::arg("width"), py::arg("height"), py::arg("fx"), py::kw_only(),
           py::arg("fy") = py::none(), py::arg("cx") = py::none(), py::arg("cy") = py::none(),
           py::arg("position") = Three{}, py::arg("rotation") = Rows{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
           py::arg("name") = "")
      .def_readonly("name", &Camera::name)
      .def_readonly("width", &Camera::width, "px")
      .def_readonly("height", &Camera::height, "px")
      .def_readonly("fx", &Camera::fx, "px")
      .def_readonly("fy", &Camera::fy, "px")
      .def_readonly("cx", &Camera::cx, "px from the left edge")
      .def_readonly("cy", &Camera::cy, "px from the upper edge")
      .def_readonly("time", &Camera::time, "s, of a path; None elsewhere")
      .def_property_readonly(
          "position", [](const Camera& c) { return to_array(c.position); }, "(3,), world units; a copy.")
      .def_property_readonly(
          "rotation", [](const Camera& c) { return to_array(c.rotation); },
          "(3, 3), camera to world; a copy.")
      .def(
          "resized",
          [](const Camera& camera, int width, int height) {
            check_size(width, height);
            return resized(camera, width, height);
          },
          py::arg("width"), py::arg("height"), help::resized)
      .def(py::pickle(&state_of, &camera_of))
      .def("__repr__", &describe_camera);
  module.def(
      "look_at",
      [](const Three& eye, const Three& at, int width, int height, const Three& up, double fov) {
        check_size(width, height);
        check_fov(fov);
        return look_at(vector_of("eye", eye), vector_of("at", at), vector_of("up", up), fov, width, height);
      },
      py::arg("eye"), py::arg("at"), py::arg("width"), py::arg("height"), py::kw_only(),
      py::arg("up") = up_in_colmap, py::arg("fov") = default_fov_degrees, help::look_at);
  module.def(
      "frame",
      [](const std::shared_ptr<Model>& model, int width, int height, const Three& up, double fov) {
        check_size(width, height);
        check_fov(fov);
        const glm::dvec3 upwards = vector_of("up", up);
        const Unlocked unlocked;
        return frame_model(*model, width, height, fov, {upwards});
      },
      py::arg("model").none(false), py::arg("width"), py::arg("height"), py::kw_only(),
      py::arg("up") = up_in_colmap, py::arg("fov") = default_fov_degrees, help::frame);
}

void add_list(py::module_& module) {
  py::class_<Cameras>(module, "Cameras", "The cameras of a file, in its order: by number, or by name.")
      .def_readonly("source", &Cameras::source, "The file or folder.")
      .def("__len__", [](const Cameras& c) { return c.list.size(); })
      .def("__getitem__", &Cameras::by_number, py::arg("number"))
      .def("__getitem__", &Cameras::by_name, py::arg("name"),
           "The first camera of this name. Raises InputError, which names some that there are.")
      .def(
          "__iter__", [](const Cameras& c) { return py::make_iterator(c.list.begin(), c.list.end()); },
          py::keep_alive<0, 1>())
      .def(py::pickle([](const Cameras& c) { return py::make_tuple(c.source, c.list); },
                      [](const py::tuple& state) {
                        return Cameras{state[0].cast<std::string>(), state[1].cast<std::vector<Camera>>()};
                      }))
      .def("__repr__", [](const Cameras& c) {
        return fmt::format("<binosplat.Cameras: {} of {}>", c.list.size(), c.source);
      });
  module.def(
      "load_cameras",
      [](const std::optional<std::filesystem::path>& path,
         const std::optional<std::filesystem::path>& model) {
        if (!path) fail("load_cameras: the path is None, as find_cameras() says where it finds none");
        const Unlocked unlocked;
        Cameras cameras{path->string(), load_cameras(*path)};
        const auto dataparser = model ? find_dataparser(*model) : std::nullopt;
        if (dataparser) move_into_training(*dataparser, *path, cameras.list);
        return cameras;
      },
      py::arg("path"), py::arg("model") = py::none(), help::load_cameras);
  module.def("find_cameras", &find_cameras, py::arg("model"),
             "The file or folder with the cameras of a model, beside the model's path; None without.");
  module.def("find_photos", &find_photos, py::arg("cameras"),
             "The folder of the photos that cameras were found from, beside the cameras' path; or None.");
  module.def(
      "find_photo",
      [](const std::filesystem::path& folder, const std::variant<Camera, std::string>& view) {
        return std::visit([&](const auto& of) { return find_view_photo(folder, of); }, view);
      },
      py::arg("folder"), py::arg("view"),
      "A view's photo in a folder, by the camera or its name, with or without a picture's ending; or None.");
}

}  // namespace

void add_cameras(py::module_& module) {
  add_camera(module);
  add_list(module);
  py::class_<Rig>(module, "Rig", help::rig)
      .def(py::init(&make_rig), py::arg("head"), py::kw_only(), py::arg("ipd") = stereo::RigSettings().ipd,
           py::arg("units_per_metre") = 1.0, py::arg("convergence") = py::none(), py::arg("cant") = 0.0)
      .def_static(
          "of_eyes",
          [](const Camera& left, const Camera& right) {
            return Rig{{}, std::array{left, right}, {}};
          },
          py::arg("left"), py::arg("right"), "The rig of two cameras that are given as a pair.")
      .def_property_readonly(
          "eyes",
          [](const Rig& rig) {
            const auto pair = rig.pair();
            return py::make_tuple(pair.cameras[0], pair.cameras[1]);
          },
          "The cameras of the left and of the right eye.")
      .def(py::pickle(&state_of_rig, &rig_of));
}

}  // namespace binosplat::python
