// Models: from files, and what they are.

#include <memory>

#include "formats/model_file.h"
#include "python/help.h"
#include "python/module.h"
#include "python/unlocked.h"
#include "scene/axes.h"
#include "scene/framing.h"
#include "scene/model.h"

namespace binosplat::python {

namespace {

std::shared_ptr<Model> load(const std::filesystem::path& path, const std::optional<int>& lod,
                            const std::optional<std::size_t>& appearance,
                            const std::optional<std::string>& axes, const std::optional<bool>& antialiased) {
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

}  // namespace

void add_models(py::module_& module) {
  py::class_<Model, std::shared_ptr<Model>> model(module, "Model", help::model);
  add_model_arrays(model);
  model.def_readonly("name", &Model::name)
      .def_readonly("format", &Model::format, "Of its file, in words.")
      .def_property_readonly("count", &Model::count, "Gaussians; anchors of Scaffold-GS.")
      .def_readonly("degree", &Model::degree, "Of the spherical harmonics, 0 to 3.")
      .def_readonly("left_out", &Model::left_out, "Gaussians of the file that are not finite.")
      .def_property_readonly(
          "axes", [](const Model& m) { return m.axes.letters; },
          "Where its x, y and z point: R or L, U or D, F or B.")
      .def_readonly("antialiased", &Model::antialiased, "Whether it was trained with anti-aliasing.")
      .def_readonly("antialiased_by", &Model::antialiased_by,
                    "What says so: a comment of its file, a file of the training's run; empty: nothing does.")
      .def_property_readonly(
          "order", [](const Model& m) { return order_choices[m.perspective.order].name; },
          "What it was trained to be sorted by, and is unless draw() is told otherwise.")
      .def_property_readonly(
          "projection", [](const Model& m) { return projection_choices[m.perspective.projection].name; },
          "Likewise, what a ray sees of a Gaussian.")
      .def_property_readonly(
          "near", [](const Model& m) { return near_for(m); },
          "The near plane, in world units, that suits cameras made up for it: 0.2, less where it is tiny.")
      .def("__repr__", [](const Model& m) {
        return fmt::format("<binosplat.Model {}: {} Gaussians, degree {}>", m.name, m.count(), m.degree);
      });
  module.def("load_model", &load, py::arg("path"), py::kw_only(), py::arg("lod") = py::none(),
             py::arg("appearance") = py::none(), py::arg("axes") = py::none(),
             py::arg("antialiased") = py::none(), help::load_model);
}

}  // namespace binosplat::python
