!> Dynamic factor K_V of a gear pair by method B of ISO 6336-1, and its resonance speed.
!>
!> N is the speed over the resonance speed n_E1 of the pair, w = F_t K_A/b its specific load, with
!>
!>    B_p = c' f_pb,eff/w    B_f = c' f_f,eff/w    B_k = |1 - c' C_a/w|
!>
!> for effective deviations f of base pitch and profile form, those after running-in, and the tip relief C_a. Without deviations
!> B_p = B_f = 0 and B_k = 1.
!>
!> Source: ISO 6336-1:2006, 6.5. Checked against the printed result of ISO/TR 6336-30:2017, example 1.
module evl_dynamic_factor
   use evl_kinds, only: pi, wp
   implicit none (type, external)
   private

   public :: dynamic_factor, mesh_stiffness_factor, reduced_mass, resonance_speed

   real(wp), parameter :: full_load = 1.0e5_wp !! specific load below which the resonance zone begins at a lower speed [N/m]
   real(wp), parameter :: main_end = 1.15_wp, super_start = 1.5_wp !! N at the ends of the intermediate zone

contains

   !> c_gamma over c'. Equation DS11.
   pure real(wp) function mesh_stiffness_factor(contact_ratio) result(factor)
      real(wp), intent(in) :: contact_ratio

      factor = 0.75_wp*contact_ratio + 0.25_wp
   end function mesh_stiffness_factor

   !> Mass of two wheels reduced to the line of action [kg]. Equation DS12.
   pure real(wp) function reduced_mass(inertia, base_radius) result(mass)
      real(wp), intent(in) :: inertia(2)     !! [kg m2]
      real(wp), intent(in) :: base_radius(2) !! [m]

      mass = product(inertia)/(inertia(1)*base_radius(2)**2 + inertia(2)*base_radius(1)**2)
   end function reduced_mass

   !> Resonance speed of the wheel with this number of teeth [rad/s]. Equation DS13.
   pure real(wp) function resonance_speed(stiffness, mass, teeth) result(speed)
      real(wp), intent(in) :: stiffness !! c_gamma b [N/m]
      real(wp), intent(in) :: mass      !! [kg]
      integer, intent(in) :: teeth

      speed = sqrt(stiffness/mass)/teeth
   end function resonance_speed

   !> K_V. Equations DS14, DS15.   Valid: contact ratio above 1
   pure real(wp) function dynamic_factor(speed, load, contact_ratio, b_p, b_f, b_k) result(factor)
      real(wp), intent(in) :: speed         !! N
      real(wp), intent(in) :: load          !! w [N/m]
      real(wp), intent(in) :: contact_ratio !! total
      real(wp), intent(in) :: b_p, b_f, b_k
      real(wp) :: c(7), start

      c = coefficients(contact_ratio)
      start = 0.85_wp
      if (load < full_load) start = 0.5_wp + 0.35_wp*sqrt(load/full_load)
      if (speed <= start) then
         factor = 1 + speed*(c(1)*b_p + c(2)*b_f + c(3)*b_k)
      else if (speed <= main_end) then
         factor = main()
      else if (speed < super_start) then
         factor = super() + (main() - super())*(super_start - speed)/(super_start - main_end)
      else
         factor = super()
      end if

   contains

      pure real(wp) function main()
         main = 1 + c(1)*b_p + c(2)*b_f + c(4)*b_k
      end function main

      pure real(wp) function super()
         super = c(5)*b_p + c(6)*b_f + c(7)
      end function super

   end function dynamic_factor

   !> C_v1 to C_v7. Equation DS16.
   pure function coefficients(e) result(c)
      real(wp), intent(in) :: e !! contact ratio
      real(wp) :: c(7)

      c = [0.32_wp, 0.34_wp, 0.23_wp, 0.90_wp, 0.47_wp, 0.47_wp, 0.75_wp]
      if (e > 2) c([2, 3, 4, 6]) = [0.57_wp/(e - 0.3_wp), 0.096_wp/(e - 1.56_wp), (0.57_wp - 0.05_wp*e)/(e - 1.44_wp), &
                                    0.12_wp/(e - 1.74_wp)]
      if (e > 1.5_wp) c(7) = 0.125_wp*sin(pi*(e - 2)) + 0.875_wp
      if (e > 2.5_wp) c(7) = 1
   end function coefficients

end module evl_dynamic_factor
