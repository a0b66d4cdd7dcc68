# libevolvent: the program's analyses for other programs, without HDF5, which would meet another one in their process.
#
# It takes from the driver what it needs, with answers of its own where the program writes files or ends itself: the linker looks
# into the archive only for what is not there yet.
file(GLOB library_sources CONFIGURE_DEPENDS driver/library/*.c)
add_library(evolvent_library SHARED ${library_sources} driver/files/history_memory.c)
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
