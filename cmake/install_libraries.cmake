# The libraries as a CMake package: find_package(stickslip [COMPONENTS core methods sensitivity studies]), each component
# a target stickslip::COMPONENT that links those before it. Headers keep the layout of the sources, under
# include/stickslip, so an #include reads the same inside and outside.

set(libraries stickslip_core stickslip_methods stickslip_sensitivity stickslip_studies)
if(TARGET stickslip_report)
  list(APPEND libraries stickslip_report)
endif()
install(TARGETS ${libraries} EXPORT stickslip
  ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}"
  INCLUDES DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/stickslip")
# (core/algebra/backend.hpp is private: what it declares depends on the solvers built in)
install(DIRECTORY core methods sensitivity studies DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/stickslip"
  FILES_MATCHING PATTERN "*.hpp" PATTERN backend.hpp EXCLUDE
  PATTERN scenes EXCLUDE PATTERN meshes EXCLUDE PATTERN example EXCLUDE PATTERN python EXCLUDE)
install(FILES "${version_header}" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/stickslip/studies")

include(CMakePackageConfigHelpers)
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/stickslip")
set(solver_packages "")
if(TARGET SuiteSparse::CHOLMOD)
  list(APPEND solver_packages SuiteSparse)
endif()
if(TARGET MUMPS::dmumps_seq)
  list(APPEND solver_packages MUMPSSeq)
endif()
configure_package_config_file(cmake/stickslipConfig.cmake.in "${PROJECT_BINARY_DIR}/stickslipConfig.cmake"
  INSTALL_DESTINATION "${package_dir}" NO_SET_AND_CHECK_MACRO)
# before 1.0 a minor version may change names
write_basic_package_version_file("${PROJECT_BINARY_DIR}/stickslipConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(EXPORT stickslip NAMESPACE stickslip:: FILE stickslipTargets.cmake DESTINATION "${package_dir}")
install(FILES "${PROJECT_BINARY_DIR}/stickslipConfig.cmake" "${PROJECT_BINARY_DIR}/stickslipConfigVersion.cmake"
  DESTINATION "${package_dir}")
foreach(package IN LISTS solver_packages)
  install(FILES "cmake/Find${package}.cmake" DESTINATION "${package_dir}")
endforeach()
