!> An axle that moves in one direction, on a spring and a damper.
module evl_slider_support
   use evl_kinds, only: wp
   use evl_parameter_view, only: parameter_view_t
   use evl_row, only: between, kind_t, not_negative, parameter_row, span_t
   use evl_support, only: support_kind_t, support_t
   implicit none (type, external)
   private

   public :: slider_support

   type, extends(support_kind_t) :: slider_support
   contains
      procedure :: describe
      procedure :: take
   end type slider_support

contains

   pure subroutine describe(self, info)
      class(slider_support), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "slider"
      info%text = "slider: moves in one direction"
      allocate (info%rows, &
                source=[parameter_row("direction", "deg", "angle of the direction of motion to the x axis", &
                                      range=between(-360.0_wp, 360.0_wp), &
                                      default="0", &
                                      plausible=span_t(0.0_wp, 360.0_wp)), &
                        parameter_row("mass", "kg", "mass that moves with the axle, in addition to the wheel's own", &
                                      range=not_negative, &
                                      default="0", &
                                      plausible=span_t(1.0e-7_wp, 1.0e4_wp)), &
                        parameter_row("stiffness", "N/m", "stiffness of the spring", range=not_negative, &
                                      plausible=span_t(1.0_wp, 1.0e12_wp)), &
                        parameter_row("damping", "N s/m", "coefficient of the damper", range=not_negative, default="0", &
                                      plausible=span_t(1.0e-3_wp, 1.0e9_wp))])
   end subroutine describe

   subroutine take(self, input, support)
      class(slider_support), intent(inout) :: self
      type(parameter_view_t), intent(in) :: input
      type(support_t), intent(inout) :: support

      support%n = 1
      associate (direction => input%number("direction"))
         support%direction(:, 1) = [cos(direction), sin(direction)]
      end associate
      support%mass = support%mass + input%number("mass")
      support%stiffness(1) = input%number("stiffness")
      support%damping(1) = input%number("damping")
   end subroutine take

end module evl_slider_support
