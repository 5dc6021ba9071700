# SuiteSparse's CHOLMOD, which brings no CMake configuration before SuiteSparse 6.
#
# Defines the imported target SuiteSparse::CHOLMOD, SuiteSparse_VERSION and SuiteSparse_INCLUDE_DIR.
# CHOLMOD's supernodal module is under the GPL, version 2 or later; a binary linked with it is too.

find_path(SuiteSparse_INCLUDE_DIR NAMES cholmod_core.h PATH_SUFFIXES suitesparse)
find_library(SuiteSparse_CHOLMOD_LIBRARY NAMES cholmod)
find_library(SuiteSparse_config_LIBRARY NAMES suitesparseconfig)
mark_as_advanced(SuiteSparse_INCLUDE_DIR SuiteSparse_CHOLMOD_LIBRARY SuiteSparse_config_LIBRARY)

set(SuiteSparse_VERSION "")
if(SuiteSparse_INCLUDE_DIR)
  foreach(part MAIN SUB SUBSUB)
    file(STRINGS "${SuiteSparse_INCLUDE_DIR}/cholmod_core.h" line
      REGEX "^#define CHOLMOD_${part}_VERSION +[0-9]+" LIMIT_COUNT 1)
    string(REGEX REPLACE ".* ([0-9]+).*" "\\1" number "${line}")
    list(APPEND SuiteSparse_VERSION "${number}")
  endforeach()
  list(JOIN SuiteSparse_VERSION "." SuiteSparse_VERSION)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(SuiteSparse
  REQUIRED_VARS SuiteSparse_CHOLMOD_LIBRARY SuiteSparse_config_LIBRARY SuiteSparse_INCLUDE_DIR
  VERSION_VAR SuiteSparse_VERSION)
if(SuiteSparse_FOUND AND NOT TARGET SuiteSparse::CHOLMOD)
  add_library(SuiteSparse::CHOLMOD UNKNOWN IMPORTED)
  set_target_properties(SuiteSparse::CHOLMOD PROPERTIES
    IMPORTED_LOCATION "${SuiteSparse_CHOLMOD_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${SuiteSparse_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES "${SuiteSparse_config_LIBRARY}")
endif()
