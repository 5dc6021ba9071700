# The program with what belongs to it (scenes, manual, licences, completions) as the install component `program`, and as
# a Debian package of that component: `cpack` in the build folder.

install(TARGETS stickslip RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT program)
install(FILES LICENSE README.md CITATION.cff DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT program)
# (where Debian looks for it)
install(FILES LICENSE RENAME copyright DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT program)
# (of the charts in the report)
install(FILES third_party/vega/THIRD_PARTY_NOTICES DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT program)
# (the theory, which the pages refer to; what they refer to in the sources, which are not installed, is named alone)
install(FILES core/README.md DESTINATION "${CMAKE_INSTALL_DOCDIR}/core" COMPONENT program)
install(DIRECTORY docs DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT program PATTERN "manual.txt" EXCLUDE)
install(CODE "set(folder \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DOCDIR}\")" COMPONENT program)
install(SCRIPT cmake/unlink_pages.cmake COMPONENT program)
install(DIRECTORY studies/scenes studies/meshes DESTINATION "${CMAKE_INSTALL_DATADIR}/stickslip" COMPONENT program)
# (the page for learners, if play.sh has built it: reports link to it)
install(FILES build/wasm/stickslip.html DESTINATION "${CMAKE_INSTALL_DATADIR}/stickslip" COMPONENT program OPTIONAL)
install(FILES tools/stickslip.bash RENAME stickslip
  DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" COMPONENT program)
find_program(HELP2MAN_PROGRAM help2man)
if(HELP2MAN_PROGRAM)
  set(manual "${PROJECT_BINARY_DIR}/stickslip.1")
  add_custom_command(OUTPUT "${manual}"
    COMMAND bash "${PROJECT_SOURCE_DIR}/tools/manual.sh" "$<TARGET_FILE:stickslip>" > "${manual}"
    DEPENDS stickslip docs/manual.txt tools/manual.sh VERBATIM)
  add_custom_target(stickslip_manual ALL DEPENDS "${manual}")
  install(FILES "${manual}" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" COMPONENT program)
else()
  message(STATUS "help2man was not found: there is no manual page")
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME stickslip)
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}")
set(CPACK_PACKAGE_CONTACT "the authors of stickslip")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "frictional contact by three methods, with the derivatives of each")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "One scene with frictional contact, solved by the penalty method, the Uzawa and
the monolithic augmented Lagrangian, with the sensitivity analysis that
matches each.
.
This build needs the instruction set: ${instruction_set}")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# The reference BLAS would do, 3 to 6 times slower.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libopenblas0-serial | libblas.so.3")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "librsvg2-bin, fonts-liberation")  # for report --pdf
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR};${PROJECT_NAME};program;/")
include(CPack)
