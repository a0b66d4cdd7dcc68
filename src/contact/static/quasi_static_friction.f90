!> Friction of a quasi-static mesh: its contribution to the torque of the driving wheel. The slow rotation of that wheel gives the
!> direction of sliding.
!>
!> The sliding velocity is v_t = omega (r_bA/r_bB l_B - l_A), with the arms l_i of friction about the axles and the speed omega of
!> the driving wheel against the torque of the flank on it. F_t = -F_n phi(v_t) acts along t on A, and adds F_t l_A/r_bA to the
!> force on the driving wheel.
module evl_quasi_static_friction
   use evl_deviating_flanks, only: flank_value
   use evl_friction_law, only: by_sliding, friction_law_t, n_sliding, sliding_t
   use evl_kinds, only: wp
   use evl_pair_point, only: by_a, by_b, pair_depth, pair_feet
   implicit none (type, external)
   private

   public :: creep_friction, creep_t, relative_sliding

   !> Slow motion of the wheels.
   type :: creep_t
      real(wp) :: speed = 0.0_wp    !! omega; 0: no friction [rad/s]
      real(wp) :: r_b(2) = 1.0_wp   !! base radii [m]
      real(wp) :: shares(2) = 0.0_wp !! shares of both wheels in the penetration
      real(wp) :: width = 1.0_wp, e_star = 0.0_wp !! common face width [m], effective modulus [Pa]
      class(friction_law_t), allocatable :: law
   end type creep_t

contains

   !> Friction of a pair. Equation SA2.
   pure subroutine creep_friction(creep, feet, flanks, depth, normal, d_normal, force, held, d_held)
      type(creep_t), intent(in) :: creep
      type(pair_feet), intent(in) :: feet
      type(flank_value), intent(in) :: flanks(2) !! deviations at the contact position
      type(pair_depth), intent(in) :: depth
      real(wp), intent(in) :: normal, d_normal  !! normal force and its derivative with respect to rho_B [N], [N/m]
      real(wp), intent(out) :: force            !! F_t [N]
      real(wp), intent(out) :: held, d_held     !! F_t l_A/r_bA and its derivative with respect to rho_B [N], [N/m]
      real(wp) :: arm(2), d_arm(2), phi, d_phi(n_sliding), d_x(n_sliding)
      type(sliding_t) :: at

      call friction_arms(creep, feet, flanks, depth, arm, d_arm)
      associate (velocity => creep%speed*abs(creep%r_b(by_a)), rho => feet%rho)
         at%x(1, :) = [velocity*sliding_of(creep, arm, -1), velocity*sliding_of(creep, arm, 1), normal/creep%width, &
                       1/rho(by_a) + 1/rho(by_b)]
         d_x = [velocity*sliding_of(creep, d_arm, -1), velocity*sliding_of(creep, d_arm, 1), d_normal/creep%width, -1/rho(by_b)**2]
      end associate
      at%e_star = creep%e_star
      call creep%law%factor(creep%law%branch(at%x(1, by_sliding)), at, phi, d_phi)
      force = -normal*phi
      held = force*arm(by_a)/creep%r_b(by_a)
      d_held = (-(d_normal*phi + normal*dot_product(d_phi, d_x))*arm(by_a) + force*d_arm(by_a))/creep%r_b(by_a)
   end subroutine creep_friction

   !> Sliding velocity of a pair over the velocity of the base circles. Equation SA6.
   pure real(wp) function relative_sliding(creep, feet, flanks, depth) result(sliding)
      type(creep_t), intent(in) :: creep         !! its speed and law are not used
      type(pair_feet), intent(in) :: feet
      type(flank_value), intent(in) :: flanks(2) !! deviations at the contact position
      type(pair_depth), intent(in) :: depth
      real(wp) :: arm(2), d_arm(2)

      call friction_arms(creep, feet, flanks, depth, arm, d_arm)
      sliding = sliding_of(creep, arm, -1)
   end function relative_sliding

   !> l_B/r_bB + sign l_A/r_bA.
   pure real(wp) function sliding_of(creep, arm, sign) result(sliding)
      type(creep_t), intent(in) :: creep
      real(wp), intent(in) :: arm(2) !! [m]
      integer, intent(in) :: sign    !! -1: sliding; +1: sum of the rolling speeds

      sliding = arm(by_b)/creep%r_b(by_b) + sign*(arm(by_a)/creep%r_b(by_a))
   end function sliding_of

   !> Arms of friction about both axles, and their derivatives with respect to rho_B.
   pure subroutine friction_arms(creep, feet, flanks, depth, arm, d_arm)
      type(creep_t), intent(in) :: creep
      type(pair_feet), intent(in) :: feet
      type(flank_value), intent(in) :: flanks(2)
      type(pair_depth), intent(in) :: depth
      real(wp), intent(out) :: arm(2), d_arm(2) !! [m], [1]
      integer :: w

      do w = by_a, by_b
         if (w == feet%wheel) then
            arm(w) = feet%arm - feet%gap - flanks(w)%e
            d_arm(w) = feet%d_arm(by_b) - feet%d_gap(by_b)
            if (w == by_b) d_arm(w) = d_arm(w) - flanks(w)%de
         else
            arm(w) = feet%foot(w) - flanks(w)%e
            d_arm(w) = (1 - flanks(w)%de)*feet%d_foot(by_b, w)
         end if
      end do
      arm = arm - creep%shares*depth%h
      d_arm = d_arm - creep%shares*depth%d_h(by_b)
   end subroutine friction_arms

end module evl_quasi_static_friction
