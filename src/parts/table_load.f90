!> A torque over time from a table.
module evl_table_load
   use evl_given, only: given_t
   use evl_kinds, only: lanes, wp
   use evl_knots, only: knot_value, knots_t, varies_between
   use evl_load, only: lane_points, load_point, load_t
   use evl_row, only: kind_t, parameter_row, span_t, type_at_knots, type_knots
   implicit none (type, external)
   private

   public :: table_load

   type, extends(load_t) :: table_load
   contains
      procedure :: describe
      procedure :: take
      procedure :: ask
      procedure :: add_in_lanes
   end type table_load

contains

   include "parts/between_knots.inc"

   pure subroutine describe(self, info)
      class(table_load), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "table"
      info%text = "torque over time"
      allocate (info%rows, &
                source=[parameter_row("time", "s", "knots of the table, strictly increasing, at least two", type=type_knots, &
                                      plausible=span_t(0.0_wp, 1.0e5_wp)), &
                        parameter_row("torque", "N m", "torque at the knots; linear between them, constant outside", &
                                      type=type_at_knots, &
                                      plausible=span_t(0.0_wp, 1.0e7_wp))])
   end subroutine describe

   subroutine take(self, given)
      class(table_load), intent(inout) :: self
      type(given_t), intent(in) :: given

      self%knots = knots_t(given%numbers("time"), given%numbers("torque"))
      self%sense = "torque"
   end subroutine take

   pure subroutine ask(self, at, torque, damping, stiffness)
      class(table_load), intent(in) :: self
      type(load_point), intent(in) :: at
      real(wp), intent(out) :: torque, damping, stiffness

      torque = knot_value(self%knots, at%t, at%segment)
      damping = 0
      stiffness = 0
   end subroutine ask

   pure subroutine add_in_lanes(self, at, torque)
      class(table_load), intent(in) :: self
      type(lane_points), intent(in) :: at
      real(wp), intent(inout) :: torque(lanes)
      real(wp) :: t_1, t_2, value_1, value_2
      integer :: l

      if (.not. varies_between(self%knots, at%segment)) then
         torque = torque + knot_value(self%knots, at%t(1), at%segment)
         return
      end if
      t_1 = self%knots%time(at%segment)
      t_2 = self%knots%time(at%segment + 1)
      value_1 = self%knots%values(at%segment)
      value_2 = self%knots%values(at%segment + 1)
      !$omp simd
      do l = 1, lanes
         torque(l) = torque(l) + between_knots(at%t(l), t_1, t_2, value_1, value_2)
      end do
   end subroutine add_in_lanes

end module evl_table_load
