!> What a drawing of the teeth needs beside the other constants: how far the flanks reach, how thick the teeth are, how their
!> profiles are relieved, and where they stand at the start.
!>
!> The flank that drives of tooth pair 0 begins on the base circle in the direction phi, counted in the housing frame:
!>
!>    phi_A = chi + sigma (alpha_w - rho_A/r_bA)    phi_B = chi + sigma (pi + alpha_w - rho_B/r_bB)
!>
!> Source: Kosenko & Gusev 2011, section 7.1, for any flank; the middle of the tooth is sigma times half its angle further.
module evl_tooth_outputs
   use evl_flank_deviation, only: relief_t
   use evl_gear, only: gear_t
   use evl_gearbox, only: gearbox_t, wheel_t
   use evl_kinds, only: pi, wp
   use evl_mesh_geometry, only: spur_pair_t
   use evl_output, only: dims_mesh, dims_wheel, in_mesh_teeth, in_wheel_teeth
   use evl_teller, only: begin, tell, teller_t, wants
   use evl_tooth_contact, only: tooth_contact_t
   implicit none (type, external)
   private

   public :: active_radius, tell_mesh_teeth, tell_wheel_teeth

contains

   !> Constants of a wheel's teeth.
   subroutine tell_wheel_teeth(teller, index, wheel, gear, active)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: index
      type(wheel_t), intent(in) :: wheel
      type(gear_t), intent(in) :: gear !! initial values if the wheel is no real gear
      real(wp), intent(in) :: active   !! its active radius [m]

      call begin(teller, in_wheel_teeth, dims_wheel, index, is_static=.true.)
      call tell(teller, "root_radius", "m", "r_f", "root radius; 0 if not known", gear%root_radius)
      call tell(teller, "form_radius", "m", "r_Ff", "radius where the involute begins; 0 if not known", gear%form_radius)
      call tell(teller, "active_radius", "m", "r_Nf", &
                "radius where the active profile begins, the smallest over its meshes; 0 without", active)
      call tell(teller, "tooth_angle", "rad", "psi", "angle that a tooth fills on the base circle; 0 if not known", &
                gear%tooth_angle)
      associate (tip => wheel%deviation%tip, root => wheel%deviation%root)
         call tell(teller, "tip_relief", "m", "C_a", "tip relief at the tip circle", max(tip%amount, 0.0_wp))
         call tell(teller, "tip_relief_start", "m", "", "radius where tip relief begins; 0 without", relief_start(wheel, tip))
         call tell(teller, "tip_relief_power", "1", "", "1 linear, 2 parabolic tip relief; 0 without", relief_power(tip))
         call tell(teller, "root_relief", "m", "C_f", "root relief at the start of the active profile", max(root%amount, 0.0_wp))
         call tell(teller, "root_relief_start", "m", "", "radius where root relief begins; 0 without", relief_start(wheel, root))
         call tell(teller, "root_relief_power", "1", "", "1 linear, 2 parabolic root relief; 0 without", relief_power(root))
      end associate
      call tell(teller, "profile_crowning", "m", "C_alpha", "crowning at both ends of the active profile", wheel%deviation%crowning)
   end subroutine tell_wheel_teeth

   !> Constants of a mesh's teeth.
   subroutine tell_mesh_teeth(teller, index, contact, pair)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: index
      type(tooth_contact_t), intent(in) :: contact !! the first of the mesh
      type(spur_pair_t), intent(in) :: pair
      real(wp) :: root

      call begin(teller, in_mesh_teeth, dims_mesh, index, is_static=.true.)
      call tell(teller, "contact_ratio", "1", "eps_alpha", "path of contact over base pitch", pair%contact_ratio)
      call tell(teller, "backlash", "m", "j_bn", "normal backlash; 0 without coast flanks", &
                merge(pair%backlash, 0.0_wp, pair%has_coast))
      call tell(teller, "has_coast_flanks", "1", "", "1 if the flanks on the other side of the teeth can touch, else 0", &
                pair%has_coast)
      root = 0
      if (wants(teller)) root = pair%chi + pair%sigma*(pair%alpha_w - contact%rho_start/pair%base_radius_a)
      call tell(teller, "flank_root_driving", "rad", "phi_A", &
                "direction in which the driving flank of tooth pair 0 meets the base circle at the start", root)
      if (wants(teller)) root = pair%chi + pair%sigma*(pi + pair%alpha_w - &
                                                       (pair%rho - contact%rho_start - contact%pair%gap_0)/pair%base_radius_b)
      call tell(teller, "flank_root_driven", "rad", "phi_B", &
                "direction in which the driven flank of tooth pair 0 meets the base circle at the start", root)
   end subroutine tell_mesh_teeth

   !> Radius where the active profile of a wheel begins, the smallest over its meshes; 0 without a mesh [m].
   pure real(wp) function active_radius(gearbox, wheel) result(smallest)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: wheel
      integer :: m

      smallest = 0
      do m = 1, size(gearbox%pairs)
         associate (contact => gearbox%contacts(gearbox%first(m)), pair => gearbox%pairs(m))
            if (contact%wheel_a == wheel) call take_smallest(hypot(pair%base_radius_a, pair%rho - pair%rho_tip_b), smallest)
            if (contact%wheel_b == wheel) call take_smallest(hypot(pair%base_radius_b, pair%rho - pair%rho_tip_a), smallest)
         end associate
      end do
   end function active_radius

   !> The smaller of two radii, of which the one so far is 0 if there is none.
   pure subroutine take_smallest(value, smallest)
      real(wp), intent(in) :: value
      real(wp), intent(inout) :: smallest

      if (.not. smallest > 0 .or. value < smallest) smallest = value
   end subroutine take_smallest

   !> Radius where a relief begins; 0 without [m].
   pure real(wp) function relief_start(wheel, relief) result(radius)
      type(wheel_t), intent(in) :: wheel
      type(relief_t), intent(in) :: relief

      radius = 0
      if (relief%amount > 0) radius = hypot(wheel%base_radius, relief%border)
   end function relief_start

   !> 1 linear, 2 parabolic, 0 without a relief.
   pure integer function relief_power(relief) result(power)
      type(relief_t), intent(in) :: relief

      power = 0
      if (relief%amount > 0) power = merge(2, 1, relief%parabolic)
   end function relief_power

end module evl_tooth_outputs
