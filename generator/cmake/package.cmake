# cpack -G DEB: a Debian package of what is installed. What it depends on is found by dpkg-shlibdeps.
find_program(GZIP gzip REQUIRED)
set(DEBIAN ${CMAKE_BINARY_DIR}/package/debian)
set(PERILAT_CONTACT "perilat maintainers <maintainers@perilat.example>" CACHE STRING "Maintainer of packages: name <address>")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT ${PERILAT_CONTACT})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
                                                WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 0upstream1) # not Debian's own
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
# Laws are compiled when they are run; without a compiler they are interpreted.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "gcc | c-compiler, libc6-dev | libc-dev")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "paraview, python3-h5py")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
"A material law is written as in a paper: equations for the force in the bond
between two particles of a lattice. perilat checks units and mechanics, turns
the law into C, and runs it: loads, energies and cracks of concrete beams,
plates and blocks, by explicit dynamics or quasi-statically.")
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_BINARY_DIR}/package/project.cmake)
if(PERILAT_NATIVE)
  string(APPEND CPACK_DEBIAN_PACKAGE_DESCRIPTION "

This package runs on processors like that of the machine that built it.")
  file(WRITE ${CPACK_PROJECT_CONFIG_FILE} "message(WARNING \"The package will run on processors like this one only; "
       "configure with -DPERILAT_NATIVE=OFF for one that runs on all.\")\n")
else()
  file(WRITE ${CPACK_PROJECT_CONFIG_FILE} "")
endif()

# Debian's own files: the changelog, and whose the program is.
string(TIMESTAMP CHANGELOG_DATE "%a, %d %b %Y %H:%M:%S +0000" UTC)
configure_file(generator/cmake/debian/changelog.in ${DEBIAN}/changelog @ONLY)
execute_process(COMMAND ${GZIP} -9nf ${DEBIAN}/changelog COMMAND_ERROR_IS_FATAL ANY)
install(FILES ${DEBIAN}/changelog.gz DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME changelog.Debian.gz)
install(FILES generator/cmake/debian/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})

include(CPack)
