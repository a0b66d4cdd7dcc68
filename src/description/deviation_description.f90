!> Case parameters of the flank deviations of a wheel, and their validation.
module evl_deviation_description
   use evl_flank_deviation, only: flank_deviation_t, relief_t
   use evl_kinds, only: pi, wp
   use evl_parameter_view, only: parameter_view_t
   use evl_pitch_errors, only: pitch_errors_generate, pitch_tolerances
  use evl_row, only: not_negative, positive, range_t, row_t, span_t, type_block, type_choice, type_integer, type_number, type_series
   use evl_status, only: code_invalid_input, degrees, fail, has_failed, quantity, status_t, subject_wheel
   implicit none (type, external)
   private

   public :: deviation_create, has_deviation, profile_t

   ! rows of the flank deviations of a wheel
   type(row_t), parameter, public :: &
      deviation_rows(*) = [ &
      row_t("tip_relief", type_block, "", "tip relief: material removed towards the tip", holds="relief", variants="+module"), &
      row_t("root_relief", type_block, "", "root relief: material removed towards the start of the active profile", &
            holds="relief", &
            variants="+module"), &
      row_t("profile_crowning", type_number, "m", &
            "profile crowning C_alpha: material removed at both ends of the active profile; parabolic, 0 in the middle", &
            range=not_negative, &
            default="0", variants="+module", plausible=span_t(1.0e-8_wp, 1.0e-3_wp)), &
      row_t("pitch_errors", type_series, "m", &
            "cumulative pitch deviation of each tooth, arc on the reference circle, counterclockwise positive", &
            variants="+module", plausible=span_t(0.0_wp, 1.0e-3_wp)), &
      row_t("accuracy", type_block, "", "pitch errors from a flank tolerance class, instead of pitch_errors", holds="accuracy", &
            variants="+module"), &
      row_t("eccentricity", type_block, "", "eccentricity of the gear teeth relative to the axle", holds="eccentricity", &
            variants="+module")]

   type(row_t), parameter, public :: &
      relief_rows(*) = [ &
      row_t("amount", type_number, "m", "amount of relief at the end of the profile, along the profile normal", &
            range=not_negative, &
            required=.true., plausible=span_t(1.0e-8_wp, 1.0e-3_wp)), &
      row_t("diameter", type_number, "m", "diameter at the start of the relief", &
            range=positive, plausible=span_t(1.0e-4_wp, 5.0_wp)), &
      row_t("roll_angle", type_number, "deg", "roll angle at the start of the relief; alternative to diameter", range=positive, &
            plausible=span_t(0.1_wp, 90.0_wp)), &
      row_t("shape", type_choice, "", "shape over the roll angle; parabolic: without a kink at the start", default="linear", &
            words="linear parabolic")]

   type(row_t), parameter, public :: accuracy_rows(*) = [ &
                        row_t("class", type_integer, "", "flank tolerance class, ISO 1328-1:2013", range=range_t(1.0_wp, 11.0_wp), &
                                           required=.true.), &
                                  row_t("seed", type_integer, "", "seed of the random numbers; wheels with the same seed have the" &
                                           //" same random numbers", &
                                           range=range_t(0.0_wp, 1000000000.0_wp), default="0")]

   type(row_t), parameter, public :: &
      eccentricity_rows(*) = [ &
      row_t("amount", type_number, "m", "eccentricity e_c: distance of the centre of the teeth from the axle; alternative to" &
            //" radial_runout", &
            range=not_negative, variants="-radial_runout", plausible=span_t(1.0e-8_wp, 2.0e-3_wp)), &
      row_t("radial_runout", type_number, "m", "measured radial runout F_r of a gear without other errors; e_c = F_r/2", &
            range=not_negative, plausible=span_t(2.0e-8_wp, 4.0e-3_wp)), &
      row_t("phase", type_number, "deg", "direction of the eccentricity from the middle of tooth 0, counterclockwise positive", &
            range=range_t(-360.0_wp, 360.0_wp), default="0", plausible=span_t(0.0_wp, 360.0_wp))]

   real(wp), parameter :: largest = 0.1_wp !! maximum deviation in modules; larger ones are rejected

   !> Profile of a flank with deviations.
   type :: profile_t
      integer :: teeth = 0
      real(wp) :: base_radius = 0.0_wp      !! r_b [m]
      real(wp) :: reference_radius = 0.0_wp !! radius on which pitch errors are arcs [m]
      real(wp) :: rho_start = 0.0_wp        !! radius of curvature at the start of the active profile [m]
      real(wp) :: rho_tip = 0.0_wp          !! radius of curvature at the tip [m]
      real(wp) :: tooth_angle = 0.0_wp      !! psi_b, tooth thickness angle on the base circle [rad]; 0 if unknown
   end type profile_t

