# EVOLVENT_STATIC: link SUNDIALS, HDF5, zlib, libyaml, minizip and Mini-XML statically if static libraries exist beside the
# shared ones.
#
# As shared libraries they and their dependencies take nine tenths of the loader's work at each start: Debian's shared HDF5
# needs a network client, which a program with the static HDF5 does not. Libraries that are missing or do not link stay shared.
include(CheckCSourceCompiles)

option(
  EVOLVENT_STATIC
  "Make SUNDIALS, HDF5, zlib, libyaml, minizip and Mini-XML part of the program where their static libraries are found"
  ON
)

# The static libraries beside shared ones; empty unless all exist.
function(evolvent_static_beside result)
  set(found "")
  foreach(library IN LISTS ARGN)
    string(REGEX REPLACE "\\.(so|dylib)[.0-9]*$" ".a" static "${library}")
    if(static MATCHES "\\.a$" AND EXISTS "${static}")
      list(APPEND found "${static}")
    else()
      set(${result} "" PARENT_SCOPE)
      return()
    endif()
  endforeach()
  set(${result} ${found} PARENT_SCOPE)
endfunction()

# Whether a program that calls a function links with the given static libraries and their dependencies; false without libraries.
function(evolvent_links result function libraries)
  if(NOT EVOLVENT_STATIC OR NOT libraries)
    set(${result} OFF PARENT_SCOPE)
    return()
  endif()
  set(CMAKE_REQUIRED_LIBRARIES ${libraries} ${ARGN})
  set(CMAKE_REQUIRED_QUIET ON)
  check_c_source_compiles("char ${function}(void); int main(void) { return ${function}(); }" ${result})
  set(${result} "${${result}}" PARENT_SCOPE)
endfunction()

set(evolvent_static_names "")

# SUNDIALS. Its static targets depend on shared ones, so use the files only. All of them or none.
get_target_property(sundials_parts evolvent_sundials INTERFACE_LINK_LIBRARIES)
if(NOT TARGET SUNDIALS::core)
  list(APPEND sundials_parts SUNDIALS::generic)
endif()
set(sundials_static "")
if(klu_needs)
  list(REMOVE_ITEM sundials_parts ${klu_needs})
endif()
foreach(part IN LISTS sundials_parts)
  set(location "")
  if(part MATCHES "\\.a$")
    set(location "${part}")
  elseif(part MATCHES "^\\$<TARGET_FILE:(.*_static)>$")
    get_target_property(location ${CMAKE_MATCH_1} LOCATION)
  elseif(TARGET ${part}_static AND NOT part MATCHES "klu") # its target has the shared KLU
    get_target_property(location ${part}_static LOCATION)
  endif()
  if(NOT location)
    set(sundials_static "")
    break()
  endif()
  list(APPEND sundials_static "${location}")
endforeach()
evolvent_links(EVOLVENT_LINKS_STATIC_SUNDIALS IDACreate "${sundials_static}" m)
if(EVOLVENT_LINKS_STATIC_SUNDIALS)
  get_target_property(include SUNDIALS::ida_static INTERFACE_INCLUDE_DIRECTORIES)
  set_property(TARGET evolvent_sundials PROPERTY INTERFACE_LINK_LIBRARIES "${sundials_static};${klu_needs};m")
  set_property(TARGET evolvent_sundials APPEND PROPERTY INTERFACE_INCLUDE_DIRECTORIES "${include}")
  list(APPEND evolvent_static_names SUNDIALS)
endif()

# HDF5 with its high-level library and the libraries of its filters: one copy of HDF5 a program.
set(hdf5_targets hdf5::hdf5 hdf5::hdf5_hl)
set(hdf5_shared "")
foreach(target IN LISTS hdf5_targets)
  get_target_property(location ${target} LOCATION)
  list(APPEND hdf5_shared "${location}")
