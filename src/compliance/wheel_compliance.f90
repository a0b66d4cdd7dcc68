!> How far the flanks of a wheel give way: c(rho) of the loaded tooth and c_j(rho, rho') between tooth 0 and tooth j, with exact
!> derivatives. Per unit width: metres a newton per metre, 1/Pa.
!>
!> c is what a cylinder's contact lacks: the displacement of the loaded flank into the material less that of Johnson's cylinder of
!> radius rho. c_j is the displacement at rho of tooth 0 by a load at rho' of tooth j, counted toward the side that the flank
!> faces; c_-j(rho, rho') = c_j(rho', rho). Both are polynomials in rho between `low` and `high`, or cubics of a table. Beyond, c
!> goes on straight, so c'' jumps at both ends; c_j goes on by its polynomial.
module evl_wheel_compliance
   use evl_chebyshev, only: chebyshev_coefficients, chebyshev_values
   use evl_influence_functions, only: influence_t, n_neighbours, n_other, n_own
   use evl_kinds, only: lanes, wp
   use evl_monotone_cubic, only: cubic_at, cubic_t, cubic_through
   implicit none (type, external)
   private

   public :: compliance_from_influence, compliance_from_samples, compliance_from_table, coupling_at_t, own_at_t, wheel_compliance_t

   !> c at a place.
   type :: own_at_t
      real(wp) :: value = 0     !! c [1/Pa]
      real(wp) :: slope = 0     !! dc/drho [1/(Pa m)]
      real(wp) :: curvature = 0 !! d2c/drho2 [1/(Pa m2)]
   end type own_at_t

   !> c_j at two places.
   type :: coupling_at_t
      real(wp) :: value = 0                     !! c_j [1/Pa]
      real(wp) :: by_here = 0, by_there = 0     !! derivatives by rho and rho' [1/(Pa m)]
      real(wp) :: here_here = 0, here_there = 0, there_there = 0 !! second ones [1/(Pa m2)]
   end type coupling_at_t

   !> Both of a wheel; initial values: a wheel that does not give way.
   type :: wheel_compliance_t
      logical :: exists = .false.              !! whether the wheel gives way
      integer :: neighbours = 0                !! c_j is known for |j| up to this, else it is 0
      real(wp) :: low = 0, high = 0            !! rho between which c is smooth [m]
      real(wp), private :: own_coefficient(0:n_own) = 0
      real(wp), private :: other_coefficient(0:n_other, 0:n_other, n_neighbours) = 0
      type(own_at_t), private :: ends(2)       !! at low and high
      logical, private :: is_table = .false.
      type(cubic_t), private :: own_table, other_table
   contains
      procedure :: own
      procedure :: own_lanes
      procedure :: coupling
      procedure :: coupling_lanes
   end type wheel_compliance_t

contains

   !> From the samples of finite elements, in modules and for E = 1.
   subroutine compliance_from_influence(influence, normal_module, youngs_modulus, compliance)
      type(influence_t), intent(in) :: influence
      real(wp), intent(in) :: normal_module  !! [m]
      real(wp), intent(in) :: youngs_modulus !! [Pa]
      type(wheel_compliance_t), intent(out) :: compliance
      real(wp) :: at(0:n_other), part(0:n_other, 0:n_other)
      integer :: i, j

      call compliance_from_samples(normal_module*influence%rho, influence%own/youngs_modulus, compliance)
      compliance%neighbours = n_neighbours
      do j = 1, n_neighbours
         do i = 0, n_other
            part(:, i) = chebyshev_coefficients(influence%other(:, i, j))
         end do
         do i = 0, n_other
            at = chebyshev_coefficients(part(i, :))
            compliance%other_coefficient(i, :, j) = at/youngs_modulus
         end do
      end do
   end subroutine compliance_from_influence

   !> From c at the Chebyshev points of a flank; no coupling.
   subroutine compliance_from_samples(rho, c, compliance)
      real(wp), intent(in) :: rho(0:n_own) !! points from low to high [m]
      real(wp), intent(in) :: c(0:n_own)   !! [1/Pa]
      type(wheel_compliance_t), intent(out) :: compliance

      compliance%exists = .true.
      compliance%low = rho(0)
      compliance%high = rho(n_own)
      compliance%own_coefficient = chebyshev_coefficients(c)
      call polynomial(compliance, compliance%low, compliance%ends(1))
      call polynomial(compliance, compliance%high, compliance%ends(2))
   end subroutine compliance_from_samples

   !> From a table: c, and if it is given c_1(rho, rho), of which between two places the mean is taken.
   subroutine compliance_from_table(rho, c, next, compliance)
      real(wp), intent(in) :: rho(:)  !! strictly increasing [m]
      real(wp), intent(in) :: c(:)    !! [1/Pa]
      real(wp), intent(in) :: next(:) !! c_1 [1/Pa]; none, or one for each rho
      type(wheel_compliance_t), intent(out) :: compliance

      compliance%exists = .true.
      compliance%is_table = .true.
      compliance%low = rho(1)
      compliance%high = rho(size(rho))
      call cubic_through(rho, c, compliance%own_table)
      if (size(next) /= size(rho)) return
      compliance%neighbours = 1
      call cubic_through(rho, next, compliance%other_table)
   end subroutine compliance_from_table

   !> c of the loaded tooth.   Valid: any rho
   pure subroutine own(self, rho, at)
      class(wheel_compliance_t), intent(in) :: self
      real(wp), intent(in) :: rho !! [m]
      type(own_at_t), intent(out) :: at
      integer :: side

      if (.not. self%exists) return
      if (self%is_table) then
         call cubic_at(self%own_table, rho, at%value, at%slope, at%curvature)
      else if (rho < self%low .or. rho > self%high) then
         side = merge(1, 2, rho < self%low)
         at%slope = self%ends(side)%slope
         at%value = self%ends(side)%value + at%slope*(rho - merge(self%low, self%high, side == 1))
      else
         call polynomial(self, rho, at)
      end if
   end subroutine own

   !> The polynomial of c.
   pure subroutine polynomial(self, rho, at)
      class(wheel_compliance_t), intent(in) :: self
      real(wp), intent(in) :: rho
      type(own_at_t), intent(out) :: at
      real(wp) :: t(0:n_own), dt(0:n_own), ddt(0:n_own), stretch

      stretch = 2/(self%high - self%low)
      call chebyshev_values(stretch*(rho - self%low) - 1, t, dt, ddt)
      at%value = dot_product(self%own_coefficient, t)
      at%slope = dot_product(self%own_coefficient, dt)*stretch
      at%curvature = dot_product(self%own_coefficient, ddt)*stretch**2
   end subroutine polynomial

   !> c and its slope in eight states.
   pure subroutine own_lanes(self, rho, value, slope)
      class(wheel_compliance_t), intent(in) :: self
      real(wp), intent(in) :: rho(lanes) !! [m]
      real(wp), intent(out) :: value(lanes), slope(lanes)
      type(own_at_t) :: at
      real(wp), dimension(lanes) :: inside, x, t, before, dt, dbefore
      real(wp) :: stretch, next, dnext
      integer :: n, k

      if (self%is_table .or. .not. self%exists) then
         do k = 1, lanes
            call self%own(rho(k), at)
            value(k) = at%value
            slope(k) = at%slope
         end do
         return
      end if
      stretch = 2/(self%high - self%low)
      do k = 1, lanes
         inside(k) = min(max(rho(k), self%low), self%high)
         x(k) = stretch*(inside(k) - self%low) - 1
         before(k) = 1
         t(k) = x(k)
         dbefore(k) = 0
         dt(k) = 1
         value(k) = self%own_coefficient(0) + self%own_coefficient(1)*t(k)
         slope(k) = self%own_coefficient(1)
      end do
      do n = 2, n_own
         do k = 1, lanes
            next = 2*x(k)*t(k) - before(k)
            dnext = 2*t(k) + 2*x(k)*dt(k) - dbefore(k)
            before(k) = t(k)
            dbefore(k) = dt(k)
            t(k) = next
            dt(k) = dnext
            value(k) = value(k) + self%own_coefficient(n)*next
            slope(k) = slope(k) + self%own_coefficient(n)*dnext
         end do
      end do
      do k = 1, lanes
         slope(k) = slope(k)*stretch
         value(k) = value(k) + slope(k)*(rho(k) - inside(k))
      end do
   end subroutine own_lanes

   !> c_j: tooth 0 gives way at `here` under a load at `there` on tooth j.   Valid: j /= 0
   pure subroutine coupling(self, j, here, there, at)
      class(wheel_compliance_t), intent(in) :: self
      integer, intent(in) :: j
      real(wp), intent(in) :: here, there !! rho, rho' [m]
      type(coupling_at_t), intent(out) :: at
      type(coupling_at_t) :: mirror

      if (abs(j) > self%neighbours) return
      if (self%is_table) then
         call mean_of_table(self%other_table, here, there, at)
      else if (j > 0) then
         call double_polynomial(self, j, here, there, at)
      else
         call double_polynomial(self, -j, there, here, mirror)
         at = coupling_at_t(mirror%value, mirror%by_there, mirror%by_here, mirror%there_there, mirror%here_there, &
                            mirror%here_here)
      end if
   end subroutine coupling

   !> c_j, j > 0, as a polynomial of both places.
   pure subroutine double_polynomial(self, j, here, there, at)
      class(wheel_compliance_t), intent(in) :: self
      integer, intent(in) :: j
      real(wp), intent(in) :: here, there
      type(coupling_at_t), intent(out) :: at
      real(wp), dimension(0:n_other) :: t, dt, ddt, s, ds, dds
      real(wp) :: stretch, by, dby, ddby
      integer :: i

      stretch = 2/(self%high - self%low)
      call chebyshev_values(stretch*(here - self%low) - 1, t, dt, ddt)
      call chebyshev_values(stretch*(there - self%low) - 1, s, ds, dds)
      do i = 0, n_other
         by = dot_product(t, self%other_coefficient(:, i, j))
         dby = dot_product(dt, self%other_coefficient(:, i, j))*stretch
         ddby = dot_product(ddt, self%other_coefficient(:, i, j))*stretch**2
         at%value = at%value + by*s(i)
         at%by_here = at%by_here + dby*s(i)
         at%by_there = at%by_there + by*ds(i)*stretch
         at%here_here = at%here_here + ddby*s(i)
         at%here_there = at%here_there + dby*ds(i)*stretch
         at%there_there = at%there_there + by*dds(i)*stretch**2
      end do
   end subroutine double_polynomial

   !> c_1 of a table.
   pure subroutine mean_of_table(table, here, there, at)
      type(cubic_t), intent(in) :: table
      real(wp), intent(in) :: here, there
      type(coupling_at_t), intent(out) :: at
      real(wp) :: value_here, value_there

      call cubic_at(table, here, value_here, at%by_here, at%here_here)
      call cubic_at(table, there, value_there, at%by_there, at%there_there)
      at%value = (value_here + value_there)/2
      at%by_here = at%by_here/2
      at%by_there = at%by_there/2
      at%here_here = at%here_here/2
      at%there_there = at%there_there/2
   end subroutine mean_of_table

   !> c_j and its derivatives in eight states.
   pure subroutine coupling_lanes(self, j, here, there, value, by_here, by_there)
      class(wheel_compliance_t), intent(in) :: self
      integer, intent(in) :: j
      real(wp), intent(in) :: here(lanes), there(lanes)
      real(wp), intent(out) :: value(lanes), by_here(lanes), by_there(lanes)
      type(coupling_at_t) :: at
      real(wp), dimension(lanes) :: by, dby
      real(wp), dimension(lanes, 0:n_other) :: t, dt, s, ds
      real(wp) :: stretch
      integer :: i, k, m

      if (self%is_table .or. j < 1 .or. j > self%neighbours) then
         do k = 1, lanes
            call self%coupling(j, here(k), there(k), at)
            value(k) = at%value
            by_here(k) = at%by_here
            by_there(k) = at%by_there
         end do
         return
      end if
      stretch = 2/(self%high - self%low)
      call values_in_lanes(stretch*(here - self%low) - 1, t, dt)
      call values_in_lanes(stretch*(there - self%low) - 1, s, ds)
      value = 0
      by_here = 0
      by_there = 0
      do i = 0, n_other
         by = 0
         dby = 0
         do m = 0, n_other
            do k = 1, lanes
               by(k) = by(k) + t(k, m)*self%other_coefficient(m, i, j)
               dby(k) = dby(k) + dt(k, m)*self%other_coefficient(m, i, j)
            end do
         end do
         do k = 1, lanes
            value(k) = value(k) + by(k)*s(k, i)
            by_here(k) = by_here(k) + dby(k)*stretch*s(k, i)
            by_there(k) = by_there(k) + by(k)*ds(k, i)*stretch
         end do
      end do
   end subroutine coupling_lanes

   !> T_k(x) and T_k'(x) in eight states.
   pure subroutine values_in_lanes(x, t, dt)
      real(wp), intent(in) :: x(lanes)
      real(wp), intent(out), dimension(lanes, 0:n_other) :: t, dt
      integer :: k, m

      t(:, 0) = 1
      dt(:, 0) = 0
      t(:, 1) = x
      dt(:, 1) = 1
      do m = 2, n_other
         do k = 1, lanes
            t(k, m) = 2*x(k)*t(k, m - 1) - t(k, m - 2)
            dt(k, m) = 2*t(k, m - 1) + 2*x(k)*dt(k, m - 1) - dt(k, m - 2)
         end do
      end do
   end subroutine values_in_lanes

end module evl_wheel_compliance
