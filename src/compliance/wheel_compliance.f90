!> Compliance of the flanks of a wheel: c(rho) of the loaded tooth and c_j(rho, rho') between tooth 0 and tooth j, with exact
!> derivatives. Per unit width: metres per newton per metre, 1/Pa.
!>
!> c is the compliance in addition to a cylinder's contact: the displacement of the loaded flank into the material, less that of
!> Johnson's cylinder of radius rho. c_j is the displacement at rho of tooth 0 by a load at rho' of tooth j, positive toward the
!> side that the flank faces; c_-j(rho, rho') = c_j(rho', rho). Both are polynomials in rho between `low` and `high`
!> (evl_flank_polynomials), or cubics of a table. Beyond these, c is extrapolated linearly, so c'' jumps at both ends; c_j is
!> extrapolated by its polynomial.
module evl_wheel_compliance
   use evl_flank_polynomials, only: double_at, double_in_lanes, double_polynomial, double_through, double_values_in_lanes, &
                                    single_at, single_in_lanes, single_polynomial, single_through
   use evl_influence_functions, only: influence_t, n_neighbours, n_own
   use evl_kinds, only: lanes, wp
   use evl_monotone_cubic, only: cubic_at, cubic_t, cubic_through
   implicit none (type, external)
   private

   public :: compliance_from_influence, compliance_from_samples, compliance_from_table, coupling_at_t, own_at_t, wheel_compliance_t

   !> c at one position.
   type :: own_at_t
      real(wp) :: value = 0     !! c [1/Pa]
      real(wp) :: slope = 0     !! dc/drho [1/(Pa m)]
      real(wp) :: curvature = 0 !! d2c/drho2 [1/(Pa m2)]
   end type own_at_t

   !> c_j at two positions.
   type :: coupling_at_t
      real(wp) :: value = 0                     !! c_j [1/Pa]
      real(wp) :: by_here = 0, by_there = 0     !! derivatives with respect to rho and rho' [1/(Pa m)]
      real(wp) :: here_here = 0, here_there = 0, there_there = 0 !! second derivatives [1/(Pa m2)]
   end type coupling_at_t

   !> Compliance of a wheel; initial values: a rigid wheel.
   type :: wheel_compliance_t
      logical :: exists = .false.              !! whether the wheel is compliant
      integer :: neighbours = 0                !! c_j is defined for |j| up to this, and 0 otherwise
      real(wp) :: low = 0, high = 0            !! limits of rho between which c is smooth [m]
      type(single_polynomial), private :: own_polynomial
      type(double_polynomial), private :: other_polynomial(n_neighbours) !! c_j, j > 0
      logical, private :: is_table = .false.
      type(cubic_t), private :: own_table, other_table
   contains
      procedure :: own
      procedure :: own_lanes
      procedure :: coupling
      procedure :: coupling_lanes
      procedure :: coupling_values
   end type wheel_compliance_t

contains

   !> Compliance from the samples of finite elements, in modules and for E = 1.
   subroutine compliance_from_influence(influence, normal_module, youngs_modulus, compliance)
      type(influence_t), intent(in) :: influence
      real(wp), intent(in) :: normal_module  !! [m]
      real(wp), intent(in) :: youngs_modulus !! [Pa]
      type(wheel_compliance_t), intent(out) :: compliance
      integer :: j

      call compliance_from_samples(normal_module*influence%rho, influence%own/youngs_modulus, compliance)
      compliance%neighbours = n_neighbours
      do j = 1, n_neighbours
         call double_through(compliance%low, compliance%high, influence%other(:, :, j)/youngs_modulus, &
                             compliance%other_polynomial(j))
      end do
   end subroutine compliance_from_influence

   !> Compliance from c at the Chebyshev points of a flank; no coupling.
   subroutine compliance_from_samples(rho, c, compliance)
      real(wp), intent(in) :: rho(0:n_own) !! points from low to high [m]
      real(wp), intent(in) :: c(0:n_own)   !! [1/Pa]
      type(wheel_compliance_t), intent(out) :: compliance

      compliance%exists = .true.
      compliance%low = rho(0)
      compliance%high = rho(n_own)
      call single_through(compliance%low, compliance%high, c, compliance%own_polynomial)
   end subroutine compliance_from_samples

   !> Compliance from a table: c and, if present, c_1(rho, rho); for two different positions the mean of c_1 is used.
   subroutine compliance_from_table(rho, c, next, compliance)
      real(wp), intent(in) :: rho(:)  !! strictly increasing [m]
      real(wp), intent(in) :: c(:)    !! [1/Pa]
      real(wp), intent(in) :: next(:) !! c_1 [1/Pa]; empty, or one for each rho
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

   !> c of the loaded tooth. Valid: any rho
   pure subroutine own(self, rho, at)
      class(wheel_compliance_t), intent(in) :: self
      real(wp), intent(in) :: rho !! [m]
      type(own_at_t), intent(out) :: at

      if (.not. self%exists) return
      if (self%is_table) then
         call cubic_at(self%own_table, rho, at%value, at%slope, at%curvature)
      else
         call single_at(self%own_polynomial, rho, at%value, at%slope, at%curvature)
      end if
   end subroutine own

   !> c and its slope for eight states.
   pure subroutine own_lanes(self, rho, value, slope)
      class(wheel_compliance_t), intent(in) :: self
      real(wp), intent(in) :: rho(lanes) !! [m]
      real(wp), intent(out) :: value(lanes), slope(lanes)
      type(own_at_t) :: at
      integer :: k

      if (self%exists .and. .not. self%is_table) then
         call single_in_lanes(self%own_polynomial, rho, value, slope)
         return
      end if
      do k = 1, lanes
         call self%own(rho(k), at)
         value(k) = at%value
         slope(k) = at%slope
      end do
   end subroutine own_lanes

   !> c_j: deflection of tooth 0 at `here` under a load at `there` on tooth j. Valid: j /= 0
   pure subroutine coupling(self, j, here, there, at)
      class(wheel_compliance_t), intent(in) :: self
      integer, intent(in) :: j
      real(wp), intent(in) :: here, there !! rho, rho' [m]
      type(coupling_at_t), intent(out) :: at

      if (abs(j) > self%neighbours) return
      if (self%is_table) then
         call mean_of_table(self%other_table, here, there, at)
      else if (j > 0) then
         call double_at(self%other_polynomial(j), here, there, at%value, at%by_here, at%by_there, at%here_here, at%here_there, &
                        at%there_there)
      else
         call double_at(self%other_polynomial(-j), there, here, at%value, at%by_there, at%by_here, at%there_there, at%here_there, &
                        at%here_here)
      end if
   end subroutine coupling

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

   !> c_j and its derivatives for eight states.
   pure subroutine coupling_lanes(self, j, here, there, value, by_here, by_there)
      class(wheel_compliance_t), intent(in) :: self
      integer, intent(in) :: j
      real(wp), intent(in) :: here(lanes), there(lanes)
      real(wp), intent(out) :: value(lanes), by_here(lanes), by_there(lanes)
      type(coupling_at_t) :: at
      integer :: k

      if (is_polynomial(self, j)) then
         call double_in_lanes(self%other_polynomial(j), here, there, value, by_here, by_there)
         return
      end if
      do k = 1, lanes
         call self%coupling(j, here(k), there(k), at)
         value(k) = at%value
         by_here(k) = at%by_here
         by_there(k) = at%by_there
      end do
   end subroutine coupling_lanes

   !> c_j alone for eight states.
   pure subroutine coupling_values(self, j, here, there, value)
      class(wheel_compliance_t), intent(in) :: self
      integer, intent(in) :: j
      real(wp), intent(in) :: here(lanes), there(lanes)
      real(wp), intent(out) :: value(lanes)
      real(wp) :: by_here(lanes), by_there(lanes)

      if (is_polynomial(self, j)) then
         call double_values_in_lanes(self%other_polynomial(j), here, there, value)
      else
         call self%coupling_lanes(j, here, there, value, by_here, by_there)
      end if
   end subroutine coupling_values

   !> Whether c_j is a polynomial of this wheel.
   pure logical function is_polynomial(self, j)
      class(wheel_compliance_t), intent(in) :: self
      integer, intent(in) :: j

      is_polynomial = j > 0 .and. j <= self%neighbours .and. .not. self%is_table
   end function is_polynomial

end module evl_wheel_compliance
