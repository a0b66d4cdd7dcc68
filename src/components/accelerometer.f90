!> Accelerometer: a point of the housing, and a direction in it along which the acceleration is recorded.
module evl_accelerometer
   use evl_kinds, only: wp
   use evl_parameter_view, only: parameter_view_t
   use evl_row, only: row_t, span_t, type_name, type_triple
   implicit none (type, external)
   private

   public :: accelerometer_t, accelerometer_take

   type :: accelerometer_t
      real(wp) :: point(3) = 0.0_wp     !! housing frame [m]
      real(wp) :: direction(3) = 0.0_wp !! unit vector in the housing frame
   end type accelerometer_t

   ! parameters of an accelerometer
   type(row_t), parameter, public :: accelerometer_rows(*) = [ &
                                     row_t("name", type_name, "", "name in paths and the history", required=.true.), &
                                     row_t("point", type_triple, "m", "position, housing frame", required=.true., &
                                           plausible=span_t(0.0_wp, 20.0_wp)), &
                                     row_t("direction", type_triple, "", &
                                           "direction of sensitivity, of nonzero length, housing frame", required=.true.)]

contains

   !> Set from checked parameters; a direction of length 0 remains 0.
   subroutine accelerometer_take(input, accelerometer)
      type(parameter_view_t), intent(in) :: input
      type(accelerometer_t), intent(out) :: accelerometer
      real(wp) :: largest

      accelerometer%point = input%numbers("point")
      accelerometer%direction = input%numbers("direction")
      largest = maxval(abs(accelerometer%direction)) ! its square may overflow, or vanish
      if (.not. largest > 0) return
      accelerometer%direction = accelerometer%direction/largest
      accelerometer%direction = accelerometer%direction/norm2(accelerometer%direction)
   end subroutine accelerometer_take

end module evl_accelerometer
