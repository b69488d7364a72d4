# Turns the files of tools/web into a C++ source of string literals.
#   cmake -DFOLDER=tools/web -DOUT=web_files.cpp -P embed.cmake
file(GLOB files RELATIVE ${FOLDER} ${FOLDER}/*.html ${FOLDER}/*.css ${FOLDER}/*.js)
set(source "#include \"pages/web_files.h\"\n\nnamespace hqslam::tools {\n\n")
string(APPEND source "const std::map<std::string, std::string, std::less<>>& web_files() {\n")
string(APPEND source "  static const std::map<std::string, std::string, std::less<>> files = {\n")
foreach(file IN LISTS files)
  file(READ ${FOLDER}/${file} content)
  string(APPEND source "      {\"${file}\", R\"~~~(${content})~~~\"},\n")
endforeach()
string(APPEND source "  };\n  return files;\n}\n\n}  // namespace hqslam::tools\n")
file(WRITE ${OUT} "${source}")
