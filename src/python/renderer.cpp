// Draws frames into arrays.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/gtc/type_ptr.hpp>
#include <iterator>
#include <memory>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "adagscale/calibration_file.h"
#include "base/choices.h"
#include "base/error.h"
#include "python/module.h"
#include "python/released_gil.h"
#include "python/renderer.h"
#include "scene/axes.h"

namespace binosplat::python {

namespace {

std::shared_ptr<Renderer> open(std::shared_ptr<Model> model, const std::string& backend,
                               const std::optional<int>& device, const std::string& precision) {
  static constexpr Choice backends[] = {{"auto", ""}, {"device", ""}, {"surfaceless", ""}, {"osmesa", ""}};
  const auto chosen = static_cast<gl::Backend>(find_choice("backend", backend, backends));
  if (device && (chosen == gl::Backend::surfaceless || chosen == gl::Backend::osmesa))
    fail("device {}: backend {} has none", *device, backend);
  if (device && *device < 0) fail("device {}: devices are numbered from 0", *device);
  const int kept = find_choice("precision", precision, precision_choices);
  const ReleasedGil released;
  const auto leak_in_use = [](Renderer* renderer) {
    if (!renderer->is_in_use()) delete renderer;
  };
  return {new Renderer(std::move(model), chosen, device.value_or(-1), kept), leak_in_use};
}

/// The views of a camera, or of both eyes, in the model's frame of reference.
std::vector<shared::View> views_of(const std::variant<Camera, Rig>& view, const ModelAxes& axes,
                                   double near_plane) {
  if (const auto* camera = std::get_if<Camera>(&view))
    return {make_view(into_axes(*camera, axes), near_plane)};
  const auto pair = std::get<Rig>(view).pair(axes, near_plane);
  return {pair.views[0], pair.views[1]};
}

py::dict dict_of(const Report& report) {
  py::dict stages;
  for (const StageTime& stage : report.stages) stages[py::str(stage.name)] = stage.ms;
  using namespace py::literals;
  return py::dict("stages"_a = stages, "gpu_ms"_a = report.gpu_ms, "submit_ms"_a = report.submit_ms,
                  "gpu_bytes"_a = report.gpu_bytes, "visible"_a = report.visible, "pairs"_a = report.pairs,
                  "threshold"_a = name_of(report.threshold), "tolerance"_a = report.tolerance,
                  "quality"_a = render::measured_quality(report),
                  "exact_because"_a = report.exact == ExactReason::not_exact
                                          ? std::nullopt
                                          : std::optional(name_of(report.exact)),
                  "redraws"_a = report.redraws, "used_last"_a = report.used_last);
}

/// The value of a keyword of draw(); none if it is None or not given.
template <typename Value>
std::optional<Value> value_of(const py::dict& keywords, const char* name) {
  const py::object value = keywords.attr("get")(name);
  try {
    return value.cast<std::optional<Value>>();
  } catch (const py::cast_error&) {
    throw py::type_error(fmt::format("{}: {} has a wrong type", name, py::repr(value).cast<std::string>()));
  }
}

template <typename Value>
std::optional<Value> choice_of(const py::dict& keywords, const char* name, std::span<const Choice> choices) {
  const auto word = value_of<std::string>(keywords, name);
  return word ? std::optional(find_choice<Value>(name, *word, choices)) : std::nullopt;
}

/// Converts the keywords of draw().
Settings settings_of(const Renderer& renderer, const py::dict& keywords) {
  static constexpr Choice depths[] = {{"mean", ""}, {"median", ""}};
  Settings settings;
  settings.calibrated = value_of<adagscale::CalibratedThreshold>(keywords, "calibration")
                            .value_or(adagscale::CalibratedThreshold());
  settings.follow = value_of<bool>(keywords, "follow").value_or(false);
  render::FrameSettings& s = settings.frame;
  if (const auto rgb = value_of<std::array<float, 3>>(keywords, "background"))
    s.background = glm::vec3((*rgb)[0], (*rgb)[1], (*rgb)[2]);
  s.quality = value_of<float>(keywords, "quality");
  s.tolerance = value_of<float>(keywords, "tolerance");
  s.threshold = choice_of<Threshold>(keywords, "threshold", threshold_choices);
  s.transmittance = choice_of<Transmittance>(keywords, "transmittance", transmittance_choices);
  s.order = choice_of<Order>(keywords, "order", order_choices);
  s.projection = choice_of<Projection>(keywords, "projection", projection_choices);
  s.depth = choice_of<DepthKind>(keywords, "depth", depths).value_or(s.depth);
  s.tiles = choice_of<int>(keywords, "tiles", tiles_choices).value_or(s.tiles);
  s.precision = renderer.precision();
  const bool calibrated = settings.calibrated.is_calibrated();
  const double trained = renderer.model().near_plane.value_or(near_default);
  s.near_plane = value_of<double>(keywords, "near_plane")
                     .value_or(calibrated ? settings.calibrated.calibration().near_plane : trained);
  render::check(s, "", calibrated || adagscale::lacks_k(s));
  if (calibrated && s.threshold != Threshold::exact) {
    s = settings.calibrated.with_rule(s);
    settings.calibrated.check_drawing(s, renderer.model(), *s.near_plane);
  }
  if (s.transmittance == Transmittance::last && !settings.follow)
    fail("transmittance last needs follow=True: the previous frame measures it");
  return settings;
}

/// The three arrays of each view, and the report of the frame.
py::tuple arrays_of(Drawn drawn) {
  py::list arrays;
  for (ViewImages& images : drawn.views) {
    arrays.append(py::make_tuple(array_of(std::move(images.colour)),
                                 array_of(std::move(images.transmittance)),
                                 array_of(std::move(images.depth))));
  }
  return py::make_tuple(arrays, dict_of(drawn.report));
}

using SeenBy = std::variant<Camera, Rig>;

// The shared pointer keeps the Renderer alive during Python's shutdown.
py::tuple draw(const std::shared_ptr<Renderer>& renderer, const SeenBy& view, const Settings& settings) {
  const Views views = views_of(view, renderer->model().axes, *settings.frame.near_plane);
  return arrays_of(awaited(renderer->draw(views, settings)));
}

/// By view and Gaussian; zeros if the Gaussian is in no tile's list.
py::array measure(const std::shared_ptr<Renderer>& renderer, const std::vector<SeenBy>& seen,
                  const Settings& settings) {
  const Model& model = renderer->model();
  if (model.scaffold) fail("measure: a Scaffold-GS model decodes Gaussians for each eye");
  if (settings.frame.quality || settings.follow) fail("measure: expected no quality and no follow");
  Views views;
  for (const SeenBy& one : seen)
    std::ranges::copy(views_of(one, model.axes, *settings.frame.near_plane), std::back_inserter(views));
  const auto found = awaited(renderer->measure(views, settings));
  Dense<render::GaussianInView> array({views.size(), model.count()});
  std::fill_n(array.mutable_data(), array.size(), render::GaussianInView());
  for (std::size_t v = 0; v < found.size(); ++v) {
    for (const render::GaussianInView& one : found[v]) array.mutable_at(v, one.index) = one;
  }
  return array;
}

py::list debug_view(const std::shared_ptr<Renderer>& renderer, const SeenBy& view, const std::string& show,
                    const Settings& settings) {
  const auto maps = std::span(show_choices).subspan(SHOW_DIFFERENCE);
  const int what = SHOW_DIFFERENCE + find_choice<int>("show", show, maps);
  const Views views = views_of(view, renderer->model().axes, *settings.frame.near_plane);
  py::list arrays;
  for (Image& map : awaited(renderer->debug_view(what, views, settings))) {
    for (float& number : map.data) number = number < 0.0f ? NAN : number;
    arrays.append(array_of(std::move(map)));
  }
  return arrays;
}

class Frames {
 public:
  Frames(std::shared_ptr<Renderer> renderer, const Settings& settings)
      : renderer_(std::move(renderer)), settings_(settings) {}
  ~Frames() {
    if (GlThread::in_its_process() && has_begun_) renderer_->end(path_);
  }
  Frames(const Frames&) = delete;
  Frames& operator=(const Frames&) = delete;

