# Sequential MUMPS in double precision, which brings no CMake configuration.
#
#   find_package(MUMPSSeq [5.5] [REQUIRED])
#
# Defines the imported target MUMPS::dmumps_seq, and MUMPSSeq_FOUND, MUMPSSeq_VERSION, MUMPSSeq_LIBRARY,
# MUMPSSeq_INCLUDE_DIR. The library is looked for under its versioned name too (libdmumps_seq-5.5.so), so that Debian's
# libmumps-seq-5.5 and libmumps-headers-dev suffice: libmumps-seq-dev would bring an MPI development tree.

find_path(MUMPSSeq_INCLUDE_DIR NAMES dmumps_c.h PATH_SUFFIXES mumps-seq-shared mumps)

set(MUMPSSeq_VERSION "")
if(MUMPSSeq_INCLUDE_DIR)
  file(STRINGS "${MUMPSSeq_INCLUDE_DIR}/dmumps_c.h" _line REGEX "#define MUMPS_VERSION \"" LIMIT_COUNT 1)
  string(REGEX REPLACE ".*\"([0-9.]+).*" "\\1" MUMPSSeq_VERSION "${_line}")
endif()
string(REGEX MATCH "^[0-9]+\\.[0-9]+" _series "${MUMPSSeq_VERSION}")

find_library(MUMPSSeq_LIBRARY NAMES dmumps_seq-${_series} dmumps_seq)
mark_as_advanced(MUMPSSeq_INCLUDE_DIR MUMPSSeq_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(MUMPSSeq
  REQUIRED_VARS MUMPSSeq_LIBRARY MUMPSSeq_INCLUDE_DIR VERSION_VAR MUMPSSeq_VERSION)

if(MUMPSSeq_FOUND AND NOT TARGET MUMPS::dmumps_seq)
  add_library(MUMPS::dmumps_seq UNKNOWN IMPORTED)
  set_target_properties(MUMPS::dmumps_seq PROPERTIES
    IMPORTED_LOCATION "${MUMPSSeq_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${MUMPSSeq_INCLUDE_DIR}")
endif()
