# SuiteSparse's CHOLMOD and UMFPACK, which bring no CMake configuration before SuiteSparse 6.
#
#   find_package(SuiteSparse [REQUIRED] [COMPONENTS CHOLMOD UMFPACK])      both where none is named
#
# Defines the imported targets SuiteSparse::CHOLMOD and SuiteSparse::UMFPACK of the components found, and
# SuiteSparse_<component>_FOUND, SuiteSparse_<component>_VERSION, SuiteSparse_INCLUDE_DIR.
# UMFPACK and CHOLMOD's supernodal module are under the GPL, version 2 or later; a binary linked with them is too.

if(NOT SuiteSparse_FIND_COMPONENTS)
  set(SuiteSparse_FIND_COMPONENTS CHOLMOD UMFPACK)
endif()

find_path(SuiteSparse_INCLUDE_DIR NAMES SuiteSparse_config.h PATH_SUFFIXES suitesparse)
find_library(SuiteSparse_config_LIBRARY NAMES suitesparseconfig)
mark_as_advanced(SuiteSparse_INCLUDE_DIR SuiteSparse_config_LIBRARY)

# Version from the three numbers that <header> gives the macros <prefix>_{MAIN,SUB,SUBSUB}_VERSION.
function(_suitesparse_version header prefix result)
  set(version "")
  if(EXISTS "${header}")
    foreach(part MAIN SUB SUBSUB)
      file(STRINGS "${header}" line REGEX "^#define ${prefix}_${part}_VERSION +[0-9]+" LIMIT_COUNT 1)
      string(REGEX REPLACE ".* ([0-9]+).*" "\\1" number "${line}")
      list(APPEND version "${number}")
    endforeach()
  endif()
  list(JOIN version "." version)
  set(${result} "${version}" PARENT_SCOPE)
endfunction()

foreach(component IN LISTS SuiteSparse_FIND_COMPONENTS)
  if(component STREQUAL "CHOLMOD")
    set(_header cholmod_core.h)
  elseif(component STREQUAL "UMFPACK")
    set(_header umfpack.h)
  else()
    set(SuiteSparse_${component}_FOUND FALSE)
    continue()
  endif()
  string(TOLOWER ${component} _library)
  find_library(SuiteSparse_${component}_LIBRARY NAMES ${_library})
  mark_as_advanced(SuiteSparse_${component}_LIBRARY)
  _suitesparse_version("${SuiteSparse_INCLUDE_DIR}/${_header}" ${component} SuiteSparse_${component}_VERSION)
  if(SuiteSparse_${component}_LIBRARY AND SuiteSparse_${component}_VERSION AND SuiteSparse_config_LIBRARY)
    set(SuiteSparse_${component}_FOUND TRUE)
    if(NOT TARGET SuiteSparse::${component})
      add_library(SuiteSparse::${component} UNKNOWN IMPORTED)
      set_target_properties(SuiteSparse::${component} PROPERTIES
        IMPORTED_LOCATION "${SuiteSparse_${component}_LIBRARY}"
        INTERFACE_INCLUDE_DIRECTORIES "${SuiteSparse_INCLUDE_DIR}"
        INTERFACE_LINK_LIBRARIES "${SuiteSparse_config_LIBRARY}")
    endif()
  else()
    set(SuiteSparse_${component}_FOUND FALSE)
  endif()
endforeach()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(SuiteSparse REQUIRED_VARS SuiteSparse_INCLUDE_DIR HANDLE_COMPONENTS)
