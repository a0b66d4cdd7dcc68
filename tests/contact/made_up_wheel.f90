!> Synthetic compliant wheel for the tests: smooth functions with a few parameters instead of finite elements.
module made_up_wheel
   use evl_deviating_flanks, only: flank_value
   use evl_flank_deviation, only: flank_slope
   use evl_kinds, only: lanes, wp
   use evl_static_mesh, only: pair_flanks_t
   use evl_wheel_compliance, only: coupling_at_t, own_at_t, wheel_compliance_t
   implicit none (type, external)
   private

   public :: made_up_t, n_numbers, relieved_t

   integer, parameter :: n_numbers = 8

   !> With u = rho/scale: c = p1 + p2 u + p3 exp(u), c_j = p4 exp(-p5 j) (1 + p6 u + p7 u' + p8 u u' + p7 u**2).
   type, extends(wheel_compliance_t) :: made_up_t
      real(wp) :: scale = 1.0_wp
      real(wp) :: p(n_numbers) = 0.0_wp
   contains
      procedure :: own => own_tooth
      procedure :: own_lanes => own_in_lanes
      procedure :: coupling => other_tooth
      procedure :: coupling_lanes => other_in_lanes
   end type made_up_t

   !> Flanks with a parabola of the profile, p1 + p2 s + p3 s**2, s = rho less the end of the flank, and p4 + p5 s for each tooth
   !> pair k times cos k.
   type, extends(pair_flanks_t) :: relieved_t
      real(wp) :: ends(2) = 0.0_wp
      real(wp) :: p(5, 2) = 0.0_wp
   contains
      procedure :: at => relieved
   end type relieved_t

contains

   !> c
   pure subroutine own_tooth(self, rho, at)
      class(made_up_t), intent(in) :: self
      real(wp), intent(in) :: rho
      type(own_at_t), intent(out) :: at
      real(wp) :: u

      u = rho/self%scale
      at%value = self%p(1) + self%p(2)*u + self%p(3)*exp(u)
      at%slope = (self%p(2) + self%p(3)*exp(u))/self%scale
      at%curvature = self%p(3)*exp(u)/self%scale**2
   end subroutine own_tooth

   !> c_j
   pure subroutine other_tooth(self, j, here, there, at)
      class(made_up_t), intent(in) :: self
      integer, intent(in) :: j
      real(wp), intent(in) :: here, there
      type(coupling_at_t), intent(out) :: at
      real(wp) :: u, v, far

      u = here/self%scale
      v = there/self%scale
      associate (p => self%p, s => self%scale)
         far = p(4)*exp(-p(5)*j)
         at%value = far*(1 + p(6)*u + p(7)*(v + u**2) + p(8)*u*v)
         at%by_here = far*(p(6) + 2*p(7)*u + p(8)*v)/s
         at%by_there = far*(p(7) + p(8)*u)/s
         at%here_here = far*2*p(7)/s**2
         at%here_there = far*p(8)/s**2
      end associate
   end subroutine other_tooth

   !> c in eight states.
   pure subroutine own_in_lanes(self, rho, value, slope)
      class(made_up_t), intent(in) :: self
      real(wp), intent(in) :: rho(lanes)
      real(wp), intent(out) :: value(lanes), slope(lanes)
      type(own_at_t) :: at
      integer :: l

      do l = 1, lanes
         call self%own(rho(l), at)
         value(l) = at%value
         slope(l) = at%slope
      end do
   end subroutine own_in_lanes

   !> c_j in eight states.
   pure subroutine other_in_lanes(self, j, here, there, value, by_here, by_there)
      class(made_up_t), intent(in) :: self
      integer, intent(in) :: j
      real(wp), intent(in) :: here(lanes), there(lanes)
      real(wp), intent(out) :: value(lanes), by_here(lanes), by_there(lanes)
      type(coupling_at_t) :: at
      integer :: l

      do l = 1, lanes
         call self%coupling(j, here(l), there(l), at)
         value(l) = at%value
         by_here(l) = at%by_here
         by_there(l) = at%by_there
      end do
   end subroutine other_in_lanes

   !> Deviation of a flank.
   pure subroutine relieved(self, wheel, pair, rho, beyond, value, turn)
      class(relieved_t), intent(in) :: self
      integer, intent(in) :: wheel, pair
      real(wp), intent(in) :: rho
      logical, intent(in) :: beyond
      type(flank_value), intent(out) :: value
      type(flank_slope), intent(out) :: turn
      real(wp) :: s

      s = rho - self%ends(wheel)
      associate (p => self%p(:, wheel))
         value = flank_value((p(4) + p(5)*s)*cos(real(pair, wp)), p(5)*cos(real(pair, wp)), 0.0_wp)
         if (beyond) return
         value%e = value%e + p(1) + s*(p(2) + p(3)*s)
         value%de = value%de + p(2) + 2*p(3)*s
         value%d2e = 2*p(3)
      end associate
   end subroutine relieved

end module made_up_wheel
