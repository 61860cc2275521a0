# What is built around the core: levels of detail, the library for other programs, bench and profile, smaller models,
# the two programs, headsets and Python.

find_package(CLI11 REQUIRED)

module(stream src/stream binosplat_render binosplat_formats)
module(lab src/lab binosplat_adagscale binosplat_stereo binosplat_stream)
embed(binosplat_lab src/lab/page lab/embedded.h lab page_files)
embed(binosplat_lab third_party lab/embedded.h lab third_party_files)
embed(binosplat_lab src/lab/presets lab/embedded.h lab preset_files)
module(compact src/compact binosplat_lab)

# Other programs link to one archive, which has the modules that implement include/binosplat.
module(library src/library binosplat_adagscale binosplat_stereo binosplat_stream)
add_library(binosplat_archive STATIC)
add_library(binosplat::binosplat ALIAS binosplat_archive)
set_target_properties(binosplat_archive PROPERTIES OUTPUT_NAME binosplat EXPORT_NAME binosplat LINKER_LANGUAGE CXX)
target_compile_features(binosplat_archive INTERFACE cxx_std_20)
target_include_directories(binosplat_archive INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                           $<INSTALL_INTERFACE:include>)
target_link_libraries(binosplat_archive PUBLIC glm::glm)
# scripts/release.sh builds the same as a shared library, for people who lack the libraries that it links to.
add_library(binosplat_shared SHARED EXCLUDE_FROM_ALL)
set_target_properties(binosplat_shared PROPERTIES OUTPUT_NAME binosplat LINKER_LANGUAGE CXX VERSION ${PROJECT_VERSION}
                      SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
target_link_options(binosplat_shared PRIVATE -Wl,--version-script=${PROJECT_SOURCE_DIR}/src/library/exported.map)
foreach(name base scene formats gl reference render measure adagscale stereo stream library)
  get_target_property(others binosplat_${name} LINK_LIBRARIES)
  list(FILTER others EXCLUDE REGEX "^(binosplat_|glm::|nlohmann_json::)")
  foreach(library binosplat_archive binosplat_shared)
    target_sources(${library} PRIVATE $<TARGET_OBJECTS:binosplat_${name}>)
    target_link_libraries(${library} PRIVATE ${others})
  endforeach()
endforeach()

# Both programs, binosplat and binosplat-view, link the commands.
file(GLOB_RECURSE app_sources CONFIGURE_DEPENDS src/app/*.cpp)
list(FILTER app_sources EXCLUDE REGEX "/main.cpp$|/viewer/")
add_library(binosplat_app STATIC ${app_sources})
target_compile_definitions(binosplat_app PUBLIC BINOSPLAT_VERSION="${PROJECT_VERSION}")
target_link_libraries(binosplat_app PUBLIC binosplat_compact binosplat_demo CLI11::CLI11)
target_precompile_headers(binosplat_app PRIVATE ${common_headers})  # with CLI11 and json, builds take longer
compile_quickly(binosplat_app)
# GLFW before 3.4 links to X11, so has_preview() checks that its library is installed.
find_package(glfw3 3.3 QUIET)
if(glfw3_FOUND AND glfw3_VERSION VERSION_LESS 3.4)
  set(preview_needs libX11.so.6)
endif()
target_compile_definitions(binosplat_app PRIVATE BINOSPLAT_PREVIEW_NEEDS="${preview_needs}")
add_executable(binosplat src/app/main.cpp)
target_link_libraries(binosplat PRIVATE binosplat_app)
compile_quickly(binosplat)

# Headsets need OpenXR's headers, and those of OpenGL and EGL (libgl-dev, libegl-dev). The program opens OpenXR's loader
# at run time, when the user asks for a headset.
find_path(openxr_folder openxr/openxr.h)
if(openxr_folder)
  file(GLOB xr_sources CONFIGURE_DEPENDS src/xr/*.cpp)
  add_library(binosplat_xr STATIC ${xr_sources})
  target_link_libraries(binosplat_xr PUBLIC binosplat_library ${CMAKE_DL_LIBS})
  target_precompile_headers(binosplat_xr REUSE_FROM binosplat_base)
else()
  message(NOTICE "No openxr/openxr.h: `binosplat view --xr` is not built")
endif()

# The preview is a program of its own, so that binosplat links no window system. It needs GLFW and Dear ImGui.
pkg_check_modules(imgui QUIET IMPORTED_TARGET imgui)
if(glfw3_FOUND AND imgui_FOUND)
  file(GLOB preview_sources CONFIGURE_DEPENDS src/preview/*.cpp)
  add_library(binosplat_preview STATIC ${preview_sources})
  target_link_libraries(binosplat_preview PUBLIC binosplat_stereo binosplat_stream binosplat_adagscale glfw
                        PkgConfig::imgui ${CMAKE_DL_LIBS})
  compile_quickly(binosplat_preview)
  file(GLOB viewer_sources CONFIGURE_DEPENDS src/app/viewer/*.cpp)
  add_executable(binosplat_view ${viewer_sources})
  set_target_properties(binosplat_view PROPERTIES OUTPUT_NAME binosplat-view)
  target_link_libraries(binosplat_view PRIVATE binosplat_app binosplat_preview)
  compile_quickly(binosplat_view)
  if(TARGET binosplat_xr)
    target_compile_definitions(binosplat_view PRIVATE BINOSPLAT_XR)
    target_link_libraries(binosplat_view PRIVATE binosplat_xr)
  else()
    list(FILTER viewer_sources EXCLUDE REGEX "/headset.cpp$")
    set_target_properties(binosplat_view PROPERTIES SOURCES "${viewer_sources}")
  endif()
else()
  message(NOTICE "No glfw3 or imgui: `binosplat view` is not built")
endif()

# `import binosplat` needs pybind11. It is built for the first Python that CMake finds; -DPython_EXECUTABLE=... names
# another one.
set(PYBIND11_FINDPYTHON ON)
if(BINOSPLAT_PYTHON STREQUAL AUTO)
  find_package(Python COMPONENTS Interpreter Development.Module QUIET)
  if(Python_FOUND)
    find_package(pybind11 2.10 QUIET)
  endif()
elseif(BINOSPLAT_PYTHON)
  find_package(Python REQUIRED COMPONENTS Interpreter Development.Module)
  find_package(pybind11 2.10 REQUIRED)
endif()
if(pybind11_FOUND)
  file(GLOB python_sources CONFIGURE_DEPENDS src/python/*.cpp)
  pybind11_add_module(binosplat_python MODULE NO_EXTRAS ${python_sources})
  set_target_properties(binosplat_python PROPERTIES OUTPUT_NAME _binosplat
                        LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/python/binosplat)
  # Copies the package's other files beside the module, so that Python can import it from the build folder.
  set(python_files __init__.py py.typed)
  foreach(file ${python_files})
    configure_file(src/python/binosplat/${file} ${PROJECT_BINARY_DIR}/python/binosplat/${file} COPYONLY)
  endforeach()
  target_compile_definitions(binosplat_python PRIVATE BINOSPLAT_VERSION="${PROJECT_VERSION}")
  target_link_libraries(binosplat_python PRIVATE binosplat_stereo binosplat_adagscale)
  # Hides the symbols of linked libraries, because another module of the process may have the same libraries.
  target_link_options(binosplat_python PRIVATE -Wl,--exclude-libs,ALL)
  compile_quickly(binosplat_python)
elseif(NOT BINOSPLAT_PYTHON STREQUAL OFF)
  message(STATUS "No pybind11 or no headers of Python: the Python module is not built")
endif()
