// Frames as arrays.

#include <cmath>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "base/error.h"
#include "python/gl_thread.h"
#include "python/module.h"
#include "python/rig.h"
#include "python/unlocked.h"
#include "render/frame.h"
#include "scene/axes.h"

namespace binosplat::python {

namespace {

/// What draw() leaves of a view.
struct ViewImages {
  Image colour, transmittance, depth;
};

struct Drawn {
  std::vector<ViewImages> views;
  render::FrameReport report;
};

ViewImages images_of(const Picture& picture, const glm::vec3& background) {
  ViewImages images = {composite(picture, background), Image(picture.width, picture.height, 1),
                       depth_map(picture)};
  for (std::size_t k = 0; k < picture.colour.size(); ++k) images.transmittance.data[k] = picture.colour[k].a;
  return images;
}

class Renderer {
 public:
  Renderer(std::shared_ptr<Model> model, gl::Backend backend, int device, int precision)
      : model_(std::move(model)), precision_(precision), thread_(std::make_unique<GlThread>()) {
    thread_->run([&] { on_gpu_ = std::make_unique<OnGpu>(backend, device, *model_, precision_); });
    const gl::Context& context = *on_gpu_->context;
    device_ = fmt::format("{} ({}, OpenGL {})", context.renderer(), context.backend(), context.version());
  }
  ~Renderer() {
    if (GlThread::in_its_process()) {
      close();
    } else {  // neither has survived the fork
      static_cast<void>(thread_.release());
      static_cast<void>(on_gpu_.release());
    }
  }
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  void close() {
    thread_->run([this] { on_gpu_.reset(); });
  }

  Drawn draw(const std::vector<shared::View>& views, render::FrameSettings settings, bool follow) {
    settings.precision = precision_;
    return thread_->run([&] {
      if (!on_gpu_) fail("this Renderer is closed");
      render::Frame& frame = on_gpu_->frame;
      if (!follow) frame.start_over();
      Drawn drawn;
      drawn.report = frame.draw(views, settings);
      for (const Picture& picture : frame.read_pictures())
        drawn.views.push_back(images_of(picture, settings.background));
      return drawn;
    });
  }

  const Model& model() const { return *model_; }
  const std::string& device() const { return device_; }

 private:
  struct OnGpu {
    OnGpu(gl::Backend backend, int number, const Model& model, int precision)
        : context(gl::Context::open(backend, number)), frame(*context, model, precision) {}
    std::unique_ptr<gl::Context> context;
    render::Frame frame;
  };

