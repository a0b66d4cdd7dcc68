!> Kinds and constants of the whole kernel.
module evl_kinds
   use, intrinsic :: iso_fortran_env, only: int64, real64
   implicit none (type, external)
   private

   public :: lanes, nan, pi, wp

   integer, parameter :: wp = real64                             !! working precision: IEEE double
   real(wp), parameter :: pi = 3.14159265358979323846264338328_wp !! circle constant
   real(wp), parameter :: nan = transfer(int(z"7FF8000000000000", int64), 1.0_wp) !! unknown or undefined value
   integer, parameter :: lanes = 8                               !! number of states that procedures in lanes process at once

end module evl_kinds
