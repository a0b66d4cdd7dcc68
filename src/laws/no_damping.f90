!> No viscous force.
module evl_no_damping
   use evl_contact_context, only: contact_context, lane_context
   use evl_damping_law, only: damping_law_t, viscous_result
   use evl_force_law, only: yes
   use evl_kinds, only: lanes, wp
   use evl_row, only: kind_t
   implicit none (type, external)
   private

   public :: no_damping_t

   type, extends(damping_law_t) :: no_damping_t
   contains
      procedure :: describe
      procedure, nopass :: is_none => yes
      procedure :: force
      procedure :: force_lanes
   end type no_damping_t

contains

   !> Its name.
   pure subroutine describe(self, info)
      class(no_damping_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "none"
      info%text = "no viscous force"
   end subroutine describe

   !> Zero.
   pure subroutine force(self, ctx, elastic, result)
      class(no_damping_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      real(wp), intent(in) :: elastic
      type(viscous_result), intent(inout) :: result

      result%force = 0
   end subroutine force

   !> Zero in eight states.
   pure subroutine force_lanes(self, at, elastic, force)
      class(no_damping_t), intent(in) :: self
      type(lane_context), intent(in) :: at
      real(wp), intent(in) :: elastic(lanes)
      real(wp), intent(out) :: force(lanes)

      force = 0
   end subroutine force_lanes

end module evl_no_damping
