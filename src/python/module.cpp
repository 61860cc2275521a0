// The private module _binosplat, through which the package binosplat loads, draws and compares.

#include "python/module.h"

#include <array>
#include <new>
#include <string_view>

#include "base/error.h"
#include "base/memory.h"
#include "python/released_gil.h"

namespace binosplat::python {

namespace {

// The package's exceptions, by ExitCode. Never freed: one may be thrown during Python's shutdown.
std::array<PyObject*, 5> error_types{};

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(std::move(thrown));
  } catch (const Error& error) {
    // Texts quote file names, which may not be UTF-8.
    const std::string_view text = error.what();
    const auto words = py::reinterpret_steal<py::object>(
        PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "replace"));
    PyErr_SetObject(error_types[static_cast<std::size_t>(error.code())], words.ptr());
  } catch (const std::filesystem::filesystem_error& error) {
    translate(std::make_exception_ptr(Error(ExitCode::bad_input, error.what())));
  } catch (const py::cast_error&) {
    PyErr_SetString(PyExc_TypeError, "a value of a Camera or a Rig has a wrong type");
  } catch (const std::bad_alloc&) {
    PyErr_SetString(error_types[static_cast<std::size_t>(ExitCode::out_of_memory)], "no memory is left");
  }
}

}  // namespace

void add_errors() {
  const auto package = py::module_::import("binosplat");  // already initialised up to its exceptions
  const auto type = [&](const char* name) { return package.attr(name).cast<py::object>().release().ptr(); };
  error_types.fill(type("Error"));
  error_types[static_cast<std::size_t>(ExitCode::bad_input)] = type("InputError");
  error_types[static_cast<std::size_t>(ExitCode::no_gl)] = type("OpenGLError");
  error_types[static_cast<std::size_t>(ExitCode::out_of_memory)] = type("OutOfMemory");
  py::register_exception_translator(translate);
}

}  // namespace binosplat::python

PYBIND11_MODULE(_binosplat, module) {
  using namespace binosplat::python;
  module.attr("__version__") = BINOSPLAT_VERSION;
  module.def("memory_bytes", &binosplat::memory_bytes);
  ReleasedGil::outlive_all();
  add_errors();
  add_images(module);
  add_models(module);
  add_cameras(module);
  add_renderer(module);
}
