!> Inspection dimensions and tolerances of a data sheet.
module evl_datasheet_inspection
   use evl_datasheet_rows, only: add_row, no_rack, note_length, sheet_t
   use evl_flank_tolerances, only: flank_tolerances_of, flank_tolerances_t
   use evl_gear, only: gear_t
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: nan, wp
   use evl_tooth_measures, only: ball_diameter, ball_measure, measure_above, measure_below, measure_in_root, measure_in_space, &
                                 measure_valid, span_measure, span_teeth
   implicit none (type, external)
   private

   public :: add_inspection, add_tolerances, tolerances_of

contains

   !> Base tangent length and dimension over balls, of the teeth with their allowance.
   subroutine add_inspection(gears, to)
      type(gear_t), intent(in) :: gears(2)
      type(sheet_t), intent(inout) :: to
      real(wp), dimension(2) :: k, span, ball, over
      integer :: i, validity
      character(len=*), parameter :: actual = "of the teeth with their thickness allowance"
      character(len=note_length) :: span_note, ball_note

      k = nan
      span = nan
      ball = nan
      over = nan
      span_note = ""
      ball_note = ""
      do i = 1, 2
         if (gears(i)%teeth == 0) then
            call join(span_note, i, no_rack)
            call join(ball_note, i, no_rack)
            cycle
         end if
         k(i) = gears(i)%span_teeth
         if (gears(i)%span_teeth == 0) k(i) = span_teeth(gears(i))
         call span_measure(gears(i), nint(k(i)), span(i), validity)
         if (validity /= measure_valid) call join(span_note, i, "k "//trim(why_not(validity))//"; give span_teeth")
         ball(i) = gears(i)%ball_diameter
         if (.not. gears(i)%ball_diameter > 0) ball(i) = ball_diameter(gears(i))
         call ball_measure(gears(i), ball(i), over(i), validity)
         if (validity /= measure_valid) call join(ball_note, i, "D_M "//trim(why_not(validity))//"; give ball_diameter")
      end do
      if (all(gears%teeth == 0)) then
         span_note = no_rack
         ball_note = no_rack
      end if
      to%section = "Inspection"
      call add_row(to, "span_teeth", "k", "1", "teeth of the base tangent length", k, reason=no_rack)
      call add_row(to, "base_tangent_length", "W_k", "m", "base tangent length", span, note=actual, reason=trim(span_note))
      call add_row(to, "ball_diameter", "D_M", "m", "diameter of the measuring balls", ball, reason=no_rack)
      call add_row(to, "dimension_over_balls", "M_dK", "m", "dimension over balls", over, note=actual, &
                   reason=trim(ball_note))
   end subroutine add_inspection

   !> Append a reason of one gear.
   subroutine join(note, side, reason)
      character(len=note_length), intent(inout) :: note
      integer, intent(in) :: side
      character(len=*), intent(in) :: reason

      if (len_trim(note) > 0) note = trim(note)//"; "
      note = trim(note)//" "//trim(merge("driving", "driven ", side == 1))//": "//reason
      note = adjustl(note)
   end subroutine join

   !> Why a measure does not exist.
   pure character(len=40) function why_not(validity) result(reason)
      integer, intent(in) :: validity

      select case (validity)
      case (measure_below)
         reason = "touches below the form circle"
      case (measure_above)
         reason = "touches above the tip form circle"
      case (measure_in_space)
         reason = "does not reach the tip circle"
      case (measure_in_root)
         reason = "touches the root circle"
      case default
         reason = ""
      end select
   end function why_not

   !> Tolerances of the class of a wheel; NaN without a class.
   type(flank_tolerances_t) function tolerances_of(gearbox, wheel) result(t)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: wheel

      associate (gear => gearbox%gears(wheel), class => gearbox%wheels(wheel)%tolerance_class)
         if (class > 0) t = flank_tolerances_of(int(gear%teeth), real(gear%normal_module, wp), gearbox%wheels(wheel)%width, class)
      end associate
   end function tolerances_of

   !> Tolerances of the flank tolerance classes; no rows if no gear has one.
   subroutine add_tolerances(gearbox, wheels, to)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: wheels(2) !! driving, driven
      type(sheet_t), intent(inout) :: to
      character(len=*), parameter :: reason = "no tolerance class, or outside the limits of the standard"
      type(flank_tolerances_t) :: t(2)
      integer :: classes(2)

      classes = gearbox%wheels(wheels)%tolerance_class
      if (all(classes == 0)) return
      t = [tolerances_of(gearbox, wheels(1)), tolerances_of(gearbox, wheels(2))]
      to%section = "Tolerances, ISO 1328-1:2013"
      call add_row(to, "tolerance_class", "A", "1", "flank tolerance class", merge(real(classes, wp), nan, classes > 0), &
                   reason=reason)
      call add_row(to, "single_pitch_tolerance", "f_pT", "m", "single pitch", t%single_pitch, reason=reason)
      call add_row(to, "total_pitch_tolerance", "F_pT", "m", "total cumulative pitch", t%total_pitch, reason=reason)
      call add_row(to, "profile_slope_tolerance", "f_HalphaT", "m", "profile slope", t%profile_slope, reason=reason)
      call add_row(to, "profile_form_tolerance", "f_falphaT", "m", "profile form", t%profile_form, reason=reason)
      call add_row(to, "total_profile_tolerance", "F_alphaT", "m", "total profile", t%total_profile, reason=reason)
      call add_row(to, "helix_slope_tolerance", "f_HbetaT", "m", "helix slope", t%helix_slope, reason=reason)
      call add_row(to, "helix_form_tolerance", "f_fbetaT", "m", "helix form", t%helix_form, reason=reason)
      call add_row(to, "total_helix_tolerance", "F_betaT", "m", "total helix", t%total_helix, reason=reason)
   end subroutine add_tolerances

end module evl_datasheet_inspection
