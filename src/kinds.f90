!> Kinds and mathematical constants of the kernel.
module evl_kinds
   use, intrinsic :: iso_fortran_env, only: real64
   implicit none (type, external)
   private

   public :: wp, pi

   integer, parameter :: wp = real64                             !! working precision: IEEE double
   real(wp), parameter :: pi = 3.14159265358979323846264338328_wp !! circle constant

end module evl_kinds
