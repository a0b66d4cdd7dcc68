!> A pair of real gears where it stands: the geometry that its contacts need, from that of two gears in mesh.
module evl_mesh_of_gears
   use evl_gear, only: gear_t
   use evl_gears_in_mesh, only: gear_mesh_t
   use evl_kinds, only: pi, wp
   use evl_mesh_geometry, only: spur_pair_place, spur_pair_t
   implicit none (type, external)
   private

   public :: gear_pair_derive

contains

   !> Fill a pair: lengths from the gears and their mesh, points from its place.
   !>
   !> The path of contact goes from the tip of B to the tip of A.   Valid: what gear_derive and gear_mesh_derive accepted
   pure subroutine gear_pair_derive(gear_a, gear_b, mesh, chi, sigma, centre_a, pair)
      type(gear_t), intent(in) :: gear_a, gear_b !! the driving and the driven gear
      type(gear_mesh_t), intent(in) :: mesh      !! of the two
      real(wp), intent(in) :: chi                !! direction from O_A to O_B [rad]
      integer, intent(in) :: sigma               !! +1 or -1, see evl_mesh_geometry
      real(wp), intent(in) :: centre_a(2)        !! O_A in the housing frame [m]
      type(spur_pair_t), intent(out) :: pair

      pair%teeth_a = gear_a%teeth
      pair%teeth_b = gear_b%teeth
      pair%sigma = sigma
      pair%ratio = real(gear_b%teeth, wp)/real(gear_a%teeth, wp)
      pair%pitch_radius_a = mesh%pitch_radius_a
      pair%pitch_radius_b = mesh%pitch_radius_b
      pair%centre_distance = mesh%centre_distance
      pair%chi = chi
      pair%gamma_a = 2*pi/gear_a%teeth
      pair%alpha_inf = atan(2*pi/(gear_a%teeth + gear_b%teeth))
      pair%alpha_w = mesh%working_pressure_angle
      pair%base_radius_a = gear_a%base_radius
      pair%base_radius_b = gear_b%base_radius
      pair%base_radius_sum = mesh%base_radius_sum
      pair%rho = mesh%line_of_action
      pair%base_pitch = mesh%base_pitch
      pair%tip_radius_a = gear_a%tip_radius
      pair%tip_radius_b = gear_b%tip_radius
      pair%rho_tip_a = mesh%rho_tip_a
      pair%rho_tip_b = mesh%rho_tip_b
      pair%rho_start_a = mesh%line_of_action - mesh%rho_tip_b
      pair%rho_start_b = mesh%rho_tip_b
      pair%contains_pitch_point = mesh%approach >= 0 .and. mesh%recess >= 0
      pair%handover = .false.
      pair%contact_ratio = mesh%contact_ratio
      pair%has_coast = .true.
      pair%backlash = mesh%backlash
      pair%tooth_angle_a = gear_a%tooth_angle
      pair%tooth_angle_b = gear_b%tooth_angle
      pair%centre_a = centre_a
      call spur_pair_place(pair)
   end subroutine gear_pair_derive

end module evl_mesh_of_gears
