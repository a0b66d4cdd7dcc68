!> C interface of flank deviations and pitch errors. The header documents each procedure.
module evl_capi_deviation
   use, intrinsic :: iso_c_binding, only: c_associated, c_bool, c_double, c_f_pointer, c_int, c_ptr
   use evl_deviation_description, only: deviation_input, relief_input
   use evl_gearbox, only: gearbox_t
   use evl_pitch_errors, only: single_pitch_deviation, total_pitch_deviation
   use evl_status, only: code_invalid_input, fail, status_t, subject_wheel
   implicit none (type, external)
   private

   public :: c_flank_deviation, deviation_from_c
   public :: evl_gearbox_deviation

   !> evl_relief
   type, bind(c) :: c_relief
      real(c_double) :: amount
      logical(c_bool) :: by_roll_angle
      real(c_double) :: start
      integer(c_int) :: shape
   end type c_relief

   !> evl_flank_deviation
   type, bind(c) :: c_flank_deviation
      type(c_relief) :: tip_relief, root_relief
      real(c_double) :: profile_crowning
      integer(c_int) :: n_pitch_errors
      type(c_ptr) :: pitch_errors
      integer(c_int) :: accuracy_class, seed
      real(c_double) :: runout_amount, runout_phase
   end type c_flank_deviation

   !> evl_deviation_geometry
   type, bind(c) :: c_deviation_geometry
      real(c_double) :: tip_relief_radius, tip_relief_roll_angle, root_relief_radius, root_relief_roll_angle
      real(c_double) :: profile_start_radius, profile_tip_radius, single_pitch, total_pitch
   end type c_deviation_geometry

contains

   !> Deviations with a copy of the pitch errors. Errors: code_invalid_input if these are announced but not there.
   subroutine deviation_from_c(c, wheel, deviation, status)
      type(c_flank_deviation), intent(in) :: c
      integer, intent(in) :: wheel !! from 1, for the message
      type(deviation_input), intent(out) :: deviation
      type(status_t), intent(inout) :: status
      real(c_double), pointer :: pitch(:)

      deviation%tip = relief_from_c(c%tip_relief)
      deviation%root = relief_from_c(c%root_relief)
      deviation%crowning = c%profile_crowning
      deviation%class = c%accuracy_class
      deviation%seed = c%seed
      deviation%eccentricity = c%runout_amount
      deviation%phase = c%runout_phase
      if (c%n_pitch_errors < 1) return
      if (c_associated(c%pitch_errors)) then
         call c_f_pointer(c%pitch_errors, pitch, [c%n_pitch_errors])
         deviation%pitch = pitch
      else
         call fail(status, code_invalid_input, "the pitch errors of a wheel are missing", subject_wheel, wheel, "pitch_errors")
      end if
   end subroutine deviation_from_c

   elemental type(relief_input) function relief_from_c(c) result(relief)
      type(c_relief), intent(in) :: c

      relief = relief_input(amount=c%amount, by_roll_angle=logical(c%by_roll_angle), start=c%start, shape=c%shape)
   end function relief_from_c

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