endforeach()
evolvent_static_beside(hdf5_static ${hdf5_shared})
set(hdf5_needs "")
foreach(name sz aec z)
  find_library(EVOLVENT_LIBRARY_${name} NAMES lib${name}.a ${name})
  mark_as_advanced(EVOLVENT_LIBRARY_${name})
  if(EVOLVENT_LIBRARY_${name})
    list(APPEND hdf5_needs "${EVOLVENT_LIBRARY_${name}}")
  endif()
endforeach()
find_package(Threads QUIET)
list(APPEND hdf5_needs ${CMAKE_DL_LIBS} ${CMAKE_THREAD_LIBS_INIT} m)
list(REVERSE hdf5_static) # the high-level library comes before its dependencies
evolvent_links(EVOLVENT_LINKS_STATIC_HDF5 H5open "${hdf5_static}" ${hdf5_needs})
list(REVERSE hdf5_static)
if(EVOLVENT_LINKS_STATIC_HDF5)
  foreach(target static IN ZIP_LISTS hdf5_targets hdf5_static)
    set_target_properties(${target} PROPERTIES IMPORTED_LOCATION "${static}")
  endforeach()
  set_property(TARGET hdf5::hdf5 PROPERTY INTERFACE_LINK_LIBRARIES "${hdf5_needs}")
  set_property(TARGET hdf5::hdf5_hl PROPERTY INTERFACE_LINK_LIBRARIES hdf5::hdf5)
  list(APPEND evolvent_static_names HDF5)
endif()

# zlib: the same copy as that of HDF5
evolvent_static_beside(zlib_static ${ZLIB_LIBRARIES})
evolvent_links(EVOLVENT_LINKS_STATIC_ZLIB crc32_z "${zlib_static}")
if(EVOLVENT_LINKS_STATIC_ZLIB)
  set_target_properties(ZLIB::ZLIB PROPERTIES IMPORTED_LOCATION "${zlib_static}")
  list(APPEND evolvent_static_names zlib)
endif()

# libyaml
evolvent_static_beside(yaml_static ${YAML_LINK_LIBRARIES})
evolvent_links(EVOLVENT_LINKS_STATIC_YAML yaml_parser_load "${yaml_static}")
if(EVOLVENT_LINKS_STATIC_YAML)
  set_property(TARGET PkgConfig::YAML PROPERTY INTERFACE_LINK_LIBRARIES "${yaml_static}")
  list(APPEND evolvent_static_names libyaml)
endif()

# minizip and Mini-XML, needed only by `evolvent fmu`
if(EVOLVENT_FMU)
  evolvent_static_beside(fmu_static ${MINIZIP_LINK_LIBRARIES})
  evolvent_links(EVOLVENT_LINKS_STATIC_MINIZIP zipOpen "${fmu_static}" "${EVOLVENT_LIBRARY_z}")
  if(EVOLVENT_LINKS_STATIC_MINIZIP)
    set_property(
      TARGET PkgConfig::MINIZIP
      PROPERTY INTERFACE_LINK_LIBRARIES "${fmu_static};${EVOLVENT_LIBRARY_z}"
    )
    list(APPEND evolvent_static_names minizip)
  endif()
  evolvent_static_beside(fmu_static ${MXML_LINK_LIBRARIES})
  evolvent_links(EVOLVENT_LINKS_STATIC_MXML mxmlNewXML "${fmu_static}" ${CMAKE_THREAD_LIBS_INIT})
  if(EVOLVENT_LINKS_STATIC_MXML)
    set_property(
      TARGET PkgConfig::MXML
      PROPERTY INTERFACE_LINK_LIBRARIES "${fmu_static};${CMAKE_THREAD_LIBS_INIT}"
    )
    list(APPEND evolvent_static_names Mini-XML)
  endif()
endif()

if(evolvent_static_names)
  list(JOIN evolvent_static_names ", " evolvent_static_names)
  message(STATUS "Part of the program: ${evolvent_static_names}")
endif()
