!> The description that the flank deviations of a wheel are made from, and whether its numbers make sense.
module evl_deviation_description
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use evl_flank_deviation, only: flank_deviation_t, relief_t
   use evl_kinds, only: pi, wp
   use evl_pitch_errors, only: pitch_errors_generate, pitch_tolerances
   use evl_status, only: code_invalid_input, degrees, fail, has_failed, quantity, status_t, subject_wheel
   implicit none (type, external)
   private

   public :: deviation_input, profile_t, relief_input
   public :: deviation_create, has_deviation
   public :: relief_linear, relief_parabolic

   integer, parameter :: relief_linear = 0    !! constant slope
   integer, parameter :: relief_parabolic = 1 !! slope 0 at its start

   !> A relief as described; see `evl_relief` in the C header.
   type :: relief_input
      real(wp) :: amount = 0.0_wp           !! [m]
      logical :: by_roll_angle = .false.    !! what `start` is
      real(wp) :: start = 0.0_wp            !! diameter [m] or roll angle [rad]
      integer :: shape = relief_linear
   end type relief_input

   !> All deviations of a wheel as described; see `evl_flank_deviation` in the C header.
   type :: deviation_input
      type(relief_input) :: tip, root
      real(wp) :: crowning = 0.0_wp         !! [m]
      real(wp), allocatable :: pitch(:)     !! cumulative position deviations [m]; not allocated or none: no errors
      integer :: class = 0                  !! flank tolerance class; 0: none
      integer :: seed = 0
      real(wp) :: eccentricity = 0.0_wp     !! [m]
      real(wp) :: phase = 0.0_wp            !! [rad]
   end type deviation_input

   !> The profile that deviates.
   type :: profile_t
      integer :: teeth = 0
      real(wp) :: base_radius = 0.0_wp      !! r_b [m]
      real(wp) :: reference_radius = 0.0_wp !! on which pitches are arcs [m]
      real(wp) :: rho_start = 0.0_wp        !! radius of curvature at the start of the active profile [m]
      real(wp) :: rho_tip = 0.0_wp          !! radius of curvature at the tip [m]
      real(wp) :: tooth_angle = 0.0_wp      !! psi_b, that a tooth fills on the base circle [rad]; 0 if not known
   end type profile_t

