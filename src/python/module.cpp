// import binosplat: models, cameras and frames, with pictures as NumPy arrays.

#include "python/module.h"

#include <array>
#include <new>
#include <string_view>

#include "base/error.h"
#include "python/unlocked.h"

namespace binosplat::python {

namespace {

// The exceptions' types, by ExitCode; the base for those that have none of their own. Never freed, as types
// of a module.
std::array<PyObject*, 5> error_types{};

constexpr const char* not_made = "this object was made by __new__ alone: call its class, or what returns one";

PyObject* add_error(py::module_& module, const char* name, const char* help, const py::tuple& bases) {
  const std::string full = std::string("binosplat.") + name;
  PyObject* const type = PyErr_NewExceptionWithDoc(full.c_str(), help, bases.ptr(), nullptr);
  if (type == nullptr) throw py::error_already_set();
  module.add_object(name, py::reinterpret_borrow<py::object>(type));
  return type;
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(std::move(thrown));
  } catch (const Error& error) {
    // Texts quote names of files, which need not be UTF-8.
    const std::string_view text = error.what();
    const auto words = py::reinterpret_steal<py::object>(
        PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "replace"));
    PyErr_SetObject(error_types[static_cast<std::size_t>(error.code())], words.ptr());
  } catch (const std::bad_alloc&) {
    PyErr_SetString(error_types[static_cast<std::size_t>(ExitCode::out_of_memory)], "no memory is left");
  } catch (const py::cast_error& error) {
    if (std::string_view(error.what()).find("non-held") == std::string_view::npos) throw;
    PyErr_SetString(PyExc_TypeError, not_made);
  }
}

/// Objects that only __new__ has seen are refused, where pybind11 would give them memory that nobody has set.
void refuse_unmade(const py::module_& module) {
  for (const auto& [name, thing] : module.attr("__dict__").cast<py::dict>()) {
    if (!PyType_Check(thing.ptr())) continue;
    auto* const type = py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(thing.ptr()));
    if (type != nullptr) type->operator_new = [](std::size_t) -> void* { throw py::type_error(not_made); };
  }
}

}  // namespace

void add_errors(py::module_& module) {
  PyObject* const base = add_error(module, "Error", "What binosplat itself says is wrong.",
                                   py::make_tuple(py::reinterpret_borrow<py::object>(PyExc_Exception)));
  error_types.fill(base);
  const auto add = [&](ExitCode code, const char* name, const char* help, PyObject* python_s) {
    error_types[static_cast<std::size_t>(code)] =
        add_error(module, name, help,
                  py::make_tuple(py::reinterpret_borrow<py::object>(base),
                                 py::reinterpret_borrow<py::object>(python_s)));
  };
  add(ExitCode::bad_input, "InputError", "A file, an array or a setting that cannot be used.",
      PyExc_ValueError);
  add(ExitCode::no_gl, "OpenGLError", "No usable OpenGL, or the GPU was reset.", PyExc_RuntimeError);
  add(ExitCode::out_of_memory, "OutOfMemory", "No room on the GPU, or for a picture.", PyExc_MemoryError);
  py::register_exception_translator(translate);
}

void refuse_masked(const py::object& array, const std::string& name) {
  if (py::module_::import("numpy.ma").attr("is_masked")(array).cast<bool>())
    fail(
        "{}: a masked array, and a mask has no place here: leave the masked rows out, or fill them "
        "(filled())",
        name);
}

}  // namespace binosplat::python

PYBIND11_MODULE(_binosplat, module) {
  using namespace binosplat::python;
  module.attr("__name__") = "binosplat";  // the package, which its types are part of for whoever looks
  module.doc() =
      "3D Gaussian Splatting models as pictures for one eye or both, drawn by OpenGL compute shaders.";
  module.attr("__version__") = BINOSPLAT_VERSION;
  Unlocked::outlive_all();
  add_errors(module);
  add_images(module);
  add_models(module);
  add_cameras(module);
  add_renderer(module);
  refuse_unmade(module);
}
