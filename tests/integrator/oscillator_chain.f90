!> Masses on a line with springs that harden and dampers, lane-wise: what the integrator costs, and whether it allocates.
!>
!> u_i'' = s(u_(i+1) - u_i) - s(u_i - u_(i-1)) + d (u_(i+1)' - 2 u_i' + u_(i-1)'),  s(e) = k (e + hardening e^3), ends fixed.
!> States u, then u'; the root functions are the speeds, so that an event is a turning point. At times the first mass is kicked.
module oscillator_chain
   use evl_kinds, only: lanes, wp
   use evl_ode_model, only: growth_by_damping, growth_never, ode_model
   use evl_status, only: status_t
   implicit none (type, external)
   private

   public :: kick, next_kick, oscillator_chain_create, oscillator_chain_t

   type, extends(ode_model) :: oscillator_chain_t
      integer :: masses = 0
      real(wp) :: stiffness = 1, hardening = 0, damping = 0
      real(wp) :: kick_interval = 0 !! 0: no kicks
      integer :: kicks = 0          !! so far; each adds 1 to the speed of the first mass
   contains
      procedure :: rhs
      procedure :: rhs_lanes
      procedure :: jacobian
      procedure :: roots
      procedure :: roots_lanes
   end type oscillator_chain_t

contains

   !> Sizes and pattern.
   subroutine oscillator_chain_create(model, masses, stiffness, hardening, damping, with_roots, kick_interval)
      type(oscillator_chain_t), intent(out) :: model
      integer, intent(in) :: masses
      real(wp), intent(in) :: stiffness, hardening, damping
      logical, intent(in) :: with_roots
      real(wp), intent(in) :: kick_interval
      integer :: i, j, p

      model%n = 2*masses
      model%masses = masses
      model%n_roots = merge(masses, 0, with_roots)
      model%stiffness = stiffness
      model%hardening = hardening
      model%damping = damping
      model%growth = merge(growth_by_damping, growth_never, damping < 0)
      model%kick_interval = kick_interval
      allocate (model%scale(model%n), model%jacobian_row(7*masses - 4), model%jacobian_column(7*masses - 4))
      model%scale(:masses) = 1
      model%scale(masses + 1:) = sqrt(stiffness)
      p = 0
      do i = 1, masses
         p = p + 1
         model%jacobian_row(p) = i
         model%jacobian_column(p) = masses + i
         do j = max(1, i - 1), min(masses, i + 1)
            model%jacobian_row(p + 1:p + 2) = masses + i
            model%jacobian_column(p + 1:p + 2) = [j, masses + j]
            p = p + 2
         end do
      end do
   end subroutine oscillator_chain_create

   !> Force of the spring and damper between two masses on the left one.
   elemental real(wp) function force(self, u, v, u_next, v_next)
      class(oscillator_chain_t), intent(in) :: self
      real(wp), intent(in) :: u, v, u_next, v_next
      real(wp) :: e

      e = u_next - u
      force = self%stiffness*(e + self%hardening*(e*e)*e) + self%damping*(v_next - v)
   end function force

   subroutine rhs(self, t, y, f, status)
      class(oscillator_chain_t), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(out) :: f(self%n)
      type(status_t), intent(inout) :: status
      real(wp) :: left, right
      integer :: i, m

      m = self%masses
      left = force(self, 0.0_wp, 0.0_wp, y(1), y(m + 1))
      do i = 1, m
         f(i) = y(m + i)
         if (i < m) then
            right = force(self, y(i), y(m + i), y(i + 1), y(m + i + 1))
         else
            right = force(self, y(m), y(2*m), 0.0_wp, 0.0_wp)
         end if
         f(m + i) = right - left
         left = right
      end do
   end subroutine rhs

   subroutine rhs_lanes(self, t, y, f, status)
      class(oscillator_chain_t), intent(inout) :: self
      real(wp), intent(in) :: t(lanes)
      real(wp), intent(in) :: y(lanes, self%n)
      real(wp), intent(out) :: f(lanes, self%n)
      type(status_t), intent(inout) :: status
      real(wp) :: left(lanes), right(lanes)
      integer :: i, m

      m = self%masses
      left = force(self, 0.0_wp, 0.0_wp, y(:, 1), y(:, m + 1))
      do i = 1, m
         f(:, i) = y(:, m + i)
         if (i < m) then
            right = force(self, y(:, i), y(:, m + i), y(:, i + 1), y(:, m + i + 1))
         else
            right = force(self, y(:, m), y(:, 2*m), 0.0_wp, 0.0_wp)
         end if
         f(:, m + i) = right - left
         left = right
      end do
   end subroutine rhs_lanes

   subroutine jacobian(self, t, y, values, status)
      class(oscillator_chain_t), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(out) :: values(:)
      type(status_t), intent(inout) :: status
      real(wp) :: left, right
      integer :: i, m, p

      m = self%masses
      p = 0
      left = slope(y(1))
      do i = 1, m
         values(p + 1) = 1
         p = p + 1
         if (i < m) then
            right = slope(y(i + 1) - y(i))
         else
            right = slope(y(m))
         end if
         if (i > 1) then
            values(p + 1:p + 2) = [left, self%damping]
            p = p + 2
         end if
         values(p + 1:p + 2) = [-left - right, -2*self%damping]
         p = p + 2
         if (i < m) then
            values(p + 1:p + 2) = [right, self%damping]
            p = p + 2
         end if
         left = right
      end do

   contains

      !> Stiffness of a spring stretched by e.
      pure real(wp) function slope(e)
         real(wp), intent(in) :: e

         slope = self%stiffness*(1 + 3*self%hardening*e**2)
      end function slope

   end subroutine jacobian

   subroutine roots(self, t, y, values, status, only)
      class(oscillator_chain_t), intent(in) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(self%n)
      real(wp), intent(inout) :: values(self%n_roots)
      type(status_t), intent(inout) :: status
      integer, intent(in), optional :: only

      values = y(self%masses + 1:)
   end subroutine roots

   subroutine roots_lanes(self, t, y, exact, values, status)
      class(oscillator_chain_t), intent(inout) :: self
      real(wp), intent(in) :: t(lanes)
      real(wp), intent(in) :: y(lanes, self%n)
      logical, intent(inout) :: exact
      real(wp), intent(inout) :: values(lanes, self%n_roots)
      type(status_t), intent(inout) :: status

      exact = .true.
      values = y(:, self%masses + 1:)
   end subroutine roots_lanes

   !> Time of the next kick; huge if there is none.
   pure real(wp) function next_kick(chain) result(next)
      type(oscillator_chain_t), intent(in) :: chain

      next = huge(next)
      if (chain%kick_interval > 0) next = (chain%kicks + 1)*chain%kick_interval
   end function next_kick

   !> Kick the first mass.
   pure subroutine kick(chain, y)
      type(oscillator_chain_t), intent(inout) :: chain
      real(wp), intent(inout) :: y(:)

      chain%kicks = chain%kicks + 1
      y(chain%masses + 1) = y(chain%masses + 1) + 1
   end subroutine kick

end module oscillator_chain
