# Writes a C++ source that holds files, byte for byte. Called by hybridtest_embed_files().
#
#   cmake -D NAME=<function> -D FILES=<path>|<path>… -D OUTPUT=<file.cpp> -P embed_files.cmake
string(REPLACE "|" ";" files "${FILES}")
set(arrays "")
set(entries "")
set(number 0)
foreach(file IN LISTS files)
  file(READ ${file} bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  # Lines that an editor can show.
  string(REGEX REPLACE "(0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,)" "\\1\n" bytes "${bytes}")
  cmake_path(GET file FILENAME name)
  # The zero at the end also makes the array of an empty file one.
  string(APPEND arrays "const unsigned char kFile${number}[] = {\n${bytes}0};\n")
  string(APPEND entries "      {\"${name}\", {reinterpret_cast<const char*>(kFile${number}), sizeof kFile${number} - 1}},\n")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE ${OUTPUT} "// Written by cmake/embed_files.cmake.
#include \"core/embedded_file.hpp\"

namespace hybridtest::embedded {
namespace {

${arrays}
}  // namespace

std::span<const EmbeddedFile> ${NAME}();
std::span<const EmbeddedFile> ${NAME}() {
  static const EmbeddedFile files[] = {
${entries}  };
  return files;
}

}  // namespace hybridtest::embedded
")
