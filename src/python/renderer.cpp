// Frames as arrays.

#include <cmath>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "base/error.h"
#include "python/help.h"
#include "python/module.h"
#include "python/renderer.h"
#include "python/rig.h"
#include "python/unlocked.h"
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
  const Unlocked unlocked;
  return std::make_shared<Renderer>(std::move(model), chosen, device.value_or(-1), kept);
}

void check(const render::FrameSettings& s, bool given, bool scaffold, bool follows) {
  for (int c = 0; c < 3; ++c) {
    if (!(s.background[c] >= 0.0f && s.background[c] <= 1.0f))
      fail("background: expected three numbers from 0 to 1");
  }
  if (!render::is_exact(s.th) && !given)
    fail("th {} needs tolerance or quality: what it may cost", th_choices[s.th].name);
  if (s.transmittance == TRANSMITTANCE_DEPTH)
    fail("transmittance depth: needs a table of the scene, which `binosplat render` measures");
  if (s.decode != DECODE_EYES && !scaffold) {
    fail("decode {}: this is no Scaffold-GS model, whose Gaussians are made for each eye",
         decode_choices[s.decode].name);
  }
  render::check_choice(s);
  if (s.transmittance == TRANSMITTANCE_LAST && !follows)
    fail("transmittance last: needs follow=True; it is the light that the frame before measured");
}

/// The views of a camera or of both eyes in the model's frame.
std::vector<shared::View> views_of(const std::variant<Camera, Rig>& view, const ModelAxes& axes,
                                   double near_plane) {
  if (const auto* camera = std::get_if<Camera>(&view))
    return {make_view(into_axes(*camera, axes), near_plane)};
  const auto pair = std::get<Rig>(view).pair(axes, near_plane);
  return {pair.views[0], pair.views[1]};
}

py::dict dict_of(const render::FrameReport& report) {
  py::dict stages;
  for (const gl::StageTime& stage : report.stages) stages[py::str(stage.name)] = stage.ms;
  using namespace py::literals;
  return py::dict("total_ms"_a = report.total_ms, "stages_ms"_a = stages, "visible"_a = report.visible,
                  "pairs"_a = report.pairs, "tolerance"_a = report.tolerance, "quality"_a = report.quality,
                  "quality_is_estimate"_a = report.quality_is_estimate, "submit_ms"_a = report.cpu.submit,
                  "attempts"_a = report.attempts, "remembered"_a = report.used_measured,
                  "gpu_bytes"_a = report.gpu_bytes);
}

/// What Python sees of a view's picture.
struct DrawnPicture {
  py::array colour, transmittance, depth;
  py::dict report;
};

/// Of draw()'s keywords.
Settings settings_of(const Renderer& renderer, const std::optional<float>& quality,
                     const std::optional<float>& tolerance, const std::optional<std::string>& th,
                     const std::string& transmittance, const std::optional<std::string>& order,
                     const std::optional<std::string>& projection, const std::string& tiles,
                     const std::string& decode, const std::array<float, 3>& background, double near_plane,
                     const std::string& depth, bool follow) {
  if (!(near_plane > 0.0 && std::isfinite(near_plane)))
    fail("near {}: expected world units above zero", near_plane);
  if (quality && !(*quality >= render::quality_least && *quality <= render::quality_most))
    fail("quality {}: expected decibels from {} to {}", *quality, render::quality_least,
         render::quality_most);
  const bool given = quality || tolerance;
  render::FrameSettings settings;
  settings.quality = quality.value_or(0.0f);
  settings.tolerance = tolerance.value_or(0.0f);
  settings.th = choice("th", th, th_choices).value_or(given ? TH_SQUARED : TH_TAU);
  settings.transmittance = find_choice("transmittance", transmittance, transmittance_choices);
  settings.order = choice("order", order, order_choices);
  settings.projection = choice("projection", projection, projection_choices);
  settings.tiles = find_choice("tiles", tiles, tiles_choices);
  settings.decode = find_choice("decode", decode, decode_choices);
  settings.background = {background[0], background[1], background[2]};
  settings.precision = renderer.precision();
  check(settings, given, renderer.model().scaffold != nullptr, follow);
  static constexpr Choice depths[] = {{"mean", ""}, {"median", ""}};
  settings.depth = find_choice("depth", depth, depths) == 0 ? Depth::mean : Depth::median;
  return {settings, near_plane, follow};
}

/// A view's picture, or those of both eyes.
py::object pictures_of(Drawn drawn) {
  const py::dict report = dict_of(drawn.report);
  py::list pictures;
  for (ViewImages& images : drawn.views) {
    pictures.append(DrawnPicture{array_of(std::move(images.colour)),
                                 array_of(std::move(images.transmittance)), array_of(std::move(images.depth)),
                                 report});
  }
  return pictures.size() == 1 ? py::object(pictures[0]) : py::object(py::tuple(pictures));
}

using SeenBy = std::variant<Camera, Rig>;

// A Renderer that is held here outlives what Python does to its own while it ends.
py::object draw(const std::shared_ptr<Renderer>& renderer, const SeenBy& view, const Settings& settings) {
  const Views views = views_of(view, renderer->model().axes, settings.near_plane);
  return pictures_of(awaited(renderer->draw(views, settings)));
}

