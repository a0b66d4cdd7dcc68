!> Zones of a wheel's flank, for the tests: a C call that the kernel does not export.
module zone_calls
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use evl_flank_deviation, only: flank_deviation_t, relief_t
   use evl_pair_point, only: tip_t
   use evl_zone_changes, only: change_zone
   implicit none (type, external)
   private

   public :: test_change_zone

contains

   !> Zone of a wheel's contact after it passed zone limits.
   integer(c_int) function test_change_zone(reliefs, takes_over, fired, zone) result(after) bind(c)
      integer(c_int), intent(in) :: reliefs(2)        !! of tip and root: 0 none, 1 without a corner, 2 with one
      real(c_double), intent(in), value :: takes_over !! x_*
      integer(c_int), intent(in) :: fired(6)          !! 1 if passed: both of the tip, both of the root, end, edge
      integer(c_int), intent(in), value :: zone
      type(flank_deviation_t) :: deviation
      type(tip_t) :: tip

      deviation%tip = relief_of(reliefs(1))
      deviation%root = relief_of(reliefs(2))
      tip%takes_over = takes_over
      after = zone
      call change_zone(deviation, tip, fired(1:2) == 1, fired(3:4) == 1, fired(5:6) == 1, after)
   end function test_change_zone

   pure type(relief_t) function relief_of(kind) result(relief)
      integer(c_int), intent(in) :: kind

      if (kind > 0) relief%amount = 1
      if (kind == 2) relief%taken = [0, 1]
   end function relief_of

end module zone_calls
