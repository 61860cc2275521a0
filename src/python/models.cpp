// Models: from files and arrays, and their properties.

#include <memory>
#include <vector>

#include "base/choices.h"
#include "base/error.h"
#include "base/log.h"
#include "formats/models/model_file.h"
#include "formats/models/model_output.h"
#include "python/module.h"
#include "python/released_gil.h"
#include "scene/axes.h"
#include "scene/framing.h"
#include "scene/model.h"
#include "scene/model_rows.h"

namespace binosplat::python {

namespace {

std::shared_ptr<Model> model_at(const std::filesystem::path& path, const std::optional<int>& lod,
                                const std::optional<std::size_t>& appearance,
                                const std::optional<std::string>& axes,
                                const std::optional<bool>& antialiased, const std::string& format) {
  if (axes) world_from_axes(*axes);
  const ReleasedGil released;
  auto model = std::make_shared<Model>(load_model(path, {lod, appearance, format}));
  model->axes.letters = axes.value_or(model->axes.letters);
  if (antialiased) {
    model->antialiased = *antialiased;
    model->antialiased_by = "antialiased=";
  }
  return model;
}

/// Makes a model from arrays with equal numbers of rows; sh is (N, 1, 3), (N, 4, 3), (N, 9, 3) or (N, 16, 3).
std::shared_ptr<Model> model_of(const Dense<double>& means, const Dense<>& quats, const Dense<>& scales,
                                const Dense<>& opacities, const Dense<>& sh, const std::string& name,
                                const std::string& axes, bool antialiased) {
  int degree = 0;
  while (sh_count(degree) < sh.shape(1)) ++degree;
  const auto coefficients = 3 * static_cast<std::size_t>(sh_count(degree));
  const auto row = [&](std::size_t i) {
    const double* p = means.data() + 3 * i;
    const float *q = quats.data() + 4 * i, *s = scales.data() + 3 * i;
    return GaussianValues{{p[0], p[1], p[2]},
                          {s[0], s[1], s[2]},
                          {q[0], q[1], q[2], q[3]},
                          opacities.data()[i],
                          sh.data() + coefficients * i};
  };
  const auto count = static_cast<std::size_t>(means.shape(0));
  const ReleasedGil released;
  auto model = std::make_shared<Model>(model_of_rows(count, degree, axes, row));
  model->name = name;
  model->antialiased = antialiased;
  return model;
}

std::shared_ptr<Model> filtered(const Model& model, const Dense<bool>& mask) {
  if (model.scaffold) fail("filtered: a Scaffold-GS model decodes Gaussians for each eye");
  const std::vector<std::uint8_t> kept(mask.data(), mask.data() + mask.size());
  const ReleasedGil released;
  auto some = std::make_shared<Model>(model);
  keep_only(*some, kept);
  some->left_out = model.left_out;  // counts invalid Gaussians
  return some;
}

void save(const Model& model, const std::filesystem::path& path) {
  const auto format = model_format_of(path);
  if (!format)
    fail("{}: its ending names no format that can be written: {}", path.string(), written_endings());
  const ReleasedGil released;
  Model turned = model;
  if (!model.scaffold) bring_into_axes(turned, std::string(row_of(*format).axes));
  for (const std::string& loss : write_model_file(path, turned, *format))
    log_warning("{}: {}", path.string(), loss);
}

template <typename Row>
py::array array_of_rows(const std::vector<Row>& rows) {
  using Value = typename Row::value_type;
  return copied({static_cast<py::ssize_t>(rows.size()), static_cast<py::ssize_t>(Row::length())},
                reinterpret_cast<const Value*>(rows.data()));
}

/// Positions relative to the world's zero instead of the model's origin. Models far from zero need doubles.
py::array means_of(const Model& model) {
  if (model.axes.origin == glm::dvec3(0.0)) return array_of_rows(model.position);
  std::vector<glm::dvec3> means;
  for (const glm::vec3& p : model.position) means.push_back(model.axes.origin + glm::dvec3(p));
  return array_of_rows(means);
}

py::array column_of(const Model& model, const std::string& name) {
  if (model.scaffold) fail("{}: a Scaffold-GS model decodes Gaussians for each eye", name);
  if (name == "means") return means_of(model);
  if (name == "quats") return array_of_rows(model.rotation);
  if (name == "scales") return array_of_rows(model.scale);
  const auto count = static_cast<py::ssize_t>(model.count());
  if (name == "opacities") return copied({count}, model.opacity.data());
  return copied({count, sh_count(model.degree), 3}, model.sh.data());
}

py::dict facts_of(const Model& m) {
  using namespace py::literals;
  return py::dict("name"_a = text_of(m.name), "format"_a = m.format, "count"_a = m.count(),
                  "degree"_a = m.degree, "left_out"_a = m.left_out, "axes"_a = m.axes.letters,
                  "antialiased"_a = m.antialiased, "antialiased_by"_a = m.antialiased_by,
                  "order"_a = name_of(m.perspective.order),
                  "projection"_a = name_of(m.perspective.projection));
}

}  // namespace

void add_models(py::module_& module) {
  py::class_<Model, std::shared_ptr<Model>>(module, "Model")
      .def(py::init(&model_of))
      .def("facts", &facts_of)
      .def_property_readonly("near_plane", [](const Model& model) { return near_plane_for(model); })
      .def("column", &column_of)
      .def("filtered", &filtered)
      .def("save", &save);
  module.def("load_model", &model_at, py::arg("path"), py::arg("lod"), py::arg("appearance"), py::arg("axes"),
             py::arg("antialiased"), py::arg("format"));
}

}  // namespace binosplat::python
