# cmake -D SOURCE_DIR= OUTPUT= VERSION= COMPILER= FLAGS= BUILD_TYPE= LICENCE= -P write_version.cmake
# Writes studies/version.hpp from its template, with the commit of the sources ("unknown" outside a git work tree).

set(GIT "unknown")
find_program(GIT_PROGRAM git)
if(GIT_PROGRAM AND EXISTS "${SOURCE_DIR}/.git")
  execute_process(COMMAND "${GIT_PROGRAM}" describe --always --dirty --tags --abbrev=12
    WORKING_DIRECTORY "${SOURCE_DIR}" OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(described)
    set(GIT "${described}")
  endif()
endif()
configure_file("${SOURCE_DIR}/studies/version.hpp.in" "${OUTPUT}" @ONLY)
