!> Elementary functions in plain arithmetic, for vectorised loops.
!>
!> Unlike those of the C library they are bitwise identical on every machine.
module evl_elementary
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: exponential, hyperbolic_tangent, natural_logarithm, real_power, sine_cosine

contains

   include "numerics/logarithm_terms.inc"
   include "numerics/logarithm.inc"
   include "numerics/exponential_parts.inc"
   include "numerics/exponential.inc"
   include "numerics/hyperbolic_tangent.inc"
   include "numerics/power.inc"
   include "numerics/sine_cosine.inc"

end module evl_elementary