  std::shared_ptr<const Model> model_;
  int precision_;
  std::string device_;
  std::unique_ptr<GlThread> thread_;
  std::unique_ptr<OnGpu> on_gpu_;  // made, used and destroyed on the thread
};

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

void check(const render::FrameSettings& s, bool given, bool scaffold) {
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
}

/// The views of a camera or of both eyes in the model's frame.
std::vector<shared::View> views_of(const std::variant<Camera, Rig>& view, const std::string& axes,
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
                  "attempts"_a = report.attempts, "remembered"_a = report.used_measured,
                  "gpu_bytes"_a = report.gpu_bytes);
}

/// What Python sees of a view's picture.
struct DrawnPicture {
  py::array colour, transmittance, depth;
  py::dict report;
};

// A Renderer that is held here outlives what Python does to its own while it ends.
py::object draw(const std::shared_ptr<Renderer>& renderer, const std::variant<Camera, Rig>& view,
                const std::optional<float>& quality, const std::optional<float>& tolerance,
                const std::optional<std::string>& th, const std::string& transmittance,
                const std::optional<std::string>& order, const std::optional<std::string>& projection,
                const std::string& tiles, const std::string& decode, const std::array<float, 3>& background,
                double near_plane, const std::string& depth, bool follow) {
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
  check(settings, given, renderer->model().scaffold != nullptr);
  static constexpr Choice depths[] = {{"mean", ""}, {"median", ""}};
  settings.depth = find_choice("depth", depth, depths) == 0 ? Depth::mean : Depth::median;
  const auto views = views_of(view, renderer->model().axes, near_plane);
  Drawn drawn;
  {
    const Unlocked unlocked;
    drawn = renderer->draw(views, settings, follow);
  }
  const py::dict report = dict_of(drawn.report);
  py::list pictures;
  for (ViewImages& images : drawn.views) {
    pictures.append(DrawnPicture{array_of(std::move(images.colour)),
                                 array_of(std::move(images.transmittance)), array_of(std::move(images.depth)),
                                 report});
  }
  return views.size() == 1 ? py::object(pictures[0]) : py::object(py::tuple(pictures));
}

void close(const std::shared_ptr<Renderer>& renderer) {
  const Unlocked unlocked;
  renderer->close();
}

constexpr const char* draw_help =
    "Draws a Camera, which returns its Picture, or a Rig: the pictures of the left and the right eye.\n\n"
    "Without settings a picture is exact. quality: dB of PSNR that it should have against the exact\n"
    "one. Or tolerance: what leaving a Gaussian out of a tile may cost, in the unit of th: 'squared'\n"
    "(where one of the two is given) or 'peripheral'; 'tau' is exact. transmittance: the light that a\n"
    "Gaussian is taken to get, 'one' or, with follow, 'last'. order: 'depth' or 'distance', projection:\n"
    "'affine' or 'tangent' (None: as the model was trained). tiles: 'ellipse', 'snug', 'all' (exact),\n"
    "'aabb' or 'obb'. decode: of Scaffold-GS, 'eyes' or, with a Rig, 'cyclopean'. background: RGB behind\n"
    "the scene. near: nothing nearer is drawn, world units. depth: 'mean' of what is seen, or 'median',\n"
    "by which half of it is. follow: this is the next frame of a path, which goes by what the one\n"
    "before measured; else the picture depends on nothing drawn before.\n\n"
    "May be called from any thread; pictures of one Renderer are drawn one after the other.\n"
    "Raises InputError for settings that contradict each other, OutOfMemory.";

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
          "Of the frame, a dict: total_ms and stages_ms (GPU times), visible, pairs, tolerance and\n"
          "quality (dB) that it came to, attempts, remembered, gpu_bytes.");
  py::class_<Renderer, std::shared_ptr<Renderer>>(
      module, "Renderer",
      "A model on a GPU, or in Mesa's software renderer.\n\n"
      "backend: 'auto' (a GPU, else Mesa), 'device', 'surfaceless' or 'osmesa'. device:\n"
      "number of the EGL device. precision: 'full', or 'half' for half the memory at 60 dB\n"
      "and more. Raises OpenGLError, OutOfMemory, InputError.")
      .def(py::init(&open), py::arg("model").none(false), py::kw_only(), py::arg("backend") = "auto",
           py::arg("device") = py::none(), py::arg("precision") = "full")
      .def("draw", &draw, py::arg("view"), py::kw_only(), py::arg("quality") = py::none(),
           py::arg("tolerance") = py::none(), py::arg("th") = py::none(), py::arg("transmittance") = "one",
           py::arg("order") = py::none(), py::arg("projection") = py::none(), py::arg("tiles") = "ellipse",
           py::arg("decode") = "eyes", py::arg("background") = std::array<float, 3>{},
           py::arg("near") = near_default, py::arg("depth") = "mean", py::arg("follow") = false, draw_help)
      .def_property_readonly("device", &Renderer::device, "What it draws with.")
      .def("close", &close,
           "Gives the GPU's memory back; it is also given back with the last reference, and by `with`.")
      .def("__enter__", [](Renderer& renderer) -> Renderer& { return renderer; })
      .def("__exit__", [](const std::shared_ptr<Renderer>& renderer, const py::args&) { close(renderer); });
}

}  // namespace binosplat::python
