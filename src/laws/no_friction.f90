!> Smooth flanks.
module evl_no_friction
   use evl_force_law, only: yes
   use evl_friction_law, only: friction_law_t
   use evl_kinds, only: lanes, wp
   use evl_row, only: kind_t
   implicit none (type, external)
   private

   public :: no_friction_t

   type, extends(friction_law_t) :: no_friction_t
   contains
      procedure :: describe
      procedure, nopass :: is_none => yes
      procedure :: factor
      procedure :: factor_lanes
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
   pure subroutine factor(self, branch, v_t, phi, d_v)
      class(no_friction_t), intent(in) :: self
      integer, intent(in) :: branch
      real(wp), intent(in) :: v_t
      real(wp), intent(out) :: phi, d_v

      phi = 0
      d_v = 0
   end subroutine factor

   !> Zero in eight states.
   pure subroutine factor_lanes(self, branch, v_t, phi)
      class(no_friction_t), intent(in) :: self
      integer, intent(in) :: branch
      real(wp), intent(in) :: v_t(lanes)
      real(wp), intent(out) :: phi(lanes)

      phi = 0
   end subroutine factor_lanes

end module evl_no_friction