contains

   !> Whether a wheel has any flank deviation.
   logical function has_deviation(wheel)
      type(parameter_view_t), intent(in) :: wheel
      type(parameter_view_t) :: tip, root

      has_deviation = .false.
      if (.not. (wheel%has("tip_relief") .or. wheel%has("root_relief") .or. wheel%has("eccentricity") .or. &
                 wheel%has("profile_crowning") .or. wheel%has("accuracy") .or. wheel%has("pitch_errors"))) return
      call wheel%inner("tip_relief", tip)
      call wheel%inner("root_relief", root)
      has_deviation = any([tip%number("amount"), root%number("amount"), wheel%number("profile_crowning"), &
                           eccentricity_of(wheel)] > 0) .or. wheel%has("accuracy") .or. wheel%has("pitch_errors") &
                      .or. has_open_eccentricity(wheel)
   end function has_deviation

   !> Distance of the teeth's centre from the axle [m]; 0 if none is given.
   real(wp) function eccentricity_of(wheel) result(eccentricity)
      type(parameter_view_t), intent(in) :: wheel
      type(parameter_view_t) :: block

      eccentricity = 0
      if (.not. wheel%has("eccentricity")) return
      call wheel%inner("eccentricity", block)
      if (block%has("radial_runout")) then
         eccentricity = block%number("radial_runout")/2
      else
         eccentricity = block%number("amount")
      end if
   end function eccentricity_of

   !> Whether an eccentricity is given without its size.
   logical function has_open_eccentricity(wheel) result(is_open)
      type(parameter_view_t), intent(in) :: wheel
      type(parameter_view_t) :: block

      call wheel%inner("eccentricity", block)
      is_open = wheel%has("eccentricity") .and. .not. (block%has("amount") .or. block%has("radial_runout"))
   end function has_open_eccentricity

   !> Compute the flank deviations of a wheel.
   !>
   !> Tip relief reaches its amount at the tip, root relief at the start of the active profile. From its start, relief is linear or
   !> quadratic in the length of roll. Pitch errors are arcs on the reference circle; along the normal they are multiplied by r_b/r.
   !> Errors: code_invalid_input with subject_wheel, without index, and the field as in the case file.
   subroutine deviation_create(wheel, profile, deviation, status)
      type(parameter_view_t), intent(in) :: wheel
      type(profile_t), intent(in) :: profile
      type(flank_deviation_t), intent(out) :: deviation
      type(status_t), intent(inout) :: status
      type(parameter_view_t) :: eccentricity

      deviation%exists = has_deviation(wheel)
      deviation%teeth = profile%teeth
      deviation%base_radius = profile%base_radius
      deviation%half_tooth = profile%tooth_angle/2
      call take_relief(wheel, "tip_relief", profile, profile%rho_tip, deviation%tip, status)
      call take_relief(wheel, "root_relief", profile, profile%rho_start, deviation%root, status)
      if (has_failed(status)) return
      if (deviation%tip%amount > 0 .and. deviation%root%amount > 0 .and. deviation%tip%border < deviation%root%border) then
         call refuse("tip relief starts at a roll angle of "//degrees(deviation%tip%border/profile%base_radius) &
                     //", below that of root relief at "//degrees(deviation%root%border/profile%base_radius) &
                     //"; the two must not overlap", "tip_relief", status)
         return
      end if
      deviation%crowning = wheel%number("profile_crowning")
      call check_size(deviation%crowning, "profile_crowning", profile, status)
      deviation%middle = (profile%rho_start + profile%rho_tip)/2
      deviation%half_length = (profile%rho_tip - profile%rho_start)/2
      deviation%eccentricity = eccentricity_of(wheel)
      call wheel%inner("eccentricity", eccentricity)
      deviation%phase = eccentricity%number("phase")
      if (profile%base_radius < 0) deviation%phase = deviation%phase + pi ! negative radii: half a turn away
      if (has_open_eccentricity(wheel)) then
         call refuse("needs either 'amount', the distance of the teeth's centre from the axle, or 'radial_runout', twice that" &
                     //" distance", "eccentricity", status)
      end if
      call take_pitch_errors(wheel, profile, deviation, status)
   end subroutine deviation_create

   !> Pitch errors along the normal, from a list or from an accuracy class. Equation D10.
   subroutine take_pitch_errors(wheel, profile, deviation, status)
      type(parameter_view_t), intent(in) :: wheel
      type(profile_t), intent(in) :: profile
      type(flank_deviation_t), intent(inout) :: deviation
      type(status_t), intent(inout) :: status
      type(parameter_view_t) :: accuracy
      real(wp), allocatable :: pitch(:)
      real(wp) :: single, total
      character(len=80) :: text

      if (.not. (wheel%has("accuracy") .or. wheel%has("pitch_errors"))) return
      pitch = wheel%numbers("pitch_errors")
      if (wheel%has("accuracy") .and. wheel%has("pitch_errors")) then
         call refuse("pitch errors are listed and generated from a class; give pitch_errors or accuracy, not both", "accuracy", &
                     status)
      else if (wheel%has("accuracy")) then
         call wheel%inner("accuracy", accuracy)
         call pitch_tolerances(profile%teeth, 2*abs(profile%reference_radius)/profile%teeth, accuracy%whole("class"), single, &
                               total, status)
         if (has_failed(status)) return
         deallocate (pitch)
         allocate (pitch(profile%teeth))
         call pitch_errors_generate(single, total, accuracy%whole("seed"), pitch)
      else if (size(pitch) /= profile%teeth) then
         write (text, "(i0, a, i0, a)") size(pitch), " pitch errors are given for ", profile%teeth, &
            " teeth; give one for each tooth"
         call refuse(trim(text), "pitch_errors", status)
      else if (size(pitch) > 0) then
         call check_size(pitch(maxloc(abs(pitch), dim=1)), "pitch_errors", profile, status)
      end if
      if (has_failed(status)) return
      allocate (deviation%pitch(0:profile%teeth - 1))
      ! an arc of a ring counts along its negative radii
      deviation%pitch(:) = pitch*(profile%base_radius/abs(profile%reference_radius))
   end subroutine take_pitch_errors

   !> A relief; its start must be within the active profile. Equation D19.
   subroutine take_relief(wheel, field, profile, rho_end, relief, status)
      type(parameter_view_t), intent(in) :: wheel
      character(len=*), intent(in) :: field   !! "tip_relief" or "root_relief"
      type(profile_t), intent(in) :: profile
      real(wp), intent(in) :: rho_end         !! radius of curvature at which the relief reaches its amount [m]
      type(relief_t), intent(inout) :: relief
      type(status_t), intent(inout) :: status
      type(parameter_view_t) :: input
      real(wp) :: rho, diameter

      call wheel%inner(field, input)
      if (has_failed(status) .or. .not. input%number("amount") > 0) return
      if (input%has("diameter") .eqv. input%has("roll_angle")) then
         call refuse("needs either 'diameter' or 'roll_angle', where it starts" &
                     //trim(merge("; it has both", "             ", input%has("diameter"))), field, status)
         return
      end if
      rho = -1
      diameter = input%number("diameter")
      if (input%has("roll_angle")) then
         rho = profile%base_radius*input%number("roll_angle")
      else if (diameter >= 2*abs(profile%base_radius)) then
         rho = sign(sqrt((diameter/2 - profile%base_radius)*(diameter/2 + profile%base_radius)), profile%base_radius)
      end if
      if (.not. (rho > profile%rho_start .and. rho < profile%rho_tip)) then
         if (input%has("roll_angle")) then
            call refuse("a relief that starts at a roll angle of "//degrees(input%number("roll_angle"))//" does not start on" &
                        //" the active profile, which goes from "//degrees(profile%rho_start/profile%base_radius)//" to " &
                        //degrees(profile%rho_tip/profile%base_radius), field//".roll_angle", status)
         else
            call refuse("a relief that starts at a diameter of "//quantity(diameter, "m")//" does not start on the active" &
                        //" profile, which goes from "//quantity(2*hypot(profile%rho_start, profile%base_radius), "m")//" to " &
                        //quantity(2*hypot(profile%rho_tip, profile%base_radius), "m"), field//".diameter", status)
         end if
         return
      end if
      relief%amount = input%number("amount")
      call check_size(relief%amount, field//".amount", profile, status)
      relief%border = rho
      relief%taken = rho
      relief%length = rho_end - rho
      relief%parabolic = input%word("shape") == "parabolic"
   end subroutine take_relief

   !> Reject deviations above a tenth of a module: first-order geometry is not valid there, and the unit is probably wrong.
   subroutine check_size(length, field, profile, status)
      real(wp), intent(in) :: length !! deviation [m]
      character(len=*), intent(in) :: field
      type(profile_t), intent(in) :: profile
      type(status_t), intent(inout) :: status
      real(wp), parameter :: um = 1.0e-6_wp, mm = 1.0e-3_wp
      real(wp) :: most

      most = largest*2*abs(profile%reference_radius)/profile%teeth
      if (.not. abs(length) > most) return
      if (abs(length)*um <= most .and. abs(length) > mm) then
         call refuse(quantity(length, "m")//" is more than 0.1 modules, "//quantity(most/um, "um")//"; did you mean " &
                     //quantity(length/merge(mm, 1.0_wp, abs(length) <= 1), "um")//"?", field, status)
      else
         call refuse(quantity(length/um, "um")//" is more than 0.1 modules, "//quantity(most/um, "um") &
                     //"; give less, or another unit", field, status)
      end if
   end subroutine check_size

   !> Report an invalid parameter, unless an error was reported before.
   subroutine refuse(message, field, status)
      character(len=*), intent(in) :: message, field
      type(status_t), intent(inout) :: status

      if (.not. has_failed(status)) call fail(status, code_invalid_input, message, subject_wheel, field=field)
   end subroutine refuse

end module evl_deviation_description
