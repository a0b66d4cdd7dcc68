# EVOLVENT_VARIANTS: the program loads the kernel for the processor on which it starts.
#
# The kernel is also compiled for newer processors, into glibc-hwcaps/PROCESSOR beside the generic kernel. The loader of glibc
# 2.33 and newer searches there first and loads the best one that the processor supports; other loaders use the generic one. All
# give the same bits.
include(CheckCompilerFlag)
include(CMakeDependentOption)

set(kernel_processors x86-64-v3 x86-64-v4) # AVX2, AVX-512
check_compiler_flag(Fortran -march=x86-64-v4 EVOLVENT_KNOWS_X86_64_V4)
cmake_dependent_option(
  EVOLVENT_VARIANTS
  "Compile the kernel for AVX2 and AVX-512 too; the fitting one is chosen at start"
  ON
  "EVOLVENT_KNOWS_X86_64_V4;CMAKE_SYSTEM_NAME STREQUAL Linux;CMAKE_SYSTEM_PROCESSOR STREQUAL x86_64;CMAKE_BUILD_TYPE STREQUAL Release;NOT EVOLVENT_NATIVE;NOT EVOLVENT_MARCH;NOT EVOLVENT_SANITIZE"
  OFF
)

# Without memory, a target ends the program evolvent with one line, whichever code requested the memory.
function(evolvent_end_without_memory target)
  if(CMAKE_SYSTEM_NAME STREQUAL "Linux" AND NOT EVOLVENT_SANITIZE)
    target_sources(${target} PRIVATE "${PROJECT_SOURCE_DIR}/driver/base/no_memory.c")
    target_link_options(${target} PRIVATE LINKER:--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=strdup)
  endif()
endfunction()

# The kernel as a shared library with the name that the loader searches for.
function(evolvent_shared_kernel target)
  set_target_properties(
    ${target}
    PROPERTIES OUTPUT_NAME evolvent_kernel LINKER_LANGUAGE Fortran SOVERSION 0
  )
  if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
    set(exported "${PROJECT_SOURCE_DIR}/cmake/exported.map")
    target_link_options(${target} PRIVATE "-Wl,--version-script=${exported}")
    set_property(TARGET ${target} APPEND PROPERTY LINK_DEPENDS "${exported}")
  endif()
  evolvent_end_without_memory(${target})
  target_link_libraries(${target} PRIVATE evolvent_options LAPACK::LAPACK)
endfunction()

# The kernel for each newer processor, from the same sources; the program depends on them.
function(evolvent_add_kernel_variants sources)
  foreach(processor IN LISTS kernel_processors)
    set(variant evolvent_kernel_${processor})
    add_library(${variant} SHARED ${sources})
    evolvent_shared_kernel(${variant})
    set_target_properties(
      ${variant}
      PROPERTIES
        Fortran_MODULE_DIRECTORY "${PROJECT_BINARY_DIR}/modules/${processor}"
        LIBRARY_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/glibc-hwcaps/${processor}"
    )
    target_include_directories(${variant} PRIVATE "${PROJECT_SOURCE_DIR}/src")
    target_compile_options(${variant} PRIVATE -march=${processor})
    add_dependencies(evolvent ${variant})
    install(
      TARGETS ${variant}
      LIBRARY DESTINATION "${evolvent_library_dir}/glibc-hwcaps/${processor}" COMPONENT program NAMELINK_SKIP
    )
  endforeach()
endfunction()

# Link the program itself to LAPACK, although only the kernel calls it. The loader searches a symbol in the libraries of the program
# first, then in their dependencies: it would find the many symbols of an OpenBLAS late, which costs 1 ms a start.
function(evolvent_name_lapack target)
  set(libraries ${LAPACK_LIBRARIES})
  list(FILTER libraries INCLUDE REGEX "\\.so$")
  if(libraries)
    list(JOIN libraries "," libraries)
    # The second adds the folder of LAPACK to the search path.
    target_link_libraries(
      ${target}
      PRIVATE "-Wl,--push-state,--no-as-needed,${libraries},--pop-state" LAPACK::LAPACK
    )
  endif()
endfunction()
