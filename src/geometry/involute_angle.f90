!> The involute function inv alpha = tan alpha - alpha and its inverse.
!>
!> Both work with u = tan alpha, which is the radius of curvature over the base radius: inv alpha = u - atan u.
!>
!> Source: ISO 21771, involute function.
module evl_involute_angle
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: involute_of_tangent, tangent_of_involute

   real(wp), parameter :: small = 0.5_wp !! below this u - atan u would cancel, and the series converges
   integer, parameter :: n_terms = 26    !! small**(2 n_terms) is the rounding of the first term

contains

   !> inv alpha [rad] from u = tan alpha. Relative error: a few units in the last place.   Valid: u >= 0
   elemental real(wp) function involute_of_tangent(u) result(involute)
      real(wp), intent(in) :: u !! tan alpha
      real(wp) :: sum
      integer :: k

      if (u > small) then
         involute = u - atan(u)
         return
      end if
      sum = 0.0_wp
      do k = n_terms, 1, -1
         sum = 1.0_wp/(2*k + 1) - u**2*sum
      end do
      involute = u**3*sum
   end function involute_of_tangent

   !> tan alpha from inv alpha [rad], the inverse of `involute_of_tangent`.   Valid: involute >= 0
   !> Equation G9.
   !>
   !> u - atan u is convex and less than u**3/3 and than u. Newton's first step, from below the root, therefore leads above
   !> it; each further step comes closer, until rounding ends the iteration.
   elemental real(wp) function tangent_of_involute(involute) result(u)
      real(wp), intent(in) :: involute !! inv alpha [rad]
      integer, parameter :: most_turns = 60
      real(wp) :: next
      integer :: turn

      u = max((3.0_wp*involute)**(1.0_wp/3.0_wp), involute)
      if (.not. u > 0.0_wp) return
      do turn = 1, most_turns
         next = u - (involute_of_tangent(u) - involute)*(1.0_wp + u**2)/u**2
         if (turn > 1 .and. next >= u) exit
         u = next
      end do
   end function tangent_of_involute

end module evl_involute_angle
