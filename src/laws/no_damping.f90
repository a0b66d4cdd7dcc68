!> No viscous force.
module evl_no_damping
   use evl_damping_law, only: damping_law_t
   use evl_force_law, only: yes
   use evl_kinds, only: wp
   use evl_row, only: kind_t
   implicit none (type, external)
   private

   public :: no_damping_t

   type, extends(damping_law_t) :: no_damping_t
   contains
      procedure :: describe
      procedure, nopass :: is_none => yes
      procedure :: evaluate
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
   pure subroutine evaluate(self, n, h, h_dot, elastic, v0, side, force, d_h, d_h_dot, d_elastic)
      class(no_damping_t), intent(in) :: self
      integer, intent(in) :: n, side
      real(wp), intent(in) :: h(n), h_dot(n), elastic(n), v0
      real(wp), intent(out) :: force(n)
      real(wp), dimension(n), intent(inout), optional :: d_h, d_h_dot, d_elastic

      force = 0
   end subroutine evaluate

end module evl_no_damping
