# Writes the texts of kernel.h, elementary.h and rectangle.h as C string constants: emitted kernels
# are self-contained, so includes of each other are left out.
file(WRITE ${OUT} "/* Generated from runtime/kernel.h, dsl/base/elementary.h and runtime/rectangle.h. */\n#include \"generator/target/prelude.h\"\n")
foreach(pair "kernel_h;runtime/kernel.h" "elementary_h;dsl/base/elementary.h" "rectangle_h;runtime/rectangle.h")
  list(GET pair 0 name)
  list(GET pair 1 path)
  file(READ ${SOURCE_DIR}/${path} text)
  string(REGEX REPLACE "#include \"[^\n]*\n" "" text "${text}")
  string(HEX "${text}" hex)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
  string(REGEX REPLACE "((0x..,){24})" "\\1\n" bytes "${bytes}")
  file(APPEND ${OUT} "const char prelude_${name}[] = {\n${bytes}0};\n")
endforeach()
