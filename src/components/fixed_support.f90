!> An axle that does not move.
module evl_fixed_support
   use evl_parameter_view, only: parameter_view_t
   use evl_row, only: kind_t
   use evl_support, only: support_kind_t, support_t
   implicit none (type, external)
   private

   public :: fixed_support

   type, extends(support_kind_t) :: fixed_support
   contains
      procedure :: describe
      procedure :: take
   end type fixed_support

contains

   pure subroutine describe(self, info)
      class(fixed_support), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "fixed"
      info%text = "fixed axle"
   end subroutine describe

   subroutine take(self, input, support)
      class(fixed_support), intent(inout) :: self
      type(parameter_view_t), intent(in) :: input
      type(support_t), intent(inout) :: support

      support%n = 0
   end subroutine take

end module evl_fixed_support
