!> Random numbers that are the same on every machine: the generator SplitMix64.
!>
!> Its arithmetic is modulo 2**64. Fortran integers are signed and must not overflow, so sums and products are formed from parts
!> that fit.
!>
!> Source: G. L. Steele, D. Lea, C. H. Flood, Fast splittable pseudorandom number generators, OOPSLA 2014, with the constants of
!> S. Vigna's splitmix64.c.
module evl_splitmix64
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: splitmix64_next, splitmix64_uniform

   integer(int64), parameter :: low_32 = int(z"FFFFFFFF", int64), low_16 = int(z"FFFF", int64)
   ! the upper half of a constant, then its lower half
   integer(int64), parameter :: increment = ior(shiftl(int(z"9E3779B9", int64), 32), int(z"7F4A7C15", int64))
   integer(int64), parameter :: first_factor = ior(shiftl(int(z"BF58476D", int64), 32), int(z"1CE4E5B9", int64))
   integer(int64), parameter :: second_factor = ior(shiftl(int(z"94D049BB", int64), 32), int(z"133111EB", int64))

contains

   !> Advance the state and give its 64 random bits.
   pure subroutine splitmix64_next(state, bits)
      integer(int64), intent(inout) :: state !! the seed at first
      integer(int64), intent(out) :: bits

      state = add(state, increment)
      bits = state
      bits = multiply(ieor(bits, shiftr(bits, 30)), first_factor)
      bits = multiply(ieor(bits, shiftr(bits, 27)), second_factor)
      bits = ieor(bits, shiftr(bits, 31))
   end subroutine splitmix64_next

   !> Advance the state and give a multiple of 2**-53, 0 <= value < 1.
   pure subroutine splitmix64_uniform(state, value)
      integer(int64), intent(inout) :: state
      real(wp), intent(out) :: value
      integer(int64) :: bits

      call splitmix64_next(state, bits)
      value = real(shiftr(bits, 11), wp)*2.0_wp**(-53)
   end subroutine splitmix64_uniform

   !> a + b modulo 2**64.
   pure integer(int64) function add(a, b)
      integer(int64), intent(in) :: a, b
      integer(int64) :: low, high

      low = iand(a, low_32) + iand(b, low_32)
      high = shiftr(a, 32) + shiftr(b, 32) + shiftr(low, 32)
      add = ior(shiftl(high, 32), iand(low, low_32))
   end function add

   !> a b modulo 2**64: 16 bits of b at a time, so that each product of parts has at most 48 bits.
   pure integer(int64) function multiply(a, b)
      integer(int64), intent(in) :: a, b
      integer(int64) :: part, product
      integer :: i

      multiply = 0
      do i = 0, 48, 16
         part = iand(shiftr(b, i), low_16)
         product = add(iand(a, low_32)*part, shiftl(shiftr(a, 32)*part, 32))
         multiply = add(multiply, shiftl(product, i))
      end do
   end function multiply

end module evl_splitmix64
