!> Exact fractions: speed ratios of trains, and pitches per revolution.
module evl_rational
   use, intrinsic :: iso_fortran_env, only: int32, int64
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: divisor_of, rational_parts, rational_pitches, rational_t, rational_scaled, rational_value, operator(==)

   integer, parameter :: int128 = selected_int_kind(38)
   integer(int64), parameter :: largest = 2_int64**61           !! limit of numerator and denominator, so that twice of it fits
   integer(int64), parameter :: short = int(huge(1_int32), int64) !! limit for which the product with any number of turns fits

   !> above/below in lowest terms.
   type :: rational_t
      integer(int64) :: above = 0_int64
      integer(int64) :: below = 1_int64 !! > 0
   end type rational_t

   interface operator(==)
      module procedure are_equal
   end interface operator(==)

contains

   pure logical function are_equal(a, b)
      type(rational_t), intent(in) :: a, b

      are_equal = a%above == b%above .and. a%below == b%below
   end function are_equal

   !> r factor/divisor in lowest terms.
   pure subroutine rational_scaled(r, factor, divisor, scaled, fits)
      type(rational_t), intent(in) :: r
      integer, intent(in) :: factor             !! of either sign, not 0
      integer, intent(in) :: divisor            !! > 0
      type(rational_t), intent(out) :: scaled   !! undefined if it does not fit
      logical, intent(out) :: fits              !! its numbers are less than 2**61, and it is less than 2**31
      integer(int64) :: shared, above, below, multiplier, denominator

      shared = divisor_of(int(factor, int64), int(divisor, int64))
      multiplier = factor/shared
      denominator = divisor/shared
      shared = divisor_of(r%above, denominator)
      above = r%above/shared
      denominator = denominator/shared
      shared = divisor_of(multiplier, r%below)
      multiplier = multiplier/shared
      below = r%below/shared
      fits = abs(above) <= largest/abs(multiplier) .and. below <= largest/denominator
      if (.not. fits) return
      scaled%above = above*multiplier
      scaled%below = below*denominator
      fits = abs(scaled%above/scaled%below) < short
   end subroutine rational_scaled

   !> Greatest common divisor, > 0.
   pure integer(int64) function divisor_of(a, b) result(divisor)
      integer(int64), intent(in) :: a, b !! not both 0
      integer(int64) :: rest, next

      divisor = abs(a)
      rest = abs(b)
      do while (rest /= 0)
         next = mod(divisor, rest)
         divisor = rest
         rest = next
      end do
   end function divisor_of

   pure real(wp) function rational_value(r) result(value)
      type(rational_t), intent(in) :: r

      value = real(r%above, wp)/real(r%below, wp)
   end function rational_value

   !> r turns - teeth: integers cancel before they are rounded, so that the relative precision does not depend on their size.
   !> Equation TR3.
   pure real(wp) function rational_pitches(r, turns, teeth) result(pitches)
      type(rational_t), intent(in) :: r       !! pitches per turn
      integer, intent(in) :: turns, teeth
      integer(int64) :: whole, rest

      if (turns == 0) then
         pitches = -real(teeth, wp)
         return
      end if
      call split(r, turns, whole, rest)
      pitches = real(whole - teeth, wp)
      if (rest /= 0) pitches = pitches + real(rest, wp)/real(r%below, wp)
   end function rational_pitches

   !> r n = whole + part with |part| < 1: the precision does not depend on its size.
   pure subroutine rational_parts(r, n, whole, part)
      type(rational_t), intent(in) :: r
      integer, intent(in) :: n
      real(wp), intent(out) :: whole !! an integer
      real(wp), intent(out) :: part
      integer(int64) :: all, rest

      call split(r, n, all, rest)
      whole = real(all, wp)
      part = real(rest, wp)/real(r%below, wp)
   end subroutine rational_parts

   !> r n = whole + rest/below.
   pure subroutine split(r, n, whole, rest)
      type(rational_t), intent(in) :: r
      integer, intent(in) :: n
      integer(int64), intent(out) :: whole, rest

      if (abs(r%above) <= short) then
         whole = r%above*n/r%below
         rest = r%above*n - whole*r%below
      else
         call split_large(r, n, whole, rest)
      end if
   end subroutine split

   !> `split` if the product of the numerator and n needs more than 64 bits.
   pure subroutine split_large(r, n, whole, rest)
      type(rational_t), intent(in) :: r
      integer, intent(in) :: n
      integer(int64), intent(out) :: whole, rest
      integer(int128) :: product

      product = int(r%above, int128)*n
      whole = int(product/r%below, int64)
      rest = int(mod(product, int(r%below, int128)), int64)
   end subroutine split_large

end module evl_rational
