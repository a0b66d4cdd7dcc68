!> Makes a support from what a case says of it, by its kind.
module evl_support_build
   use evl_given, only: given_t
   use evl_kind_finder, only: kind_finder
   use evl_kinds, only: wp
   use evl_status, only: code_invalid_input, fail, status_t, subject_wheel
   use evl_support, only: support_kind_t, support_t
   use evl_support_kinds, only: support_of_kind
   implicit none (type, external)
   private

   public :: support_build

contains

   !> Degrees of freedom, springs and dampers. Errors: code_invalid_input if there is no such kind.
   subroutine support_build(given, wheel, wheel_mass, support, status)
      type(given_t), intent(in) :: given
      integer, intent(in) :: wheel         !! from 1, for the message
      real(wp), intent(in) :: wheel_mass   !! [kg]
      type(support_t), intent(out) :: support
      type(status_t), intent(inout) :: status
      class(support_kind_t), allocatable :: kind
      type(kind_finder) :: finder

      finder%name = given%word("kind")
      call support_of_kind(finder, kind)
      if (.not. allocated(kind)) then
         call fail(status, code_invalid_input, "there is no such kind of support", subject_wheel, wheel, "support.kind")
         return
      end if
      support%mass = wheel_mass
      call kind%take(given, support)
      support%per_mass = 1/support%mass
      call move_alloc(kind, support%kind)
   end subroutine support_build

end module evl_support_build
