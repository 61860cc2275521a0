# cmake -DROOT=dir -DOUT=file.cpp -P embed_files.cmake: writes a table {path relative to ROOT, text} as C++.
file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/*)
set(text "#include \"gl/shader_source.h\"\n\nnamespace binosplat::gl {\n\nconst std::map<std::string, std::string>& embedded_shaders() {\n  static const std::map<std::string, std::string> files = {\n")
foreach(name IN LISTS files)
  file(READ ${ROOT}/${name} body)
  string(APPEND text "      {\"${name}\", R\"SHADER(${body})SHADER\"},\n")
endforeach()
string(APPEND text "  };\n  return files;\n}\n\n}  // namespace binosplat::gl\n")
file(WRITE ${OUT} "${text}")
