!> Makes a support from its description, by the rows in which its kind describes itself.
module evl_support_build
   use evl_kinds, only: wp
   use evl_parameter_check, only: check_numbers, fill_defaults
   use evl_status, only: code_invalid_input, fail, status_t, subject_wheel
   use evl_support, only: support_input, support_kind_t, support_t
   use evl_support_kinds, only: support_of_kind
   implicit none (type, external)
   private

   public :: check_support, support_build

contains

   !> The kind exists, and its numbers are in their ranges.
   subroutine check_support(input, index, status)
      type(support_input), intent(in) :: input
      integer, intent(in) :: index !! of the wheel
      type(status_t), intent(inout) :: status
      class(support_kind_t), allocatable :: kind
      type(support_input) :: given

      call support_of_kind(input%kind, kind)
      if (.not. allocated(kind)) then
         call fail(status, code_invalid_input, "there is no such kind of support", subject_wheel, index, "support.kind")
         return
      end if
      given = input
      call fill_defaults(kind%describe(), given)
      call check_numbers(kind%describe(), given, subject_wheel, index, "support.", status)
   end subroutine check_support

   !> Degrees of freedom, springs and dampers of a support that passed the check.
   subroutine support_build(input, wheel_mass, support)
      type(support_input), intent(in) :: input
      real(wp), intent(in) :: wheel_mass !! [kg]
      type(support_t), intent(out) :: support
      class(support_kind_t), allocatable :: kind
      type(support_input) :: given

      call support_of_kind(input%kind, kind)
      given = input
      call fill_defaults(kind%describe(), given)
      support%mass = wheel_mass
      call kind%take(given, support)
      support%per_mass = 1/support%mass
      call move_alloc(kind, support%kind)
   end subroutine support_build

end module evl_support_build
