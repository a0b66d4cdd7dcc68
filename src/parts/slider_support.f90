!> An axle that moves in one direction, on a spring and a damper.
module evl_slider_support
   use evl_kinds, only: pi, wp
   use evl_parameter, only: given_number, kind_info_t, parameter_row
   use evl_support, only: support_input, support_kind_t, support_t
   implicit none (type, external)
   private

   public :: slider_support

   type, extends(support_kind_t) :: slider_support
   contains
      procedure, nopass :: describe
      procedure :: take
   end type slider_support

contains

   pure type(kind_info_t) function describe() result(info)

      info%name = "slider"
      info%description = "slider: moves in one direction"
      info%n_parameters = 4
      info%parameters(1) = parameter_row("direction", "deg", "angle of the direction to the x axis", default_value=0.0_wp, &
                                         minimum=-360.0_wp, maximum=360.0_wp)
      info%parameters(2) = parameter_row("mass", "kg", "mass that moves with the axle, beside the wheel's own", &
                                         default_value=0.0_wp, minimum=0.0_wp)
      info%parameters(3) = parameter_row("stiffness", "N/m", "stiffness of the spring", minimum=0.0_wp)
      info%parameters(4) = parameter_row("damping", "N s/m", "coefficient of the damper", default_value=0.0_wp, minimum=0.0_wp)
   end function describe

   subroutine take(self, given, support)
      class(slider_support), intent(inout) :: self
      type(support_input), intent(in) :: given
      type(support_t), intent(inout) :: support

      support%n = 1
      associate (direction => given_number(given, 1)*(pi/180))
         support%direction(:, 1) = [cos(direction), sin(direction)]
      end associate
      support%mass = support%mass + given_number(given, 2)
      support%stiffness(1) = given_number(given, 3)
      support%damping(1) = given_number(given, 4)
   end subroutine take

end module evl_slider_support
