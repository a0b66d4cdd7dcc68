!> An axle that moves in x and y, each on a spring and a damper.
module evl_bearing_support
   use evl_kinds, only: wp
   use evl_parameter_view, only: parameter_view_t
   use evl_row, only: kind_t, not_negative, parameter_row, span_t, type_pair
   use evl_support, only: support_kind_t, support_t
   implicit none (type, external)
   private

   public :: bearing_support

   type, extends(support_kind_t) :: bearing_support
   contains
      procedure :: describe
      procedure :: take
   end type bearing_support

contains

   pure subroutine describe(self, info)
      class(bearing_support), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "bearing"
      info%text = "bearing: moves in x and y"
      allocate (info%rows, &
                source=[parameter_row("mass", "kg", "mass that moves with the axle, in addition to the" &
                                      //" wheel's own", range=not_negative, &
                                      default="0", &
                                      plausible=span_t(1.0e-7_wp, 1.0e4_wp)), &
                        parameter_row("stiffness", "N/m", "stiffness in x and y", range=not_negative, type=type_pair, &
                                      plausible=span_t(1.0_wp, 1.0e12_wp)), &
                        parameter_row("damping", "N s/m", "damping in x and y", range=not_negative, default="[0, 0]", &
                                      type=type_pair, &
                                      plausible=span_t(1.0e-3_wp, 1.0e9_wp))])
   end subroutine describe

   subroutine take(self, input, support)
      class(bearing_support), intent(inout) :: self
      type(parameter_view_t), intent(in) :: input
      type(support_t), intent(inout) :: support

      support%n = 2
      support%direction(:, 1) = [1, 0]
      support%direction(:, 2) = [0, 1]
      support%mass = support%mass + input%number("mass")
      support%stiffness = input%numbers("stiffness")
      support%damping = input%numbers("damping")
   end subroutine take

end module evl_bearing_support
