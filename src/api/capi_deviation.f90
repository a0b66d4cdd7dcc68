!> C interface of flank deviations and pitch errors. The header documents each procedure.
module evl_capi_deviation
   use, intrinsic :: iso_c_binding, only: c_associated, c_bool, c_double, c_f_pointer, c_int, c_ptr
   use evl_capi_types, only: c_status, status_to_c
   use evl_contact_point, only: contact_point
   use evl_deviation_description, only: deviation_create, deviation_input, profile_t, relief_input
   use evl_flank_deviation, only: deviation_at, deviation_borders, deviation_zone, flank_deviation_t
   use evl_gearbox, only: gearbox_t
   use evl_pitch_errors, only: pitch_errors_generate, pitch_tolerances, single_pitch_deviation, total_pitch_deviation
   use evl_status, only: code_invalid_input, fail, has_failed, status_t, subject_wheel
   use evl_tooth_contact, only: contact_mode, settle_zones
   use evl_touching_flanks, only: second_order_gap, touching_curvature
   implicit none (type, external)
   private

   public :: c_flank_deviation, deviation_from_c
   public :: evl_flank_deviation_at, evl_gearbox_deviation, evl_gearbox_flank_deviation
   public :: evl_gearbox_touching_flanks
   public :: evl_pitch_error_sequence, evl_pitch_tolerances

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

   !> evl_profile
   type, bind(c) :: c_profile
      integer(c_int) :: teeth
      real(c_double) :: base_radius, reference_radius, rho_start, rho_tip, tooth_angle
   end type c_profile

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

   integer(c_int) function evl_flank_deviation_at(given, profile, n, teeth, sides, rho, zones, e, de, d2e, borders, status) &
      result(code) bind(c)
      type(c_flank_deviation), intent(in) :: given
      type(c_profile), intent(in) :: profile
      integer(c_int), intent(in), value :: n
      integer(c_int), intent(in) :: teeth(n), sides(n)
      real(c_double), intent(in) :: rho(n)
      integer(c_int), intent(in), optional :: zones(n)
      real(c_double), intent(out) :: e(n), de(n), d2e(n), borders(2)
      type(c_status), intent(out), optional :: status
      type(deviation_input) :: description
      type(flank_deviation_t) :: deviation
      type(status_t) :: s

      e = 0
      de = 0
      d2e = 0
      borders = 0
      call deviation_from_c(given, 1, description, s)
      if (.not. has_failed(s)) &
         call deviation_create(description, profile_t(profile%teeth, profile%base_radius, profile%reference_radius, &
                                                      profile%rho_start, profile%rho_tip, profile%tooth_angle), deviation, s)
      if (.not. has_failed(s)) then
         call evaluate(deviation, n, teeth, sides, rho, zones, e, de, d2e)
         call deviation_borders(deviation, borders(1), borders(2))
      end if
      if (present(status)) call status_to_c(s, status)
      code = s%code
   end function evl_flank_deviation_at

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

   subroutine evl_gearbox_flank_deviation(handle, wheel, n, teeth, sides, rho, e, de, d2e) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: wheel, n
      integer(c_int), intent(in) :: teeth(n), sides(n)
      real(c_double), intent(in) :: rho(n)
      real(c_double), intent(out) :: e(n), de(n), d2e(n)
      type(gearbox_t), pointer :: g

      call c_f_pointer(handle, g)
      call evaluate(g%wheels(wheel + 1)%deviation, n, teeth, sides, rho, e=e, de=de, d2e=d2e)
   end subroutine evl_gearbox_flank_deviation

   subroutine evl_gearbox_touching_flanks(handle, mesh, pair, n, rho, second_order, curvature) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh, pair, n
      real(c_double), intent(in) :: rho(n)
      real(c_double), intent(out) :: second_order(n), curvature(n)
      type(gearbox_t), pointer :: g
      type(contact_point) :: point
      type(contact_mode) :: mode
      integer :: i

      call c_f_pointer(handle, g)
      associate (contact => g%contacts(g%first(mesh + 1)))
         mode%tooth_pair = pair
         do i = 1, n
            point%rho_a = rho(i)
            point%rho_b = contact%pair%rho_0 - rho(i)
            call settle_zones(contact, point, mode)
            second_order(i) = second_order_gap(contact, pair, rho(i))
            curvature(i) = touching_curvature(contact, mode, point)
         end do
      end associate
   end subroutine evl_gearbox_touching_flanks

   !> Each flank in its zone, or in the zone in which rho lies.
   pure subroutine evaluate(deviation, n, teeth, sides, rho, zones, e, de, d2e)
      type(flank_deviation_t), intent(in) :: deviation
      integer(c_int), intent(in) :: n
      integer(c_int), intent(in) :: teeth(n), sides(n)
      real(c_double), intent(in) :: rho(n)
      integer(c_int), intent(in), optional :: zones(n)
      real(c_double), intent(out) :: e(n), de(n), d2e(n)
      integer :: i, zone

      do i = 1, n
         zone = deviation_zone(deviation, rho(i))
         if (present(zones)) zone = zones(i)
         call deviation_at(deviation, teeth(i), sides(i), rho(i), zone, e(i), de(i), d2e(i))
      end do
   end subroutine evaluate

   integer(c_int) function evl_pitch_tolerances(teeth, module, class, single, total, status) result(code) bind(c)
      integer(c_int), intent(in), value :: teeth, class
      real(c_double), intent(in), value :: module
      real(c_double), intent(out) :: single, total
      type(c_status), intent(out), optional :: status
      type(status_t) :: s

      call pitch_tolerances(teeth, module, class, single, total, s)
      if (present(status)) call status_to_c(s, status)
      code = s%code
   end function evl_pitch_tolerances

   subroutine evl_pitch_error_sequence(teeth, single, total, seed, errors) bind(c)
      integer(c_int), intent(in), value :: teeth, seed
      real(c_double), intent(in), value :: single, total
      real(c_double), intent(out) :: errors(teeth)

      call pitch_errors_generate(single, total, seed, errors)
   end subroutine evl_pitch_error_sequence

end module evl_capi_deviation
