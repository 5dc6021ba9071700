# The program with what belongs to it (scenes, manual, licences, completions) as the install component `program`, and as
# a Debian package of that component: `cpack` in the build folder.

install(TARGETS stickslip RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT program)
install(FILES LICENSE README.md CITATION.cff DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT program)
# (where Debian looks for it)
install(FILES LICENSE RENAME copyright DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT program)
# (of the charts in the report)
install(FILES third_party/vega/THIRD_PARTY_NOTICES DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT program)
install(DIRECTORY docs DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT program PATTERN "stickslip.1" EXCLUDE)
install(DIRECTORY studies/scenes studies/meshes DESTINATION "${CMAKE_INSTALL_DATADIR}/stickslip" COMPONENT program)
install(FILES docs/stickslip.1 DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" COMPONENT program)
install(FILES tools/completion/stickslip.bash RENAME stickslip
  DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" COMPONENT program)
install(FILES tools/completion/stickslip.fish
  DESTINATION "${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d" COMPONENT program)
# zsh looks in site-functions of /usr/local, Debian's for packages in vendor-completions of /usr.
install(FILES tools/completion/_stickslip DESTINATION "${CMAKE_INSTALL_DATADIR}/zsh/site-functions" COMPONENT local)
install(FILES tools/completion/_stickslip
  DESTINATION "${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions" COMPONENT debian EXCLUDE_FROM_ALL)

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
set(CPACK_INSTALL_CMAKE_PROJECTS
  "${PROJECT_BINARY_DIR};${PROJECT_NAME};program;/;${PROJECT_BINARY_DIR};${PROJECT_NAME};debian;/")
include(CPack)