  void begin(const SeenBy& first) {
    has_begun_ = true;
    awaited(renderer_->begin(path_, views(first), settings_));
  }

  py::tuple next(const std::optional<SeenBy>& following) {
    const std::optional<Views> more = following ? std::optional(views(*following)) : std::nullopt;
    return arrays_of(awaited(renderer_->next(path_, more, settings_)));
  }

 private:
  Views views(const SeenBy& view) const {
    return views_of(view, renderer_->model().axes, *settings_.frame.near_plane);
  }

  std::shared_ptr<Renderer> renderer_;
  Settings settings_;
  std::uint64_t path_ = Renderer::new_path();
  bool has_begun_ = false;
};

/// One tuple per instance: its model, its matrix row by row, and its opacity.
using Instances = std::vector<std::tuple<std::shared_ptr<Model>, std::array<double, 16>, float>>;

void place(const std::shared_ptr<Renderer>& renderer, const Instances& instances) {
  std::vector<Placed> placed;
  for (std::size_t k = 0; k < instances.size(); ++k) {
    const auto& [model, numbers, opacity] = instances[k];
    auto place = render::place_of(glm::transpose(glm::make_mat4(numbers.data())));
    if (!place)
      fail(
          "instances[{}]: its matrix is not a rotation, a scale above 0 and a translation, with 0 0 0 1 "
          "below",
          k);
    if (!(opacity >= 0.0f && opacity <= 1.0f)) fail("instances[{}]: opacity {}: expected 0 to 1", k, opacity);
    place->opacity = opacity;
    placed.push_back({model, *place});
  }
  awaited(renderer->place(std::move(placed)));
}

void close(const std::shared_ptr<Renderer>& renderer) {
  const ReleasedGil released;
  renderer->close();
}

}  // namespace

void add_renderer(py::module_& module) {
  PYBIND11_NUMPY_DTYPE(render::GaussianInView, radius, tiles, transmittance, contribution);
  const py::class_<Settings> settings(module, "Settings");
  py::class_<adagscale::CalibratedThreshold>(module, "Calibration")
      .def(py::init([](const std::filesystem::path& path, const std::shared_ptr<Model>& model) {
        const ReleasedGil released;
        adagscale::CalibratedThreshold calibrated(path.string(), adagscale::load_calibration(path));
        calibrated.check_model(*model);
        return calibrated;
      }))
      .def(
          "check_model",
          [](const adagscale::CalibratedThreshold& calibrated, const std::shared_ptr<Model>& model) {
            calibrated.check_model(*model);
          },
          py::call_guard<ReleasedGil>());
  py::class_<Renderer, std::shared_ptr<Renderer>>(module, "Renderer")
      .def(py::init(&open), py::arg("model"), py::arg("backend"), py::arg("device"), py::arg("precision"))
      .def_property_readonly("device", &Renderer::device)
      .def("settings", &settings_of, py::arg("keywords"))
      .def("draw", &draw, py::arg("view"), py::arg("settings"))
      .def("measure", &measure, py::arg("views"), py::arg("settings"))
      .def("debug_view", &debug_view, py::arg("view"), py::arg("show"), py::arg("settings"))
      .def("place", &place, py::arg("instances"))
      .def("close", &close);
  py::class_<Frames>(module, "Path")
      .def(py::init<std::shared_ptr<Renderer>, const Settings&>())
      .def("begin", &Frames::begin)
      .def("next", &Frames::next);
}

}  // namespace binosplat::python
