!> Friction of a quasi-static mesh: its contribution to the torque of the driving wheel. The slow rotation of that wheel gives the
!> direction of sliding.
!>
!> The sliding velocity is v_t = omega (r_bA/r_bB l_B - l_A), with the arms l_i of friction about the axles and the speed omega of
!> the driving wheel against the torque of the flank on it. F_t = -F_n phi(v_t) acts along t on A, and adds F_t l_A/r_bA to the
!> force on the driving wheel.
module evl_quasi_static_friction
   use evl_deviating_flanks, only: flank_value
   use evl_friction_law, only: friction_law_t
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
      real(wp) :: arm(2), d_arm(2), slides, d_slides, phi, d_v

      call friction_arms(creep, feet, flanks, depth, arm, d_arm)
      associate (velocity => creep%speed*creep%r_b(by_a))
         slides = velocity*sliding_of(creep, arm)
         d_slides = velocity*sliding_of(creep, d_arm)
      end associate
      call creep%law%factor(creep%law%branch(slides), slides, phi, d_v)
      force = -normal*phi
      held = force*arm(by_a)/creep%r_b(by_a)
      d_held = (-(d_normal*phi + normal*d_v*d_slides)*arm(by_a) + force*d_arm(by_a))/creep%r_b(by_a)
   end subroutine creep_friction

   !> Sliding velocity of a pair over the velocity of the base circles. Equation SA6.
   pure real(wp) function relative_sliding(creep, feet, flanks, depth) result(sliding)
      type(creep_t), intent(in) :: creep         !! its speed and law are not used
      type(pair_feet), intent(in) :: feet
      type(flank_value), intent(in) :: flanks(2) !! deviations at the contact position
      type(pair_depth), intent(in) :: depth
      real(wp) :: arm(2), d_arm(2)

      call friction_arms(creep, feet, flanks, depth, arm, d_arm)
      sliding = sliding_of(creep, arm)
   end function relative_sliding

   !> l_B/r_bB - l_A/r_bA.
   pure real(wp) function sliding_of(creep, arm) result(sliding)
      type(creep_t), intent(in) :: creep
      real(wp), intent(in) :: arm(2) !! [m]

      sliding = arm(by_b)/creep%r_b(by_b) - arm(by_a)/creep%r_b(by_a)
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
