# Everything that affects the computed compliance of a wheel, so that a cache entry is valid only for the program that computed it.
file(
  GLOB compliance_sources
  CONFIGURE_DEPENDS
  src/compliance/*.f90
  src/geometry/*.f90
  src/numerics/*.f90
  src/*/*.inc
  src/*/*/*.inc
)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${compliance_sources})
set(
  all
  "${CMAKE_Fortran_COMPILER_ID} ${CMAKE_Fortran_COMPILER_VERSION} ${CMAKE_BUILD_TYPE} ${CMAKE_Fortran_FLAGS} ${LAPACK_LIBRARIES}"
)
foreach(source IN LISTS compliance_sources)
  file(SHA256 "${source}" hash)
  string(APPEND all " ${hash}")
endforeach()
string(SHA256 evolvent_compliance_sources "${all}")
string(SUBSTRING "${evolvent_compliance_sources}" 0 32 evolvent_compliance_sources)
configure_file(cmake/evolvent_compliance_sources.h.in generated/evolvent_compliance_sources.h @ONLY)
