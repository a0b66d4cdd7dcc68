# evolvent_options: compile options of every target of the project.
#
# No -ffast-math, and no implicit fused multiply-add (-ffp-contract=off): the same case gives the same bits with
# every option below.
set(CMAKE_C_STANDARD 11)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS OFF)
set(CMAKE_Fortran_PREPROCESS OFF) # no source needs it, and a build starts half as many processes

add_library(evolvent_options INTERFACE)
target_compile_definitions(evolvent_options INTERFACE $<$<COMPILE_LANGUAGE:C>:_POSIX_C_SOURCE=200809L>)

if(NOT CMAKE_Fortran_COMPILER_ID STREQUAL "GNU")
  message(
    FATAL_ERROR
    "evolvent is written for gfortran, found ${CMAKE_Fortran_COMPILER_ID}; "
    "choose it with -DCMAKE_Fortran_COMPILER=gfortran (Debian package gfortran)"
  )
endif()

target_compile_options(
  evolvent_options
  INTERFACE
    -ffp-contract=off
    # GCC 12 nevertheless fuses a product and a sum where it vectorises statements with alternating signs, as in
    # (n s + t c, t s - n c); vectorisation of loops stays on.
    $<$<COMPILE_LANGUAGE:Fortran>:-fno-tree-slp-vectorize>
    # No procedure of the shared kernel is replaced at load time, so it may be inlined as in the executable.
    -fno-semantic-interposition
    $<$<BOOL:${EVOLVENT_NATIVE}>:-march=native>
    $<$<BOOL:${EVOLVENT_MARCH}>:-march=${EVOLVENT_MARCH}>
    $<$<BOOL:${EVOLVENT_WERROR}>:-Werror>
    $<$<COMPILE_LANGUAGE:C>:-Wall$<SEMICOLON>-Wextra$<SEMICOLON>-Wpedantic$<SEMICOLON>-Wconversion>
    $<$<COMPILE_LANGUAGE:Fortran>:-Wall$<SEMICOLON>-Wextra$<SEMICOLON>-Wimplicit-interface>
    # -frecursive keeps local arrays on the stack, which makes every procedure thread-safe.
    $<$<COMPILE_LANGUAGE:Fortran>:-std=f2018$<SEMICOLON>-fimplicit-none$<SEMICOLON>-frecursive>
    # Honour `!$omp simd` before the short loops over lanes, which gfortran would unroll instead; no threads, no library.
    $<$<COMPILE_LANGUAGE:Fortran>:-fopenmp-simd>
    # No code relies on signals on overflow and the like, so both branches of a merge() may be computed, and none reads errno after
    # a square root: values stay the same. C needs these options too: link-time optimisation applies those of C to Fortran's loops.
    -fno-trapping-math
    -fno-math-errno
    $<$<AND:$<COMPILE_LANGUAGE:Fortran>,$<CONFIG:Debug>>:-fcheck=all,no-array-temps$<SEMICOLON>-fbacktrace>
)

if(EVOLVENT_SANITIZE)
  set(sanitize -fsanitize=${EVOLVENT_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_compile_options(evolvent_options INTERFACE ${sanitize})
  # gfortran itself adds to the bounds of arrays that are not allocated, which may have any value, and our logarithm adds to the
  # bits of NaN.
  target_compile_options(
    evolvent_options
    INTERFACE $<$<COMPILE_LANGUAGE:Fortran>:-fno-sanitize=signed-integer-overflow>
  )
  if(CMAKE_C_COMPILER_ID STREQUAL "Clang")
    # A program has one run-time library of the sanitizers, that of clang. gfortran's objects call the same functions.
    target_compile_definitions(evolvent_options INTERFACE $<$<COMPILE_LANGUAGE:C>:__SANITIZE_ADDRESS__>)
    target_link_options(evolvent_options INTERFACE $<$<LINK_LANGUAGE:C>:${sanitize}>)
  else()
    target_link_options(evolvent_options INTERFACE ${sanitize})
  endif()
endif()

# Link-time optimisation compares C and Fortran, so it also detects a C declaration that differs from its Fortran procedure.
if(EVOLVENT_LTO AND NOT EVOLVENT_SANITIZE AND NOT CMAKE_BUILD_TYPE STREQUAL "Debug")
  include(CheckIPOSupported)
  check_ipo_supported(RESULT has_lto OUTPUT lto_output LANGUAGES C Fortran)
  if(has_lto)
    set(CMAKE_INTERPROCEDURAL_OPTIMIZATION ON)
    target_link_options(evolvent_options INTERFACE -Wlto-type-mismatch $<$<BOOL:${EVOLVENT_WERROR}>:-Werror>)
  else()
    message(STATUS "No link-time optimisation: the compilers do not support it together")
  endif()
endif()
