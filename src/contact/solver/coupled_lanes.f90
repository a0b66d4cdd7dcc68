!> Coupled tooth pairs in eight states at once; evl_coupled_pairs is the version for one state.
module evl_coupled_lanes
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_compliant_johnson, only: compliant_contact, largest_excess, smallest
   use evl_coupled_pairs, only: coupled_solution, most_pairs, near_end, solve_pairs
   use evl_kinds, only: lanes, pi, wp
   use evl_status, only: code_ok, code_out_of_domain
   implicit none (type, external)
   private

   public :: overlap_in_lanes, solve_in_lanes

   integer, parameter :: width = lanes !! states evaluated at once by the included formulas

contains

   include "contact/solver/coupled_contact_newton.inc"

   !> `solve_pairs` with forces continued as odd functions.
   pure subroutine solve_in_lanes(n, h, length, c, e_star, force, is_defined)
      integer, intent(in) :: n
      real(wp), intent(in), dimension(lanes, n) :: h, length
      real(wp), intent(in) :: c(lanes, most_pairs, most_pairs), e_star
      real(wp), intent(out) :: force(lanes, most_pairs)
      logical, intent(out) :: is_defined !! false if one of the states has no solution
      real(wp) :: factor(lanes, most_pairs, most_pairs), found(lanes)
      type(coupled_solution) :: solution
      integer :: code, l

      is_defined = .true.
      call push_together(n, h, length, c, e_star, force, factor, found)
      if (all(found > 0)) return
      do l = 1, lanes
         if (found(l) > 0) cycle
         call solve_pairs(n, h(l, :), length(l, :), c(l, :, :), e_star, .false., solution, code)
         is_defined = is_defined .and. code == code_ok
         force(l, :n) = solution%force(:n)
      end do
   end subroutine solve_in_lanes

   !> Overlap of pair k: its penetration less the gap opened by the other pairs.
   pure subroutine overlap_in_lanes(n, k, h, c, force, overlap)
      integer, intent(in) :: n, k
      real(wp), intent(in) :: h(lanes), c(lanes, most_pairs, *), force(lanes, most_pairs)
      real(wp), intent(out) :: overlap(lanes)

      call find_others(n, c, k, force, overlap)
      overlap = h + overlap
   end subroutine overlap_in_lanes

end module evl_coupled_lanes
