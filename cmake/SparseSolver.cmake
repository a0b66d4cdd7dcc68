# SUNDIALS' solver KLU for the sparse matrices of long trains, if available: SUNDIALS may have been built without it, or with a
# KLU whose own files are missing. Archives are preferred: few runs need KLU, and each shared library adds to the start time
# of the program.
include(CheckCSourceCompiles)

set(with_klu "without KLU")
set(klu_needs "") # dependencies of KLU's archives
if(EVOLVENT_KLU AND TARGET SUNDIALS::sunlinsolklu AND TARGET SUNDIALS::sunmatrixsparse)
  set(klu_files "")
  set(klu_folders "")
  if(TARGET SUNDIALS::KLU)
    get_target_property(klu_files SUNDIALS::KLU INTERFACE_LINK_LIBRARIES)
    get_target_property(klu_folders SUNDIALS::KLU INTERFACE_INCLUDE_DIRECTORIES)
  endif()
  find_path(KLU_INCLUDE_DIR klu.h HINTS ${klu_folders} PATH_SUFFIXES suitesparse)
  find_library(KLU_LIBRARY klu)
  mark_as_advanced(KLU_INCLUDE_DIR KLU_LIBRARY)
  if(KLU_INCLUDE_DIR AND KLU_LIBRARY)
    set(with_klu "with KLU")
    set(klu_libraries SUNDIALS::sunlinsolklu SUNDIALS::sunmatrixsparse)
    string(REGEX REPLACE "\\.so(;|$)" ".a\\1" klu_archives "${klu_files}")
    set(has_archives ON)
    if(NOT klu_archives)
      set(has_archives OFF)
    endif()
    foreach(archive IN LISTS klu_archives)
      if(NOT (archive MATCHES "\\.a$" AND EXISTS "${archive}"))
        set(has_archives OFF)
      endif()
    endforeach()
    # From SuiteSparse 6 on its archives call OpenMP for the time.
    if(has_archives)
      set(CMAKE_REQUIRED_QUIET ON)
      foreach(needs IN ITEMS m gomp)
        set(CMAKE_REQUIRED_LIBRARIES ${klu_archives} ${needs} m)
        check_c_source_compiles(
          "char klu_factor(void); int main(void) { return klu_factor(); }"
          EVOLVENT_LINKS_STATIC_KLU_WITH_${needs}
        )
        if(EVOLVENT_LINKS_STATIC_KLU_WITH_${needs})
          set(klu_needs ${needs})
          break()
        endif()
      endforeach()
      unset(CMAKE_REQUIRED_LIBRARIES)
      unset(CMAKE_REQUIRED_QUIET)
    endif()
    if(klu_needs AND TARGET SUNDIALS::sunlinsolklu_static AND TARGET SUNDIALS::sunmatrixsparse_static)
      set(
        klu_libraries
        $<TARGET_FILE:SUNDIALS::sunlinsolklu_static>
        $<TARGET_FILE:SUNDIALS::sunmatrixsparse_static>
        ${klu_archives}
        ${klu_needs}
      )
    endif()
    target_link_libraries(evolvent_sundials INTERFACE ${klu_libraries})
    target_include_directories(evolvent_sundials SYSTEM INTERFACE "${KLU_INCLUDE_DIR}")
    target_compile_definitions(evolvent_sundials INTERFACE EVOLVENT_KLU)
  endif()
endif()
