# `cmake --build build --target playground`: playground.html and playground.wasm in build/playground, with
# emscripten where it is installed.
find_program(EMCMAKE emcmake)
set(PLAYGROUND ${CMAKE_BINARY_DIR}/playground)
if(NOT EMCMAKE)
  add_custom_target(playground
    COMMAND ${CMAKE_COMMAND} -E echo "The playground needs emscripten (Debian, Ubuntu: apt-get install emscripten); configure again when it is there."
    COMMAND ${CMAKE_COMMAND} -E false)
  return()
endif()
# Where Debian has the parser of scripts that emscripten needs, whatever node is used.
set(WITH_NODE ${CMAKE_COMMAND} -E env NODE_PATH=/usr/share/nodejs)
file(GLOB PLAYGROUND_PAGE CONFIGURE_DEPENDS generator/playground/page/*)
# Of the course the page holds what students get.
file(GLOB EXERCISES CONFIGURE_DEPENDS examples/course/*/exercise.nml)
set(PUBLISH COMMAND ${CMAKE_COMMAND} -E rm -rf ${PLAYGROUND}/course)
foreach(exercise ${EXERCISES})
  get_filename_component(exercise ${exercise} DIRECTORY)
  get_filename_component(name ${exercise} NAME)
  list(APPEND PUBLISH COMMAND ${CMAKE_COMMAND} -E make_directory ${PLAYGROUND}/course
       COMMAND perilat grade ${exercise} --publish ${PLAYGROUND}/course/${name})
endforeach()
add_custom_target(playground
  ${PUBLISH}
  COMMAND ${WITH_NODE} ${EMCMAKE} ${CMAKE_COMMAND} -S ${CMAKE_SOURCE_DIR}/generator/playground -B ${PLAYGROUND}/program
          -G ${CMAKE_GENERATOR} -DCMAKE_BUILD_TYPE=Release -DROOT=${CMAKE_SOURCE_DIR} -DGENERATED=${CMAKE_BINARY_DIR}/generated
          -DVERSION=${PROJECT_VERSION}
  COMMAND ${WITH_NODE} ${CMAKE_COMMAND} --build ${PLAYGROUND}/program
  COMMAND ${CMAKE_COMMAND} -DROOT=${CMAKE_SOURCE_DIR} -DOUT=${PLAYGROUND} -DPROGRAM=${PLAYGROUND}/program
          -P ${CMAKE_SOURCE_DIR}/generator/playground/page.cmake
  DEPENDS perilat perilat_dsl ${PRELUDE} ${PLAYGROUND_PAGE}
  USES_TERMINAL VERBATIM)