/// Python's iterator of draw_all().
class PathPictures {
 public:
  PathPictures(std::shared_ptr<Renderer> renderer, const py::iterable& views, const Settings& settings)
      : renderer_(std::move(renderer)), views_(py::iter(views)), settings_(settings) {}
  ~PathPictures() { end(); }
  PathPictures(const PathPictures&) = delete;
  PathPictures& operator=(const PathPictures&) = delete;

  py::object next() {
    const std::optional<Views> first = std::exchange(has_begun_, true) ? std::nullopt : next_views();
    if (first) awaited(renderer_->begin(path_, *first, settings_));
    // After an error or a Ctrl-C the path is at its end.
    if (const bool goes_on = std::exchange(is_under_way_, false); !goes_on && !first) {
      end();
      throw py::stop_iteration();
    }
    const std::optional<Views> following = next_views();
    Drawn drawn = awaited(renderer_->next(path_, following, settings_));
    is_under_way_ = following.has_value();
    return pictures_of(std::move(drawn));
  }

 private:
  std::optional<Views> next_views() {
    if (views_ == py::iterator::sentinel()) return std::nullopt;
    if (!py::isinstance<Camera>(*views_) && !py::isinstance<Rig>(*views_))
      throw py::type_error(
          fmt::format("expected a Camera or a Rig, not {}", Py_TYPE((*views_).ptr())->tp_name));
    const auto view = py::cast<SeenBy>(*views_);
    ++views_;
    return views_of(view, renderer_->model().axes, settings_.near_plane);
  }

  void end() {
    if (GlThread::in_its_process() && has_begun_) renderer_->end(path_);
  }

  std::shared_ptr<Renderer> renderer_;
  py::iterator views_;
  Settings settings_;
  std::uint64_t path_ = Renderer::new_path();
  bool has_begun_ = false, is_under_way_ = false;
};

void close(const std::shared_ptr<Renderer>& renderer) {
  const Unlocked unlocked;
  renderer->close();
}

using RendererClass = py::class_<Renderer, std::shared_ptr<Renderer>>;

/// Defines a method of these keywords.
template <typename View, typename Draw>
void add_drawing(RendererClass& renderer, const char* name, const char* view, const Draw& draw,
                 const char* help) {
  renderer.def(
      name,
      [draw](const std::shared_ptr<Renderer>& of, const View& seen, const std::optional<float>& quality,
             const std::optional<float>& tolerance, const std::optional<std::string>& th,
             const std::string& transmittance, const std::optional<std::string>& order,
             const std::optional<std::string>& projection, const std::string& tiles,
             const std::string& decode, const std::array<float, 3>& background, double near_plane,
             const std::string& depth, bool follow) {
        return draw(of, seen,
                    settings_of(*of, quality, tolerance, th, transmittance, order, projection, tiles, decode,
                                background, near_plane, depth, follow));
      },
      py::arg(view), py::kw_only(), py::arg("quality") = py::none(), py::arg("tolerance") = py::none(),
      py::arg("th") = py::none(), py::arg("transmittance") = "one", py::arg("order") = py::none(),
      py::arg("projection") = py::none(), py::arg("tiles") = "ellipse", py::arg("decode") = "eyes",
      py::arg("background") = std::array<float, 3>{}, py::arg("near") = near_default,
      py::arg("depth") = "mean", py::arg("follow") = false, help);
}

}  // namespace

void add_renderer(py::module_& module) {
  py::class_<DrawnPicture>(module, "Picture", "What draw() makes of a view; rows from the top.")
      .def_readonly("colour", &DrawnPicture::colour,
                    "(height, width, 3) float32, display-referred RGB over the background, white 1;\n"
                    "what Gaussians overshoot is not clamped.")
      .def_readonly("transmittance", &DrawnPicture::transmittance,
                    "(height, width) float32: the share of the background's light that is left, 1 - alpha.")
      .def_readonly(
          "depth", &DrawnPicture::depth,
          "(height, width) float32: depth along the view's axis, world units, by draw(depth=); inf where\n"
          "alpha is at most 0.5.")
      .def_readonly(
          "report", &DrawnPicture::report,
          "Of the frame, a dict: total_ms and stages_ms (GPU times), submit_ms (CPU time of handing it to\n"
          "the driver), visible, pairs, tolerance and quality (dB) that it came to, attempts, remembered\n"
          "(whether it used what the frame before measured), gpu_bytes.");
  py::class_<PathPictures>(module, "PathPictures", "What draw_all() returns: an iterator.")
      .def("__iter__", [](PathPictures& pictures) -> PathPictures& { return pictures; })
      .def("__next__", &PathPictures::next);
  RendererClass renderer(module, "Renderer", help::renderer);
  renderer
      .def(py::init(&open), py::arg("model").none(false), py::kw_only(), py::arg("backend") = "auto",
           py::arg("device") = py::none(), py::arg("precision") = "full")
      .def_property_readonly("device", &Renderer::device, "What it draws with.")
      .def("close", &close,
           "Gives the GPU's memory back; it is also given back with the last reference, and by `with`.")
      .def("__enter__", [](Renderer& self) -> Renderer& { return self; })
      .def("__exit__", [](const std::shared_ptr<Renderer>& self, const py::args&) { close(self); });
  add_drawing<SeenBy>(renderer, "draw", "view", &draw, help::draw);
  add_drawing<py::iterable>(
      renderer, "draw_all", "views",
      [](const std::shared_ptr<Renderer>& of, const py::iterable& views, const Settings& settings) {
        return std::make_unique<PathPictures>(of, views, settings);
      },
      help::draw_all);
}

}  // namespace binosplat::python
