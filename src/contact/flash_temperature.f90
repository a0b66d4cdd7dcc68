!> Flash temperature of a tooth pair by Blok: rise of the surface temperature in the contact strip, a heat source that moves fast
!> over both flanks.
!>
!> Validity: Peclet numbers v a/(2 kappa) above about 5, kappa = lambda/(rho c). Below, the formula overestimates the temperature.
!> Source: H. Blok 1937, from memory; its factor is verified by quadrature in tests/contact/test_flash_temperature.py.
module evl_flash_temperature
   use evl_kinds, only: nan, pi, wp
   implicit none (type, external)
   private

   public :: flash_temperature, hertz_half_width, thermal_contact_coefficient, mesh_thermal_t

   real(wp), parameter :: blok = 1.11_wp !! the maximum over a semi-elliptic source is 1.1115; literature rounds it

   !> Thermal data of a mesh.
   type :: mesh_thermal_t
      real(wp) :: coefficient_a = 0.0_wp, coefficient_b = 0.0_wp !! B_M of the driving and the driven wheel [W s^0.5/(m2 K)]
      real(wp) :: bulk_temperature = 0.0_wp !! of the teeth, absolute [K]
   end type mesh_thermal_t

contains

   !> B_M = sqrt(lambda rho c) of a material [W s^0.5/(m2 K)]. Equation FT1.
   elemental real(wp) function thermal_contact_coefficient(conductivity, density, specific_heat) result(coefficient)
      real(wp), intent(in) :: conductivity  !! lambda [W/(m K)]
      real(wp), intent(in) :: density       !! rho [kg/m3]
      real(wp), intent(in) :: specific_heat !! c [J/(kg K)]

      coefficient = sqrt(conductivity*density*specific_heat)
   end function thermal_contact_coefficient

   !> Half width of the contact strip from its largest pressure [m]. Equation FT2.
   elemental real(wp) function hertz_half_width(line_load, pressure) result(half_width)
      real(wp), intent(in) :: line_load !! normal force over the width [N/m]
      real(wp), intent(in) :: pressure  !! > 0 [Pa]

      half_width = 2*line_load/(pi*pressure)
   end function hertz_half_width

   !> Rise above the bulk temperature [K]. NaN where neither surface moves, because the source is then at rest. Equation FT3.
   elemental real(wp) function flash_temperature(thermal, heat, v_a, v_b, half_width) result(rise)
      type(mesh_thermal_t), intent(in) :: thermal
      real(wp), intent(in) :: heat       !! friction force over the width times sliding velocity, >= 0 [W/m]
      real(wp), intent(in) :: v_a, v_b   !! velocities of both surfaces through the contact, of either sign [m/s]
      real(wp), intent(in) :: half_width !! of the contact strip [m]
      real(wp) :: carried

      rise = nan
      carried = thermal%coefficient_a*sqrt(abs(v_a)) + thermal%coefficient_b*sqrt(abs(v_b))
      if (carried > 0) rise = blok*heat/(carried*sqrt(2*half_width))
   end function flash_temperature

end module evl_flash_temperature
