// Models: from files and arrays, and what they are.

#include <cmath>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "formats/model_file.h"
#include "python/module.h"
#include "python/unlocked.h"
#include "scene/axes.h"
#include "scene/framing.h"
#include "scene/model.h"

namespace binosplat::python {

namespace {

std::shared_ptr<Model> model_at(const std::filesystem::path& path, const std::optional<int>& lod,
                                const std::optional<std::size_t>& appearance,
                                const std::optional<std::string>& axes,
                                const std::optional<bool>& antialiased) {
  if (axes) world_from_axes(*axes);
  const Unlocked unlocked;
  auto model = std::make_shared<Model>(load_model(path, {lod, appearance}));
  model->axes.letters = axes.value_or(model->axes.letters);
  if (antialiased) {
    model->antialiased = *antialiased;
    model->antialiased_by = "antialiased=";
  }
  return model;
}

/// The five arrays, all of as many rows; sh of (N, 1, 3), (N, 4, 3), (N, 9, 3) or (N, 16, 3).
struct Columns {
  Dense<double> means;
  Dense<> quats, scales, opacities, sh;
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

std::shared_ptr<Model> model_of(const Dense<double>& means, const Dense<>& quats, const Dense<>& scales,
                                const Dense<>& opacities, const Dense<>& sh, const std::string& name,
                                const std::string& axes, bool antialiased) {
  const Columns columns{means, quats, scales, opacities, sh};
  auto model = std::make_shared<Model>();
  model->name = name;
  model->format = "arrays";
  while (sh_count(model->degree) < sh.shape(1)) ++model->degree;
  model->antialiased = antialiased;
  world_from_axes(axes);
  model->axes.letters = axes;
  if (means.shape(0) == 0) fail("means: no Gaussians: expected one row or more");
  model->resize(static_cast<std::size_t>(means.shape(0)));
  const Unlocked unlocked;
  fill_rows(*model, columns);
  if (choose_origin(*model)) fill_rows(*model, columns);
  return model;
}

/// A copy of so many rows.
template <typename Row>
py::array array_of_rows(const std::vector<Row>& rows) {
  using Value = typename Row::value_type;
  return Dense<Value>({static_cast<py::ssize_t>(rows.size()), static_cast<py::ssize_t>(Row::length())},
                      reinterpret_cast<const Value*>(rows.data()));
}

/// From zero, which far away takes doubles.
py::array means_of(const Model& model) {
  if (model.axes.origin == glm::dvec3(0.0)) return array_of_rows(model.position);
  std::vector<glm::dvec3> means;
  for (const glm::vec3& p : model.position) means.push_back(model.axes.origin + glm::dvec3(p));
  return array_of_rows(means);
}

/// A copy of one of the five arrays.
py::array column_of(const Model& model, const std::string& name) {
  if (model.scaffold) fail("{}: a Scaffold-GS model makes its Gaussians for each eye", name);
  if (name == "means") return means_of(model);
  if (name == "quats") return array_of_rows(model.rotation);
  if (name == "scales") return array_of_rows(model.scale);
  const auto count = static_cast<py::ssize_t>(model.count());
  if (name == "opacities") return Dense<>(count, model.opacity.data());
  return Dense<>({count, static_cast<py::ssize_t>(sh_count(model.degree)), py::ssize_t{3}}, model.sh.data());
}

py::dict facts_of(const Model& m) {
  using namespace py::literals;
  return py::dict("name"_a = m.name, "format"_a = m.format, "count"_a = m.count(), "degree"_a = m.degree,
                  "left_out"_a = m.left_out, "axes"_a = m.axes.letters, "antialiased"_a = m.antialiased,
                  "antialiased_by"_a = m.antialiased_by, "order"_a = order_choices[m.perspective.order].name,
                  "projection"_a = projection_choices[m.perspective.projection].name);
}

}  // namespace

void add_models(py::module_& module) {
  py::class_<Model, std::shared_ptr<Model>>(module, "Model")
      .def(py::init(&model_of))
      .def("facts", &facts_of)
      .def_property_readonly("near", [](const Model& model) { return near_for(model); })
      .def("column", &column_of);
  module.def("load_model", &model_at, py::arg("path"), py::arg("lod"), py::arg("appearance"), py::arg("axes"),
             py::arg("antialiased"));
}

}  // namespace binosplat::python
