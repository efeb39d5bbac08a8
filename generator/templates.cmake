# Writes the texts that `perilat new` starts from as C constants.
file(WRITE ${OUT} "/* Generated from generator/templates. */\n#include \"generator/command/templates.h\"\n")
foreach(name central.plm micropolar.plm drive.nml deck.nml continuum.plm continuum_drive.nml continuum_deck.nml crack.plm
        crack_deck.nml state.plm state_drive.nml)
  file(READ ${SOURCE_DIR}/generator/templates/${name} hex HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
  string(REGEX REPLACE "((0x..,){24})" "\\1\n" bytes "${bytes}")
  get_filename_component(stem ${name} NAME_WE)
  file(APPEND ${OUT} "const char template_${stem}[] = {\n${bytes}0};\n")
endforeach()