contains

   !> Whether a description asks for any deviation, a wrong one included.
   pure logical function has_deviation(given)
      type(deviation_input), intent(in) :: given

      has_deviation = .not. all(abs([given%tip%amount, given%root%amount, given%crowning, given%eccentricity]) <= 0) &
                      .or. given%class /= 0
      if (allocated(given%pitch)) has_deviation = has_deviation .or. size(given%pitch) > 0
   end function has_deviation

   !> Make the deviations of a wheel.
   !>
   !> Relief reaches its amount at the tip, root relief at the start of the active profile; between its start and there it is
   !> linear or quadratic in the length of roll. Pitch errors are arcs on the reference circle; along the normal they are
   !> r_b/r as large.
   !> Errors: code_invalid_input with subject_wheel, without index, and the field as in the case file.
   subroutine deviation_create(given, profile, deviation, status)
      type(deviation_input), intent(in) :: given
      type(profile_t), intent(in) :: profile
      type(flank_deviation_t), intent(out) :: deviation
      type(status_t), intent(inout) :: status
      real(wp) :: single, total

      call check_amounts(given, status)
      if (has_failed(status)) return
      deviation%exists = has_deviation(given)
      deviation%teeth = profile%teeth
      deviation%base_radius = profile%base_radius
      deviation%half_tooth = profile%tooth_angle/2
      call take_relief(given%tip, "tip_relief", profile, profile%rho_tip, deviation%tip, status)
      call take_relief(given%root, "root_relief", profile, profile%rho_start, deviation%root, status)
      if (has_failed(status)) return
      if (given%tip%amount > 0 .and. given%root%amount > 0 .and. deviation%tip%border < deviation%root%border) then
         call refuse("tip relief starts at a roll angle of "//degrees(deviation%tip%border/profile%base_radius) &
                     //", below that of root relief at "//degrees(deviation%root%border/profile%base_radius) &
                     //": the two must not overlap", "tip_relief", status)
         return
      end if
      deviation%crowning = given%crowning
      deviation%middle = (profile%rho_start + profile%rho_tip)/2
      deviation%half_length = (profile%rho_tip - profile%rho_start)/2
      deviation%eccentricity = given%eccentricity
      deviation%phase = given%phase
      if (given%class /= 0) then
         call pitch_tolerances(profile%teeth, 2*profile%reference_radius/profile%teeth, given%class, single, total, status)
         if (has_failed(status)) return
         allocate (deviation%pitch(0:profile%teeth - 1))
         call pitch_errors_generate(single, total, given%seed, deviation%pitch)
      else if (has_pitch_errors(given)) then
         call check_pitch(given%pitch, profile%teeth, status)
         if (has_failed(status)) return
         allocate (deviation%pitch(0:profile%teeth - 1))
         deviation%pitch(:) = given%pitch
      end if
      if (allocated(deviation%pitch)) &
         deviation%pitch(:) = deviation%pitch*(profile%base_radius/profile%reference_radius)
   end subroutine deviation_create

   !> Whether pitch errors are listed.
   pure logical function has_pitch_errors(given)
      type(deviation_input), intent(in) :: given

      has_pitch_errors = .false.
      if (allocated(given%pitch)) has_pitch_errors = size(given%pitch) > 0
   end function has_pitch_errors

   !> Amounts are finite and not negative; pitch errors come from one source.
   pure subroutine check_amounts(given, status)
      type(deviation_input), intent(in) :: given
      type(status_t), intent(inout) :: status

      call check_amount(given%tip%amount, "tip_relief.amount", status)
      call check_amount(given%root%amount, "root_relief.amount", status)
      call check_amount(given%crowning, "profile_crowning", status)
      call check_amount(given%eccentricity, "runout.amount", status)
      if (.not. ieee_is_finite(given%phase)) call refuse("phase must be a finite number", "runout.phase", status)
      if (has_pitch_errors(given) .and. given%class /= 0) &
         call refuse("pitch errors are listed and generated from a class: give pitch_errors or accuracy, not both", "accuracy", &
                     status)
   end subroutine check_amounts

   !> A length that is finite and not negative.
   pure subroutine check_amount(amount, field, status)
      real(wp), intent(in) :: amount
      character(len=*), intent(in) :: field
      type(status_t), intent(inout) :: status

      if (ieee_is_finite(amount) .and. amount >= 0) return
      call refuse(field//" = "//quantity(amount, "m")//" must be a finite number, not negative", field, status)
   end subroutine check_amount

   !> One finite error for each tooth.
   pure subroutine check_pitch(pitch, teeth, status)
      real(wp), intent(in) :: pitch(:)
      integer, intent(in) :: teeth
      type(status_t), intent(inout) :: status
      character(len=80) :: text

      if (size(pitch) /= teeth) then
         write (text, "(i0, a, i0, a)") size(pitch), " pitch errors are given for ", teeth, " teeth; give one for each tooth"
         call refuse(trim(text), "pitch_errors", status)
      else if (.not. all(ieee_is_finite(pitch))) then
         call refuse("pitch errors must be finite numbers", "pitch_errors", status)
      end if
   end subroutine check_pitch

   !> A relief whose start lies within the active profile.
   pure subroutine take_relief(given, field, profile, rho_end, relief, status)
      type(relief_input), intent(in) :: given
      character(len=*), intent(in) :: field   !! "tip_relief" or "root_relief"
      type(profile_t), intent(in) :: profile
      real(wp), intent(in) :: rho_end         !! where the relief reaches its amount [m]
      type(relief_t), intent(inout) :: relief
      type(status_t), intent(inout) :: status
      real(wp) :: rho

      if (has_failed(status) .or. .not. given%amount > 0) return
      if (all(given%shape /= [relief_linear, relief_parabolic])) then
         call refuse("there is no such shape of a relief", field//".shape", status)
         return
      end if
      rho = -1
      if (given%by_roll_angle) then
         if (ieee_is_finite(given%start)) rho = profile%base_radius*given%start
      else if (ieee_is_finite(given%start) .and. given%start >= 2*profile%base_radius) then
         rho = sqrt((given%start/2 - profile%base_radius)*(given%start/2 + profile%base_radius))
      end if
      if (.not. (rho > profile%rho_start .and. rho < profile%rho_tip)) then
         if (given%by_roll_angle) then
            call refuse("a relief that starts at a roll angle of "//degrees(given%start)//" does not start on the active" &
                        //" profile, which goes from "//degrees(profile%rho_start/profile%base_radius)//" to " &
                        //degrees(profile%rho_tip/profile%base_radius), field//".roll_angle", status)
         else
            call refuse("a relief that starts at a diameter of "//quantity(given%start, "m")//" does not start on the active" &
                        //" profile, which goes from "//quantity(2*hypot(profile%rho_start, profile%base_radius), "m")//" to " &
                        //quantity(2*hypot(profile%rho_tip, profile%base_radius), "m"), field//".diameter", status)
         end if
         return
      end if
      relief%amount = given%amount
      relief%border = rho
      relief%length = rho_end - rho
      relief%parabolic = given%shape == relief_parabolic
   end subroutine take_relief

   !> Write the first refusal down.
   pure subroutine refuse(message, field, status)
      character(len=*), intent(in) :: message, field
      type(status_t), intent(inout) :: status

      if (.not. has_failed(status)) call fail(status, code_invalid_input, message, subject_wheel, field=field)
   end subroutine refuse

end module evl_deviation_description
