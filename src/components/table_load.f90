!> A torque over time from a table.
module evl_table_load
   use evl_kinds, only: wp
   use evl_knots, only: knot_values, knots_t
   use evl_load, only: load_t
   use evl_parameter_view, only: parameter_view_t
   use evl_row, only: kind_t, parameter_row, span_t, type_at_knots, type_knots
   implicit none (type, external)
   private

   public :: table_load

   type, extends(load_t) :: table_load
   contains
      procedure :: describe
      procedure :: take
      procedure :: evaluate
   end type table_load

contains

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

   subroutine take(self, input)
      class(table_load), intent(inout) :: self
      type(parameter_view_t), intent(in) :: input

      self%knots = knots_t(input%numbers("time"), input%numbers("torque"))
      self%sense = "torque"
   end subroutine take

   pure subroutine evaluate(self, n, t, omega, angle, revolutions, segment, torque, damping, stiffness)
      class(table_load), intent(in) :: self
      integer, intent(in) :: n, segment
      real(wp), intent(in) :: t(n), omega(n), angle(n), revolutions
      real(wp), intent(out) :: torque(n)
      real(wp), intent(inout), optional :: damping(n), stiffness(n)

      call knot_values(self%knots, n, t, segment, torque)
   end subroutine evaluate

end module evl_table_load
