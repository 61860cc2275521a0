# embed(TARGET FOLDER HEADER NAMESPACE FUNCTION): compiles every file below FOLDER into TARGET as text; HEADER declares
# binosplat::NAMESPACE::FUNCTION(), the table of them.
function(embed target folder header namespace function)
  set(root ${CMAKE_CURRENT_SOURCE_DIR}/${folder})
  set(generated ${CMAKE_CURRENT_BINARY_DIR}/${function}.cpp)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS ${root}/*)
  add_custom_command(
    OUTPUT ${generated}
    COMMAND ${CMAKE_COMMAND} -DROOT=${root} -DOUT=${generated} -DHEADER=${header} -DNAMESPACE=${namespace}
            -DFUNCTION=${function} -P ${CMAKE_CURRENT_SOURCE_DIR}/cmake/embed_files.cmake
    DEPENDS ${files} ${CMAKE_CURRENT_SOURCE_DIR}/cmake/embed_files.cmake
    COMMENT "Embedding ${folder}")
  # Alone: clang-tidy reads the unity files before this one is made.
  set_source_files_properties(${generated} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  target_sources(${target} PRIVATE ${generated})
endfunction()
