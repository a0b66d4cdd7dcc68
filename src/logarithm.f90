!> The natural logarithm in plain arithmetic, for loops that become vector instructions.
module evl_logarithm
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: natural_logarithm

contains

   include "formulas/logarithm.inc"

end module evl_logarithm
