!> Deviations of flanks and pitch errors for the tests: C calls that the kernel does not export.
module deviation_calls
   use, intrinsic :: iso_c_binding, only: c_bool, c_double, c_f_pointer, c_int, c_ptr
   use evl_capi_types, only: c_status, status_to_c
   use evl_deviation_description, only: deviation_create, profile_t
   use evl_flank_deviation, only: deviation_borders, deviation_branch, deviation_on, deviation_zone, flank_deviation_t
   use evl_gearbox, only: gearbox_t
   use evl_pitch_errors, only: pitch_errors_generate, pitch_tolerances
   use evl_status, only: has_failed, status_t
   use first_wheel_of, only: first_wheel
   implicit none (type, external)
   private

   public :: test_flank_deviation, test_gearbox_flank_deviation, test_pitch_error_sequence, test_pitch_tolerances

   !> The fields of `profile_t`.
   type, bind(c) :: given_profile
      integer(c_int) :: teeth
      real(c_double) :: base_radius, reference_radius, rho_start, rho_tip, tooth_angle
   end type given_profile

contains

   !> Deviation e [m] of flanks from the involute with its derivatives to rho, in the given zones (-1 root relief, 0 none, +1 tip
   !> relief) or in those that hold at rho, and the borders of the zones.
   subroutine test_flank_deviation(given, profile, n, teeth, sides, rho, zones, e, de, d2e, borders, status) bind(c)
      type(c_ptr), intent(in), value :: given !! a description: of its first wheel
      type(given_profile), intent(in) :: profile
      integer(c_int), intent(in), value :: n
      integer(c_int), intent(in) :: teeth(n), sides(n)
      real(c_double), intent(in) :: rho(n)
      integer(c_int), intent(in), optional :: zones(n)
      real(c_double), intent(inout) :: e(n), de(n), d2e(n), borders(2)
      type(c_status), intent(out) :: status
      type(flank_deviation_t) :: deviation
      type(status_t) :: s

      call deviation_create(first_wheel(given), profile_t(profile%teeth, profile%base_radius, profile%reference_radius, &
                                                          profile%rho_start, profile%rho_tip, profile%tooth_angle), deviation, s)
      if (.not. has_failed(s)) then
         call evaluate(deviation, n, teeth, sides, rho, zones, e, de, d2e)
         call deviation_borders(deviation, borders(1), borders(2))
      end if
      call status_to_c(s, status)
   end subroutine test_flank_deviation

   !> The same of a wheel of a gearbox.
   subroutine test_gearbox_flank_deviation(handle, wheel, n, teeth, sides, rho, e, de, d2e) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: wheel, n
      integer(c_int), intent(in) :: teeth(n), sides(n)
      real(c_double), intent(in) :: rho(n)
      real(c_double), intent(out) :: e(n), de(n), d2e(n)
      type(gearbox_t), pointer :: g

      call c_f_pointer(handle, g)
      call evaluate(g%wheels(wheel + 1)%deviation, n, teeth, sides, rho, e=e, de=de, d2e=d2e)
   end subroutine test_gearbox_flank_deviation

   !> Tolerances of the single pitch and of the total cumulative pitch deviation [m].
   subroutine test_pitch_tolerances(teeth, module, class, single, total, status) bind(c)
      integer(c_int), intent(in), value :: teeth, class
      real(c_double), intent(in), value :: module
      real(c_double), intent(out) :: single, total
      type(c_status), intent(out) :: status
      type(status_t) :: s

      call pitch_tolerances(teeth, module, class, single, total, s)
      call status_to_c(s, status)
   end subroutine test_pitch_tolerances

   !> Cumulative position deviations of all teeth [m] that keep both tolerances.
   subroutine test_pitch_error_sequence(teeth, single, total, seed, errors) bind(c)
      integer(c_int), intent(in), value :: teeth, seed
      real(c_double), intent(in), value :: single, total
      real(c_double), intent(out) :: errors(teeth)

      call pitch_errors_generate(single, total, seed, errors)
   end subroutine test_pitch_error_sequence

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
         call deviation_on(deviation_branch(deviation, teeth(i), sides(i), zone), rho(i), e(i), de(i), d2e(i))
      end do
   end subroutine evaluate

end module deviation_calls
