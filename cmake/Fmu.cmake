# The binary that `evolvent fmu` packs into each FMU: kernel, driver and their libraries in one file, so that the importer's
# system needs to provide only the C library. Only libgfortran cannot be part of another library, since Debian's archive is not
# position-independent; the program packs it beside the binary.
set(fmu_name evolvent_fmu)
file(GLOB fmu_sources CONFIGURE_DEPENDS driver/fmu/fmi3_*.c)
set_source_files_properties(driver/fmu/fmi3_absent.c PROPERTIES COMPILE_OPTIONS -Wno-unused-parameter)
add_library(evolvent_fmu MODULE ${fmu_sources} driver/library/boundary.c driver/library/memory_call.c)
set_target_properties(
  evolvent_fmu
  PROPERTIES
    OUTPUT_NAME ${fmu_name}
    PREFIX "lib"
    BUILD_WITH_INSTALL_RPATH ON
    INSTALL_RPATH "$ORIGIN"
    INSTALL_RPATH_USE_LINK_PATH OFF
    LINKER_LANGUAGE Fortran
)
target_include_directories(
  evolvent_fmu
  PRIVATE
    "${PROJECT_SOURCE_DIR}/driver"
    "${PROJECT_SOURCE_DIR}/driver/library/include"
    "${PROJECT_SOURCE_DIR}/src/include"
    "${PROJECT_BINARY_DIR}/generated"
)
add_dependencies(evolvent_fmu evolvent_driver evolvent_kernel)

# Link LAPACK statically if its archives are suitable for that.
set(fmu_lapack LAPACK::LAPACK)
set(
  fmu_carries
  gfortran
  quadmath
  lapack
  blas
  openblas
)
set(fmu_archives "")
foreach(library IN LISTS LAPACK_LIBRARIES)
  string(REGEX REPLACE "\\.so$" "_pic.a" archive "${library}")
  if(NOT EXISTS "${archive}")
    string(REGEX REPLACE "\\.so$" ".a" archive "${library}")
  endif()
  if(archive MATCHES "\\.a$" AND EXISTS "${archive}")
    list(APPEND fmu_archives "${archive}")
  elseif(library MATCHES "\\.so$")
    set(fmu_archives "")
    break()
  endif()
endforeach()
if(EVOLVENT_STATIC AND fmu_archives)
  set(CMAKE_REQUIRED_LIBRARIES -shared ${fmu_archives} gfortran m)
  set(CMAKE_REQUIRED_QUIET ON)
  check_c_source_compiles(
    "void dgesvd_(void); void dgeevx_(void); void start(void); void start(void) { dgesvd_(); dgeevx_(); }"
    EVOLVENT_LINKS_LAPACK_INTO_FMU
  )
  unset(CMAKE_REQUIRED_LIBRARIES)
  unset(CMAKE_REQUIRED_QUIET)
  if(EVOLVENT_LINKS_LAPACK_INTO_FMU)
    set(fmu_lapack ${fmu_archives})
    set(fmu_carries gfortran quadmath)
  endif()
endif()
target_link_libraries(
  evolvent_fmu
  PRIVATE
    evolvent_options
    "$<TARGET_FILE:evolvent_driver>"
    "$<TARGET_FILE:evolvent_kernel>"
    ${fmu_lapack}
    PkgConfig::YAML
    m
)
if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
  set(exported "${PROJECT_SOURCE_DIR}/cmake/fmu.map")
  # The old kind of search path (RPATH) also applies to the libraries that libgfortran needs.
  target_link_options(
    evolvent_fmu
    PRIVATE "-Wl,--version-script=${exported}" -static-libgcc "-Wl,--disable-new-dtags"
  )
  set_property(TARGET evolvent_fmu APPEND PROPERTY LINK_DEPENDS "${exported}")
endif()
evolvent_end_without_memory(evolvent_fmu)
add_dependencies(evolvent evolvent_fmu)
install(TARGETS evolvent_fmu LIBRARY DESTINATION "${evolvent_library_dir}" COMPONENT program)

# Path of the binary relative to the program's folder, and the program's own libraries that are packed beside it.
list(JOIN fmu_carries " " fmu_carries)
set_source_files_properties(
  driver/fmu/fmu_binary.c
  PROPERTIES
    COMPILE_DEFINITIONS
      "_GNU_SOURCE;FMU_BINARY=\"lib${fmu_name}${CMAKE_SHARED_MODULE_SUFFIX}\";FMU_FOLDER=\"${to_library}\";FMU_BUNDLED=\"${fmu_carries}\""
)
