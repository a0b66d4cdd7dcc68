!> Local variables of one mesh, in the nominal basis (t_0, e_0).
!>
!> e_0 points along the line of action from K_A to K_B at the reference centre distance, t_0 across it. Positions are deviations
!> from the nominal rolling motion, so that a penetration of 1e-9 m keeps its full relative precision beside radii of 0.1 m.
module evl_local_variables
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: i_omega, i_theta, n_local, n_track, unit, local_link, wheel_link
   public :: at_theta, at_psi_a, at_psi_b, at_u_a, at_u_b, at_omega, at_psi_dot_a, at_psi_dot_b, at_v_a, at_v_b
   public :: at_track, at_turn, at_zeta, at_dr, at_lambda, at_mu, at_normal

   integer, parameter :: i_theta = 1 !! index of the reference angle in the state of a gearbox
   integer, parameter :: i_omega = 2 !! index of the reference speed there

   integer, parameter :: n_local = 21      !! number of local variables of a mesh
   integer, parameter :: n_track = 6       !! tracked variables of a mesh: turn, zeta, dr (2), lambda, mu
   integer, parameter :: at_theta = 1      !! reference angle theta [rad]
   integer, parameter :: at_psi_a = 2      !! angle deviation psi_A [rad]
   integer, parameter :: at_psi_b = 3      !! angle deviation psi_B [rad]
   integer, parameter :: at_u_a = 4        !! displacement of axle A (t_0, e_0) [m], two components
   integer, parameter :: at_u_b = 6        !! displacement of axle B (t_0, e_0) [m], two components
   integer, parameter :: at_omega = 8      !! theta' [rad/s]
   integer, parameter :: at_psi_dot_a = 9  !! psi_A' [rad/s]
   integer, parameter :: at_psi_dot_b = 10 !! psi_B' [rad/s]
   integer, parameter :: at_v_a = 11       !! velocity of axle A (t_0, e_0) [m/s], two components
   integer, parameter :: at_v_b = 13       !! velocity of axle B (t_0, e_0) [m/s], two components
   integer, parameter :: at_normal = 15    !! normal force of a rigid contact, the multiplier of its constraint [N]
   integer, parameter :: at_turn = 16      !! angle from e_0 to A's normal at P_A [rad]
   integer, parameter :: at_zeta = 17      !! radius of curvature of A at P_A less rho_A0 [m]
   integer, parameter :: at_dr = 18        !! dr = r_PB - r_PA [m], two components
   integer, parameter :: at_lambda = 20    !! lambda of (1) [1]
   integer, parameter :: at_mu = 21        !! mu of (1) [m^2]
   integer, parameter :: at_track = at_turn !! first tracked variable

   !> Relation between a local variable of the mesh and a state of the gearbox.
   type :: local_link
      integer :: local = 0           !! index in the local variables
      integer :: state = 0           !! index in the state
      real(wp) :: weight = 0.0_wp    !! d local/d state
   end type local_link

   !> The same for all variables of one of its wheels.
   type :: wheel_link
      integer :: i_psi = 0               !! index of psi in the state, psi' follows; 0 if there is none
      integer :: n = 0                   !! degrees of freedom of the axle
      integer :: i_state(2) = 0          !! index of s_j in the state; s_j' follows
      real(wp) :: along_t(2) = 0.0_wp, along_e(2) = 0.0_wp !! direction of s_j in (t_0, e_0)
   end type wheel_link

contains

   !> Vector of local variables with a single nonzero component.
   pure function unit(index, value) result(vector)
      integer, intent(in) :: index
      real(wp), intent(in) :: value
      real(wp) :: vector(n_local)

      vector = 0
      vector(index) = value
   end function unit

end module evl_local_variables
