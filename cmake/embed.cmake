# embed(TARGET FOLDER HEADER NAMESPACE FUNCTION) compiles every file below FOLDER into TARGET as text. HEADER declares
# binosplat::NAMESPACE::FUNCTION(), which returns the table of files.
function(embed target folder header namespace function)
  set(root ${CMAKE_CURRENT_SOURCE_DIR}/${folder})
  set(generated ${CMAKE_CURRENT_BINARY_DIR}/${function}.cpp)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS ${root}/*)
  # A renamed file keeps its time of change, so the names of all files are a dependency, too.
  file(GENERATE OUTPUT ${generated}.names CONTENT "${files}")
  add_custom_command(
    OUTPUT ${generated}
    COMMAND ${CMAKE_COMMAND} -DROOT=${root} -DOUT=${generated} -DHEADER=${header} -DNAMESPACE=${namespace}
            -DFUNCTION=${function} -P ${CMAKE_CURRENT_SOURCE_DIR}/cmake/embed_files.cmake
    DEPENDS ${files} ${generated}.names ${CMAKE_CURRENT_SOURCE_DIR}/cmake/embed_files.cmake
    COMMENT "Embedding ${folder}")
  # clang-tidy reads unity files before this file exists, so it is compiled alone.
  set_source_files_properties(${generated} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  target_sources(${target} PRIVATE ${generated})
endfunction()
