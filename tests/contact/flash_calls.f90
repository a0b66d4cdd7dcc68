!> The flash temperature for its tests: C calls that the kernel does not export.
module flash_calls
   use, intrinsic :: iso_c_binding, only: c_double
   use evl_flash_temperature, only: flash_temperature, hertz_half_width, mesh_thermal_t, thermal_contact_coefficient
   implicit none (type, external)
   private

   public :: given_thermal, test_flash_temperature

   !> Two materials, and the contact of their flanks.
   type, bind(c) :: given_thermal
      real(c_double) :: conductivity_a, density_a, heat_a, conductivity_b, density_b, heat_b
      real(c_double) :: line_load, pressure, heat, v_a, v_b
   end type given_thermal

contains

   !> Thermal contact coefficients of both materials, half width of the contact, flash temperature.
   subroutine test_flash_temperature(of, values) bind(c)
      type(given_thermal), intent(in) :: of
      real(c_double), intent(out) :: values(4)
      type(mesh_thermal_t) :: thermal

      thermal%coefficient_a = thermal_contact_coefficient(of%conductivity_a, of%density_a, of%heat_a)
      thermal%coefficient_b = thermal_contact_coefficient(of%conductivity_b, of%density_b, of%heat_b)
      values(1) = thermal%coefficient_a
      values(2) = thermal%coefficient_b
      values(3) = hertz_half_width(of%line_load, of%pressure)
      values(4) = flash_temperature(thermal, of%heat, of%v_a, of%v_b, values(3))
   end subroutine test_flash_temperature

end module flash_calls
