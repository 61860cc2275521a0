// Models from arrays, and back.

#include <cmath>
#include <functional>
#include <initializer_list>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/memory.h"
#include "python/module.h"
#include "python/unlocked.h"
#include "scene/axes.h"
#include "scene/model.h"

namespace binosplat::python {

namespace {

template <typename T>
using Dense = py::array_t<T, py::array::c_style | py::array::forcecast>;
using Floats = Dense<float>;

/// NumPy's array of what is one, gives one, or lends its memory by DLPack; a tensor that is being trained is
/// detached first.
py::array as_array(const py::object& given, const char* name) {
  refuse_masked(given, name);
  const py::object values = py::hasattr(given, "detach") ? given.attr("detach")() : given;
  const bool lends = !py::hasattr(values, "__array__") && py::hasattr(values, "__dlpack__");
  const auto numpy = py::module_::import("numpy");
  const py::object array = numpy.attr(lends ? "from_dlpack" : "asarray")(values);
  if (const std::string kind = py::str(array.attr("dtype").attr("kind")); kind != "f") {
    throw py::type_error(fmt::format("{}: expected an array of floats, not of {}", name,
                                     std::string(py::str(array.attr("dtype")))));
  }
  return py::array(array);
}

/// The values as dense rows of a shape: -1 is any size. Throws Error for another shape.
template <typename T = float>
Dense<T> floats_of(const py::object& given, const char* name, std::initializer_list<py::ssize_t> shape) {
  const py::array array = as_array(given, name);
  bool fits = array.ndim() == static_cast<py::ssize_t>(shape.size());
  py::ssize_t axis = 0;
  for (const py::ssize_t size : shape) fits = fits && (size < 0 || size == array.shape(axis)) && ++axis > 0;
  if (!fits) {
    std::string expected;
    for (const py::ssize_t size : shape)
      expected += (expected.empty() ? "" : ", ") + (size < 0 ? std::string("N") : std::to_string(size));
    fail("{}: an array of shape {}: expected ({}{})", name, std::string(py::str(array.attr("shape"))),
         expected, shape.size() == 1 ? "," : "");
  }
  if (static_cast<double>(array.size()) * (4.0 + sizeof(T)) > memory_bytes()) throw std::bad_alloc();
  auto dense = Dense<T>::ensure(array);
  if (!dense) throw std::bad_alloc();  // which is what NumPy may lack: the type is right
  return dense;
}

/// Of (N, 1, 3), (N, 4, 3), (N, 9, 3) or (N, 16, 3): the degree of the spherical harmonics.
int degree_of(const py::array& sh) {
  for (int degree = 0; degree <= 3 && sh.ndim() == 3; ++degree) {
    if (sh.shape(1) == sh_count(degree)) return degree;
  }
  fail(
      "sh: an array of shape {}: expected (N, 1, 3), (N, 4, 3), (N, 9, 3) or (N, 16, 3), the coefficients of "
      "the spherical harmonics; of plain RGB they are ((rgb - 0.5) / {})[:, None]",
      std::string(py::str(sh.attr("shape"))), sh_c0);
}

/// The five arrays, dense.
struct Columns {
  Dense<double> means;
  Floats quats, scales, opacities, sh;
};

void fail_at(const char* name, std::size_t row, std::string_view why) { fail("{}[{}]: {}", name, row, why); }

/// Why a row is no Gaussian.
void check_row(const GaussianValues& values, std::size_t row, int coefficients) {
  const auto finite = [](const auto* of, int count) {
    for (int k = 0; k < count; ++k) {
      if (!std::isfinite(static_cast<float>(of[k]))) return false;
    }
    return true;
  };
  const char* const not_finite = "expected finite numbers";
  if (!finite(&values.position.x, 3)) fail_at("means", row, not_finite);
  if (!finite(&values.rotation.x, 4)) fail_at("quats", row, not_finite);
  if (values.rotation == glm::vec4(0.0f)) fail_at("quats", row, "a quaternion of zeros turns nothing");
  if (!finite(&values.scale.x, 3)) fail_at("scales", row, not_finite);
  if (glm::any(glm::lessThan(values.scale, glm::vec3(0.0f))))
    fail_at("scales", row, "below 0: expected standard deviations, which are exp() of what trainers store");
  if (!(values.opacity >= 0.0f && values.opacity <= 1.0f))
    fail_at("opacities", row, "expected 0 to 1, which is the sigmoid of what trainers store");
  if (!finite(values.sh, coefficients)) fail_at("sh", row, not_finite);
  fail_at("scales", row, "above 1e13, which cannot be drawn");
}

void fill_rows(Model& model, const Columns& from) {
  const std::size_t count = model.count();
  const int coefficients = 3 * sh_count(model.degree);
  for (std::size_t i = 0; i < count; ++i) {
    const double* p = from.means.data() + 3 * i;
    const float *q = from.quats.data() + 4 * i, *s = from.scales.data() + 3 * i;
    const GaussianValues values{{p[0], p[1], p[2]},
                                {s[0], s[1], s[2]},
                                {q[0], q[1], q[2], q[3]},
                                from.opacities.data()[i],
                                from.sh.data() + static_cast<std::size_t>(coefficients) * i};
    if (!place(model, i, values)) check_row(values, i, coefficients);
  }
}

/// What else a trainer knows of its model.
struct Training {
  std::string name, axes;
  bool antialiased;
};

std::shared_ptr<Model> model_of(const Columns& columns, int degree, const Training& training) {
  auto model = std::make_shared<Model>();
  model->name = training.name;
  model->format = "arrays";
  model->degree = degree;
  model->antialiased = training.antialiased;
  world_from_axes(training.axes);
  model->axes.letters = training.axes;
  if (columns.means.shape(0) == 0) fail("means: no Gaussians: expected one row or more");
  model->resize(static_cast<std::size_t>(columns.means.shape(0)));
  const Unlocked unlocked;
  fill_rows(*model, columns);
  if (choose_origin(*model)) fill_rows(*model, columns);
  return model;
}

/// A copy of so many rows.
template <typename Row>
py::array_t<typename Row::value_type> array_of_rows(const std::vector<Row>& rows) {
  const auto* const first = reinterpret_cast<const typename Row::value_type*>(rows.data());
  return py::array_t<typename Row::value_type>(
      {static_cast<py::ssize_t>(rows.size()), static_cast<py::ssize_t>(Row::length())}, first);
}

/// From zero, which far away takes doubles.
py::array means_of(const Model& model) {
  if (model.axes.origin == glm::dvec3(0.0)) return array_of_rows(model.position);
  std::vector<glm::dvec3> means;
  for (const glm::vec3& p : model.position) means.push_back(model.axes.origin + glm::dvec3(p));
  return array_of_rows(means);
}

/// A property; a Scaffold-GS model has none to show.
template <typename Get>
auto of_gaussians(const char* name, const Get& get) {
  return [name, get](const Model& model) {
    if (model.scaffold) fail("{}: a Scaffold-GS model makes its Gaussians for each eye", name);
    try {
      return get(model);
    } catch (const py::error_already_set& error) {
      if (error.matches(PyExc_MemoryError)) throw std::bad_alloc();
      throw;
    }
  };
}

}  // namespace

void add_model_arrays(py::class_<Model, std::shared_ptr<Model>>& model) {
  model
      .def(py::init([](const py::object& means, const py::object& quats, const py::object& scales,
                       const py::object& opacities, const py::object& sh, const std::string& name,
                       const std::string& axes, bool antialiased) {
             Columns columns;
             columns.means = floats_of<double>(means, "means", {-1, 3});
             const py::ssize_t count = columns.means.shape(0);
             columns.quats = floats_of(quats, "quats", {count, 4});
             columns.scales = floats_of(scales, "scales", {count, 3});
             columns.opacities = floats_of(opacities, "opacities", {count});
             const int degree = degree_of(as_array(sh, "sh"));
             columns.sh = floats_of(sh, "sh", {count, sh_count(degree), 3});
             return model_of(columns, degree, {name, axes, antialiased});
           }),
           py::arg("means"), py::arg("quats"), py::arg("scales"), py::arg("opacities"), py::arg("sh"),
           py::kw_only(), py::arg("name") = "arrays", py::arg("axes") = "RDF", py::arg("antialiased") = false)
      .def_property_readonly("means", of_gaussians("means", &means_of))
      .def_property_readonly("quats",
                             of_gaussians("quats", [](const Model& m) { return array_of_rows(m.rotation); }))
      .def_property_readonly("scales",
                             of_gaussians("scales", [](const Model& m) { return array_of_rows(m.scale); }))
      .def_property_readonly("opacities", of_gaussians("opacities",
                                                       [](const Model& m) {
                                                         return py::array_t<float>(
                                                             static_cast<py::ssize_t>(m.count()),
                                                             m.opacity.data());
                                                       }))
      .def_property_readonly("sh", of_gaussians("sh", [](const Model& m) {
                               return py::array_t<float>(
                                   {static_cast<py::ssize_t>(m.count()),
                                    static_cast<py::ssize_t>(sh_count(m.degree)), py::ssize_t{3}},
                                   m.sh.data());
                             }));
}

}  // namespace binosplat::python
