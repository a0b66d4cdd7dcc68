!> A load of a kind that no case has: a drag with a linear and a quadratic term.
!>
!>    M = -coefficient omega - quadratic omega |omega|
!>
!> The test library `kernel_drill` offers this kind: a kind of load is a file, with one formula, and a line in the table.
module evl_drill_load
   use evl_kinds, only: wp
   use evl_load, only: load_t
   use evl_parameter_view, only: parameter_view_t
   use evl_row, only: kind_t, not_negative, parameter_row
   implicit none (type, external)
   private

   public :: drill_load

   type, extends(load_t) :: drill_load
      real(wp) :: coefficient = 0.0_wp !! [N m s]
      real(wp) :: quadratic = 0.0_wp   !! [N m s^2]
   contains
      procedure :: describe
      procedure :: take
      procedure :: evaluate
   end type drill_load

contains

   pure subroutine describe(self, info)
      class(drill_load), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "drill"
      info%text = "drag with a linear and a quadratic term"
      allocate (info%rows, source=[parameter_row("coefficient", "N m s/rad", "linear term", range=not_negative), &
                                   parameter_row("quadratic", "N m s2/rad2", "quadratic term", range=not_negative)])
   end subroutine describe

   subroutine take(self, input)
      class(drill_load), intent(inout) :: self
      type(parameter_view_t), intent(in) :: input

      self%coefficient = input%number("coefficient")
      self%quadratic = input%number("quadratic")
      self%sense = "coefficient"
   end subroutine take

   pure subroutine evaluate(self, n, t, omega, angle, revolutions, segment, torque, damping, stiffness)
      class(drill_load), intent(in) :: self
      integer, intent(in) :: n, segment
      real(wp), intent(in) :: t(n), omega(n), angle(n), revolutions
      real(wp), intent(out) :: torque(n)
      real(wp), intent(inout), optional :: damping(n), stiffness(n)

      torque = -(self%coefficient + self%quadratic*abs(omega))*omega
      if (present(damping)) damping = self%coefficient + 2*self%quadratic*abs(omega)
   end subroutine evaluate

end module evl_drill_load
