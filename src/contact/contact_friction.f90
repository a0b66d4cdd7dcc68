!> Friction factor of a tooth contact from its motion, load and curvature.
module evl_contact_friction
   use evl_contact_point, only: contact_point
   use evl_friction_law, only: by_curvature, by_load, by_rolling, by_sliding, n_sliding, sliding_t
   use evl_kinds, only: wp
   use evl_tooth_contact, only: contact_mode, tooth_contact_t
   implicit none (type, external)
   private

   public :: friction_factor, rolling_speed_a, rolling_speed_b, rolling_sum, sliding_of

contains

   !> Friction factor of a loaded contact, and its derivatives.
   pure subroutine friction_factor(contact, mode, point, normal, factor, d_factor)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_mode), intent(in) :: mode
      type(contact_point), intent(in) :: point
      real(wp), intent(in) :: normal !! F_n [N]
      real(wp), intent(out) :: factor, d_factor(n_sliding)
      type(sliding_t) :: at

      if (contact%friction%is_local()) then
         call sliding_of(contact, point, normal, at)
      else
         at%x(1, by_sliding) = point%v_t
      end if
      call contact%friction%factor(mode%friction, at, factor, d_factor)
   end subroutine friction_factor

   !> Arguments of a local friction law.
   pure subroutine sliding_of(contact, point, normal, at)
      type(tooth_contact_t), intent(in) :: contact
      type(contact_point), intent(in) :: point
      real(wp), intent(in) :: normal !! F_n [N]
      type(sliding_t), intent(inout) :: at

      at%x(1, by_sliding) = point%v_t
      at%x(1, by_rolling) = rolling_sum(contact%pair%sigma, point%omega_a, point%omega_b, point%l_a, point%l_b)
      at%x(1, by_load) = normal/contact%width
      at%x(1, by_curvature) = 1/point%rho_a + 1/point%rho_b
      at%e_star = contact%e_star
   end subroutine sliding_of

   !> Sum of the rolling speeds of both flanks about their axles [m/s]. Equation L25.
   elemental real(wp) function rolling_sum(sigma, omega_a, omega_b, l_a, l_b)
      real(wp), intent(in) :: sigma, omega_a, omega_b, l_a, l_b !! as in `contact_point`

      rolling_sum = sigma*(omega_a*l_a - omega_b*l_b)
   end function rolling_sum

   !> Its part v_A: velocity of the driving flank through the contact [m/s]. Equation L25.
   elemental real(wp) function rolling_speed_a(sigma, omega_a, l_a) result(speed)
      real(wp), intent(in) :: sigma, omega_a, l_a

      speed = sigma*omega_a*l_a
   end function rolling_speed_a

   !> Its part v_B, of the driven flank [m/s]. Equation L25.
   elemental real(wp) function rolling_speed_b(sigma, omega_b, l_b) result(speed)
      real(wp), intent(in) :: sigma, omega_b, l_b

      speed = -sigma*omega_b*l_b
   end function rolling_speed_b

end module evl_contact_friction
