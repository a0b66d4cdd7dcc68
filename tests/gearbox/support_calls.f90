!> A support with a moving reference position, for the tests: the kernel's table has none yet.
module support_calls
   use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_ptr
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: wp
   use evl_parameter_view, only: parameter_view_t
   use evl_row, only: kind_t
   use evl_support, only: axle_motion, support_kind_t, support_t
   implicit none (type, external)
   private

   public :: support_shake

   !> Support on a carrier with harmonic motion.
   type, extends(support_kind_t) :: shaken_support
      real(wp) :: amplitude(2) = 0.0_wp !! [m]
      real(wp) :: w = 0.0_wp            !! [rad/s]
   contains
      procedure :: describe
      procedure :: take
      procedure :: reference
   end type shaken_support

contains

   !> Move the carriers of all axes: amplitude sin(w t) about their rest positions, in the housing frame.
   subroutine support_shake(handle, amplitude, w) bind(c)
      type(c_ptr), intent(in), value :: handle
      real(c_double), intent(in) :: amplitude(2)
      real(c_double), intent(in), value :: w
      type(gearbox_t), pointer :: gearbox
      integer :: i

      call c_f_pointer(handle, gearbox)
      do i = 1, size(gearbox%wheels)
         deallocate (gearbox%wheels(i)%support%kind)
         allocate (gearbox%wheels(i)%support%kind, source=shaken_support(amplitude, w))
      end do
      gearbox%wheels%support%moves = .true.
      gearbox%housing%acts = .true.
   end subroutine support_shake

   pure subroutine describe(self, info)
      class(shaken_support), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "shaken"
   end subroutine describe

   !> No effect: it replaces a support that has its parameters.
   subroutine take(self, input, support)
      class(shaken_support), intent(inout) :: self
      type(parameter_view_t), intent(in) :: input
      type(support_t), intent(inout) :: support
   end subroutine take

   pure type(axle_motion) function reference(self, centre, t) result(motion)
      class(shaken_support), intent(in) :: self
      real(wp), intent(in) :: centre(2), t

      motion%centre = centre + self%amplitude*sin(self%w*t)
      motion%velocity = self%amplitude*self%w*cos(self%w*t)
      motion%acceleration = -self%amplitude*self%w**2*sin(self%w*t)
   end function reference

end module support_calls
