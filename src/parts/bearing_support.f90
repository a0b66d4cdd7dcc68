!> An axle that moves in x and y, each on a spring and a damper.
module evl_bearing_support
   use evl_kinds, only: wp
   use evl_parameter, only: given_number, given_series, kind_info_t, parameter_row, shape_pair
   use evl_support, only: support_input, support_kind_t, support_t
   implicit none (type, external)
   private

   public :: bearing_support

   type, extends(support_kind_t) :: bearing_support
   contains
      procedure, nopass :: describe
      procedure :: take
   end type bearing_support

contains

   pure type(kind_info_t) function describe() result(info)

      info%name = "bearing"
      info%description = "bearing: moves in x and y"
      info%n_parameters = 3
      info%parameters(1) = parameter_row("mass", "kg", "mass that moves with the axle, beside the wheel's own", &
                                         default_value=0.0_wp, minimum=0.0_wp)
      info%parameters(2) = parameter_row("stiffness", "N/m", "stiffness in x and y", minimum=0.0_wp, shape=shape_pair)
      info%parameters(3) = parameter_row("damping", "N s/m", "damping in x and y", default_value=0.0_wp, minimum=0.0_wp, &
                                         shape=shape_pair)
   end function describe

   subroutine take(self, given, support)
      class(bearing_support), intent(inout) :: self
      type(support_input), intent(in) :: given
      type(support_t), intent(inout) :: support

      support%n = 2
      support%direction(:, 1) = [1, 0]
      support%direction(:, 2) = [0, 1]
      support%mass = support%mass + given_number(given, 1)
      support%stiffness = given_series(given, 2)
      support%damping = given_series(given, 3)
   end subroutine take

end module evl_bearing_support
