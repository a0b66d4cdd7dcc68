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
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: pi, wp
   use evl_output, only: dims_mesh, dims_wheel, output_t
   implicit none (type, external)
   private

   public :: n_mesh_teeth, n_wheel_teeth, put_mesh_teeth, put_wheel_teeth, tooth_outputs

   integer, parameter :: n_wheel_teeth = 11 !! constants of the teeth of a wheel
   integer, parameter :: n_mesh_teeth = 5   !! and of a mesh

contains

   !> The constants of the wheels, then those of the meshes.
   pure function tooth_outputs() result(t)
      type(output_t) :: t(n_wheel_teeth + n_mesh_teeth)

      t(1) = output_t("root_radius", "m", "r_f", "root radius; 0 if not known", dims_wheel, .true.)
      t(2) = output_t("form_radius", "m", "r_Ff", "radius where the involute begins; 0 if not known", dims_wheel, .true.)
      t(3) = output_t("active_radius", "m", "r_Nf", "radius where the active profile begins, the smallest over its meshes; 0" &
                      //" without", dims_wheel, .true.)
      t(4) = output_t("tooth_angle", "rad", "psi", "angle that a tooth fills on the base circle; 0 if not known", dims_wheel, &
                      .true.)
      t(5) = output_t("tip_relief", "m", "C_a", "tip relief at the tip circle", dims_wheel, .true.)
      t(6) = output_t("tip_relief_start", "m", "", "radius where tip relief begins; 0 without", dims_wheel, .true.)
      t(7) = output_t("tip_relief_power", "1", "", "1 linear, 2 parabolic tip relief; 0 without", dims_wheel, .true., .true.)
      t(8) = output_t("root_relief", "m", "C_f", "root relief at the start of the active profile", dims_wheel, .true.)
      t(9) = output_t("root_relief_start", "m", "", "radius where root relief begins; 0 without", dims_wheel, .true.)
      t(10) = output_t("root_relief_power", "1", "", "1 linear, 2 parabolic root relief; 0 without", dims_wheel, .true., .true.)
      t(11) = output_t("profile_crowning", "m", "C_alpha", "crowning at both ends of the active profile", dims_wheel, .true.)
      t(12) = output_t("contact_ratio", "1", "eps_alpha", "path of contact over base pitch", dims_mesh, .true.)
      t(13) = output_t("backlash", "m", "j_bn", "normal backlash; 0 without coast flanks", dims_mesh, .true.)
      t(14) = output_t("has_coast_flanks", "1", "", "1 if the flanks on the other side of the teeth can touch, else 0", dims_mesh, &
                       .true., .true.)
      t(15) = output_t("flank_root_driving", "rad", "phi_A", "direction in which the driving flank of tooth pair 0 meets the base" &
                       //" circle at the start", dims_mesh, .true.)
      t(16) = output_t("flank_root_driven", "rad", "phi_B", "direction in which the driven flank of tooth pair 0 meets the base" &
                       //" circle at the start", dims_mesh, .true.)
   end function tooth_outputs

   !> Constants of the wheels' teeth.
   pure subroutine put_wheel_teeth(gearbox, n, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: n !! wheels
      real(wp), intent(inout) :: values(n, n_wheel_teeth)
      integer :: i, m

      values = 0
      do i = 1, n
         associate (gear => gearbox%gears(i), wheel => gearbox%wheels(i))
            if (gear%teeth > 0) values(i, [1, 2, 4]) = [gear%root_radius, gear%form_radius, gear%tooth_angle]
            values(i, 5:7) = of_relief(wheel%deviation%tip, wheel%base_radius)
            values(i, 8:10) = of_relief(wheel%deviation%root, wheel%base_radius)
            values(i, 11) = wheel%deviation%crowning
         end associate
      end do
      do m = 1, size(gearbox%pairs)
         associate (contact => gearbox%contacts(gearbox%first(m)), pair => gearbox%pairs(m))
            call take_smallest(hypot(pair%base_radius_a, pair%rho - pair%rho_tip_b), values(contact%wheel_a, 3))
            call take_smallest(hypot(pair%base_radius_b, pair%rho - pair%rho_tip_a), values(contact%wheel_b, 3))
         end associate
      end do
   end subroutine put_wheel_teeth

   !> Amount, start and power of a relief.
   pure function of_relief(relief, base_radius) result(values)
      type(relief_t), intent(in) :: relief
      real(wp), intent(in) :: base_radius !! [m]
      real(wp) :: values(3)

      values = 0
      if (relief%amount > 0) &
         values = [relief%amount, hypot(base_radius, relief%border), merge(2.0_wp, 1.0_wp, relief%parabolic)]
   end function of_relief

   !> The smaller of two radii, of which the one so far is 0 if there is none.
   pure subroutine take_smallest(value, smallest)
      real(wp), intent(in) :: value
      real(wp), intent(inout) :: smallest

      if (.not. smallest > 0 .or. value < smallest) smallest = value
   end subroutine take_smallest

   !> Constants of the meshes' teeth.
   pure subroutine put_mesh_teeth(gearbox, n, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: n !! meshes
      real(wp), intent(inout) :: values(n, n_mesh_teeth)
      real(wp) :: rho_b
      integer :: m

      do m = 1, n
         associate (contact => gearbox%contacts(gearbox%first(m)), pair => gearbox%pairs(m))
            rho_b = pair%rho - contact%rho_start - contact%pair%gap_0
            values(m, :) = [pair%contact_ratio, merge(pair%backlash, 0.0_wp, pair%has_coast), &
                            merge(1.0_wp, 0.0_wp, pair%has_coast), &
                            pair%chi + pair%sigma*(pair%alpha_w - contact%rho_start/pair%base_radius_a), &
                            pair%chi + pair%sigma*(pi + pair%alpha_w - rho_b/pair%base_radius_b)]
         end associate
      end do
   end subroutine put_mesh_teeth

end module evl_tooth_outputs
