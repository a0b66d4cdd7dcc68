!> C interface of flank deviations and pitch errors. The header documents each procedure.
module evl_capi_deviation
   use, intrinsic :: iso_c_binding, only: c_associated, c_bool, c_double, c_f_pointer, c_int, c_ptr
   use evl_gearbox, only: gearbox_t
   use evl_pitch_errors, only: single_pitch_deviation, total_pitch_deviation
   implicit none (type, external)
   private

   public :: evl_gearbox_deviation

   !> evl_deviation_geometry
   type, bind(c) :: c_deviation_geometry
      real(c_double) :: tip_relief_radius, tip_relief_roll_angle, root_relief_radius, root_relief_roll_angle
      real(c_double) :: profile_start_radius, profile_tip_radius, single_pitch, total_pitch
   end type c_deviation_geometry

contains

   logical(c_bool) function evl_gearbox_deviation(handle, wheel, geometry, pitch_errors) result(exists) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: wheel
      type(c_deviation_geometry), intent(out) :: geometry
      real(c_double), intent(inout), optional :: pitch_errors(*)
      type(gearbox_t), pointer :: g
      real(c_double) :: to_arc

      geometry = c_deviation_geometry(0, 0, 0, 0, 0, 0, 0, 0)
      call c_f_pointer(handle, g)
      associate (d => g%wheels(wheel + 1)%deviation, r_b => g%wheels(wheel + 1)%base_radius)
         exists = logical(d%exists, c_bool)
         if (present(pitch_errors)) pitch_errors(:g%wheels(wheel + 1)%teeth) = 0
         if (.not. d%exists) return
         if (d%tip%amount > 0) then
            geometry%tip_relief_radius = hypot(d%tip%border, r_b)
            geometry%tip_relief_roll_angle = d%tip%border/r_b
         end if
         if (d%root%amount > 0) then
            geometry%root_relief_radius = hypot(d%root%border, r_b)
            geometry%root_relief_roll_angle = d%root%border/r_b
         end if
         geometry%profile_start_radius = hypot(d%middle - d%half_length, r_b)
         geometry%profile_tip_radius = hypot(d%middle + d%half_length, r_b)
         if (.not. allocated(d%pitch)) return
         to_arc = g%gears(wheel + 1)%reference_radius/r_b
         geometry%single_pitch = single_pitch_deviation(d%pitch)*to_arc
         geometry%total_pitch = total_pitch_deviation(d%pitch)*to_arc
         if (present(pitch_errors)) pitch_errors(:d%teeth) = d%pitch*to_arc
      end associate
   end function evl_gearbox_deviation

end module evl_capi_deviation
