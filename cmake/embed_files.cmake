# cmake -DROOT=dir -DOUT=file.cpp -DHEADER=h -DNAMESPACE=n -DFUNCTION=f -P embed_files.cmake: writes the C++ of f(),
# which HEADER declares in binosplat::n. It returns a table {path relative to ROOT, text}.
file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/*)
set(text "#include \"${HEADER}\"\n\nnamespace binosplat::${NAMESPACE} {\n\nconst std::map<std::string, std::string>& ${FUNCTION}() {\n  static const std::map<std::string, std::string> files = {\n")
foreach(name IN LISTS files)
  file(READ ${ROOT}/${name} body)
  string(APPEND text "      {\"${name}\", R\"EMBEDDED(${body})EMBEDDED\"},\n")
endforeach()
string(APPEND text "  };\n  return files;\n}\n\n}  // namespace binosplat::${NAMESPACE}\n")
file(WRITE ${OUT} "${text}")
