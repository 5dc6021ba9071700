# The target stickslip_version: studies/version.hpp, below generated/ of the build folder. It has the flags that hold for
# the folder which includes this file, and the licence in `effective_licence`.

# Written at build time, since the commit may change without a new configuration; rewritten only where it differs.
get_directory_property(global_options COMPILE_OPTIONS)
string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type)
list(JOIN global_options " " global_options)
string(STRIP "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${build_type}} ${global_options}" compile_flags)
set(version_header "${PROJECT_BINARY_DIR}/generated/studies/version.hpp")
add_custom_target(stickslip_version BYPRODUCTS "${version_header}"
  COMMAND "${CMAKE_COMMAND}"
    -D "SOURCE_DIR=${PROJECT_SOURCE_DIR}" -D "OUTPUT=${version_header}" -D "VERSION=${PROJECT_VERSION}"
    -D "COMPILER=${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}" -D "FLAGS=${compile_flags}"
    -D "BUILD_TYPE=${CMAKE_BUILD_TYPE}" -D "LICENCE=${effective_licence}"
    -P "${PROJECT_SOURCE_DIR}/cmake/write_version.cmake"
  VERBATIM COMMENT "Writes the version into a header")
