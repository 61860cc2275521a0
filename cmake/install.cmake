# Tells `cmake --install` and cpack what to install: the programs, the Python module, the library with the headers of
# include/, and the files that find_package(binosplat) reads.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS binosplat RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
if(TARGET binosplat_view)
  install(TARGETS binosplat_view RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} OPTIONAL)  # ./demo builds without it
endif()
# The program prints its own manual page.
add_custom_command(TARGET binosplat POST_BUILD COMMAND binosplat --print-manual > ${PROJECT_BINARY_DIR}/binosplat.1 VERBATIM)
install(FILES ${PROJECT_BINARY_DIR}/binosplat.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
if(TARGET binosplat_python)
  # Asks Python in which folder below the prefix it looks for modules. Debian's Python has a folder of its own.
  execute_process(
    COMMAND ${Python_EXECUTABLE} -c
            "import sysconfig as s; print(s.get_path('platlib', 'deb_system' if 'deb_system' in s.get_scheme_names() else 'posix_prefix', {'base': '.', 'platbase': '.'}))"
    OUTPUT_VARIABLE python_modules OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  install(TARGETS binosplat_python LIBRARY DESTINATION ${python_modules}/binosplat COMPONENT python
          OPTIONAL)  # ./demo builds without it
  list(TRANSFORM python_files PREPEND src/python/binosplat/)
  install(FILES ${python_files} DESTINATION ${python_modules}/binosplat COMPONENT python)
endif()
install(TARGETS binosplat_archive EXPORT binosplat_targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY include/binosplat DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/binosplat)
install(EXPORT binosplat_targets NAMESPACE binosplat:: FILE binosplatTargets.cmake DESTINATION ${package})
configure_package_config_file(cmake/binosplatConfig.cmake.in binosplatConfig.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(binosplatConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/binosplatConfig.cmake ${PROJECT_BINARY_DIR}/binosplatConfigVersion.cmake
        DESTINATION ${package})

# Installs docs/ with the files that its pages link to.
install(FILES README.md CHANGELOG.md CONTRIBUTING.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY tests/bench/results DESTINATION ${CMAKE_INSTALL_DOCDIR}/tests/bench)
install(FILES packages/Dockerfile DESTINATION ${CMAKE_INSTALL_DOCDIR}/packages)
foreach(module adagscale render)
  install(FILES src/${module}/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/src/${module})
endforeach()
install(FILES examples/embed.cpp examples/mesh.cpp examples/world.cpp examples/openxr.cpp examples/CMakeLists.txt DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)

set(CPACK_GENERATOR "DEB;TGZ")
set(CPACK_PACKAGE_NAME binosplat)
set(CPACK_PACKAGE_CONTACT "The maintainers of binosplat")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# The package recommends the drivers that programs open at run time, and suggests what programs need that link to the
# library.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libegl1, libegl-mesa0, libgl1-mesa-dri, python3-numpy")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "g++, cmake, pkg-config, libegl-dev, libgl-dev, libglm-dev, libfmt-dev, \
libopenexr-dev, libpng-dev, libdeflate-dev, libturbojpeg0-dev, libwebp-dev, libyaml-cpp-dev, libzip-dev, libzstd-dev, zlib1g-dev, libtbb-dev, libosmesa6")
include(CPack)
