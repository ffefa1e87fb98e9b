# Writes a C++ source with the bytes of FILES to OUT (embedded_file.h).
set(TEXT "")
set(NUMBER 0)
set(LIST "")
foreach(FILE ${FILES})
  file(READ ${FILE} HEX HEX)
  string(REGEX REPLACE "(..)" "0x\\1," BYTES "${HEX}")
  get_filename_component(NAME ${FILE} NAME)
  string(APPEND TEXT "constexpr unsigned char kFile${NUMBER}[] = {${BYTES}};\n")
  string(APPEND LIST "    {\"${NAME}\", kFile${NUMBER}, sizeof kFile${NUMBER}},\n")
  math(EXPR NUMBER "${NUMBER} + 1")
endforeach()
file(WRITE ${OUT} "#include \"coordinator/page/embedded_file.h\"
namespace tessera {
namespace {
${TEXT}constexpr EmbeddedFile kEmbeddedFiles[] = {\n${LIST}};
}
std::span<const EmbeddedFile> EmbeddedFiles() { return kEmbeddedFiles; }
}
")
