# libevolvent: the program's analyses for other programs, without HDF5, which could conflict with another HDF5 in their process.
#
# It links the driver's archive, with its own implementations where the program writes files or ends itself: the linker searches
# the archive only for symbols that are not yet defined.
file(GLOB library_sources CONFIGURE_DEPENDS driver/library/*.c)
add_library(
  evolvent_library
  SHARED
  ${library_sources}
  driver/files/history_memory.c
  driver/files/no_files.c
  driver/files/response_memory.c
)
set_target_properties(
  evolvent_library
  PROPERTIES OUTPUT_NAME evolvent SOVERSION 0 BUILD_WITH_INSTALL_RPATH ON INSTALL_RPATH "$ORIGIN"
)
target_include_directories(
  evolvent_library
  PUBLIC "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/driver/library/include>"
  PRIVATE "${PROJECT_SOURCE_DIR}/driver" "${PROJECT_SOURCE_DIR}/src/include" "${PROJECT_BINARY_DIR}/generated"
)
add_dependencies(evolvent_library evolvent_driver)
target_link_libraries(
  evolvent_library
  PRIVATE
    evolvent_options
    "$<TARGET_FILE:evolvent_driver>"
    evolvent_sundials
    PkgConfig::YAML
    m
    evolvent_kernel_shared
)
if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
  set(exported "${PROJECT_SOURCE_DIR}/cmake/library.map")
  target_link_options(evolvent_library PRIVATE "-Wl,--version-script=${exported}")
  set_property(TARGET evolvent_library APPEND PROPERTY LINK_DEPENDS "${exported}")
endif()
evolvent_end_without_memory(evolvent_library)
add_dependencies(evolvent evolvent_library) # built with the program, as in a wheel

# Files for other programs: find_package(evolvent), pkg-config, headers. The folder of an installation may be moved.
include(CMakePackageConfigHelpers)
set_target_properties(evolvent_kernel_shared PROPERTIES EXPORT_NAME kernel)
set_target_properties(evolvent_library PROPERTIES EXPORT_NAME evolvent)
target_include_directories(
  evolvent_kernel_shared
  INTERFACE "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>"
)
target_include_directories(evolvent_library INTERFACE "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")
install(
  TARGETS evolvent_library
  LIBRARY DESTINATION "${evolvent_library_dir}" COMPONENT program NAMELINK_SKIP
)
if(NOT SKBUILD)
  set(evolvent_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/evolvent")
  install(
    TARGETS evolvent_library evolvent_kernel_shared
    EXPORT evolvent
    LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT library
  )
  install(
    DIRECTORY driver/library/include/evolvent src/include/evolvent
    DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
    COMPONENT library
  )
  install(
    EXPORT evolvent
    FILE evolventTargets.cmake
    NAMESPACE evolvent::
    DESTINATION "${evolvent_package_dir}"
    COMPONENT library
  )
  configure_package_config_file(
    cmake/evolventConfig.cmake.in
    generated/evolventConfig.cmake
    INSTALL_DESTINATION "${evolvent_package_dir}"
  )
  write_basic_package_version_file(
    "${PROJECT_BINARY_DIR}/generated/evolventConfigVersion.cmake"
    COMPATIBILITY SameMinorVersion
  )
  install(
    FILES
      "${PROJECT_BINARY_DIR}/generated/evolventConfig.cmake"
      "${PROJECT_BINARY_DIR}/generated/evolventConfigVersion.cmake"
    DESTINATION "${evolvent_package_dir}"
    COMPONENT library
  )
  # Two modules: the library of cases, and the kernel.
  set(pkgconfig_names evolvent evolvent-kernel)
  set(
    pkgconfig_texts
    "Dynamics of spur gearboxes: cases, runs, analyses"
    "Dynamics of spur gearboxes: the mechanics alone"
  )
  file(RELATIVE_PATH to_prefix "${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig" "${CMAKE_INSTALL_PREFIX}")
  foreach(name text IN ZIP_LISTS pkgconfig_names pkgconfig_texts)
    string(REPLACE "evolvent-kernel" "evolvent_kernel" link "${name}")
    configure_file(cmake/evolvent.pc.in generated/${name}.pc @ONLY)
    install(
      FILES "${PROJECT_BINARY_DIR}/generated/${name}.pc"
      DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig"
      COMPONENT library
    )
  endforeach()
endif()
