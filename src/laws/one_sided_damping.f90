!> F = c h h' on approach (h' > 0), 0 on separation.
!>
!> Kosenko's group writes it damp |kappa| |h'| with kappa = -h. It is extended to h < 0 with its sign, so that it is smooth
!> through the end of contact and, on each side, through h' = 0, where the side changes.
module evl_one_sided_damping
   use evl_damping_law, only: damping_law_t
   use evl_force_law, only: yes
   use evl_kinds, only: lanes, wp
   use evl_row, only: kind_t, not_negative, parameter_row, span_t
   implicit none (type, external)
   private

   public :: one_sided_damping_t

   type, extends(damping_law_t) :: one_sided_damping_t
   contains
      procedure :: describe
      procedure, nopass :: has_sides => yes
      procedure :: evaluate
   end type one_sided_damping_t

contains

   !> Name, source and parameter.
   pure subroutine describe(self, info)
      class(one_sided_damping_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "one_sided"
      info%text = "proportional to penetration and its rate on approach, zero on separation"
      info%source = "the Modelica library of Kosenko's group: damp |kappa| |h'|"
      info%rows = [parameter_row("coefficient", "N s/m2", "force per penetration and rate of penetration", range=not_negative, &
                                 plausible=span_t(1.0_wp, 1.0e15_wp))]
   end subroutine describe

   !> The force on one of its sides. Equation L10.
   pure subroutine evaluate(self, n, h, h_dot, elastic, v0, side, force, d_h, d_h_dot, d_elastic)
      class(one_sided_damping_t), intent(in) :: self
      integer, intent(in) :: n, side
      real(wp), intent(in) :: h(n), h_dot(n), elastic(n), v0
      real(wp), intent(out) :: force(n)
      real(wp), dimension(n), intent(inout), optional :: d_h, d_h_dot, d_elastic
      real(wp) :: coefficient, slope(lanes)
      integer :: i

      coefficient = self%parameters(1)
      !$omp simd
      do i = 1, n
         slope(i) = merge(1.0_wp, 0.0_wp, side > 0 .or. (side == 0 .and. h_dot(i) > 0))*coefficient
      end do
      force = slope(:n)*h*h_dot
      if (present(d_h)) d_h = slope(:n)*h_dot
      if (present(d_h_dot)) d_h_dot = slope(:n)*h
   end subroutine evaluate

end module evl_one_sided_damping
