# embed_shaders(TARGET): compiles every file below shaders/ into TARGET as text (gl/shader_source.h declares the table).
function(embed_shaders target)
  set(root ${CMAKE_CURRENT_SOURCE_DIR}/shaders)
  set(generated ${CMAKE_CURRENT_BINARY_DIR}/embedded_shaders.cpp)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS ${root}/*)
  add_custom_command(
    OUTPUT ${generated}
    COMMAND ${CMAKE_COMMAND} -DROOT=${root} -DOUT=${generated} -P ${CMAKE_CURRENT_SOURCE_DIR}/cmake/embed_files.cmake
    DEPENDS ${files} ${CMAKE_CURRENT_SOURCE_DIR}/cmake/embed_files.cmake
    COMMENT "Embedding shaders")
  target_sources(${target} PRIVATE ${generated})
endfunction()
