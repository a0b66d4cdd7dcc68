!> Frictionless flanks.
module evl_no_friction
   use evl_force_law, only: yes
   use evl_friction_law, only: friction_law_t
   use evl_kinds, only: wp
   use evl_row, only: kind_t
   implicit none (type, external)
   private

   public :: no_friction_t

   type, extends(friction_law_t) :: no_friction_t
   contains
      procedure :: describe
      procedure, nopass :: is_none => yes
      procedure :: evaluate
   end type no_friction_t

contains

   !> Its name.
   pure subroutine describe(self, info)
      class(no_friction_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "none"
      info%text = "smooth flanks"
   end subroutine describe

   !> Zero.
   pure subroutine evaluate(self, n, branch, v_t, phi, d_v)
      class(no_friction_t), intent(in) :: self
      integer, intent(in) :: n, branch
      real(wp), intent(in) :: v_t(n)
      real(wp), intent(out) :: phi(n)
      real(wp), intent(inout), optional :: d_v(n)

      phi = 0
   end subroutine evaluate

end module evl_no_friction
