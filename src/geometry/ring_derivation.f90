!> Root of an internal gear from its description: an arc, or the fillet of a pinion-type cutter.
module evl_ring_derivation
   use evl_cutter_generation, only: cutter_fit_t, cutter_t
   use evl_gear, only: agreement, gear_cutter_fit, gear_t, is_outside
   use evl_involute_angle, only: involute_of_tangent
   use evl_kinds, only: wp
   use evl_parameter_view, only: parameter_view_t
   use evl_ring_root, only: largest_fillet, ring_form_curvature
   use evl_status, only: code_invalid_input, fail, quantity, status_t, subject_wheel
   implicit none (type, external)
   private

   public :: derive_ring_root

contains

   !> Root circle, arc or fillet of the cutter, and form circle of a ring.
   subroutine derive_ring_root(input, arc, gear, status)
      type(parameter_view_t), intent(in) :: input
      real(wp), intent(in) :: arc !! radius of the arc, if none is given [m]
      type(gear_t), intent(inout) :: gear
      type(status_t), intent(inout) :: status
      type(parameter_view_t) :: fillet, cutter
      real(wp) :: largest

      call input%inner("fillet", fillet)
      if (fillet%has("cutter")) then
         call fillet%inner("cutter", cutter)
         if (fillet%has("radius")) then
            call refuse(status, "fillet.radius", "a fillet has a radius or a cutter; give one of the two")
         else
            call derive_cut_root(cutter, gear, status)
         end if
         return
      end if
      if (.not. is_outside(gear, gear%root_radius, gear%base_radius)) then
         call refuse(status, "rack.dedendum", "the root circle, diameter "//quantity(-2*gear%root_radius, "m")//", must lie" &
                     //" outside the base circle, diameter "//quantity(-2*gear%base_radius, "m"))
         return
      end if
      largest = largest_fillet(int(gear%teeth), -real(gear%base_radius, wp), -real(gear%root_radius, wp), &
                               real(gear%tooth_angle, wp))
      if (.not. largest > 0) then
         call refuse(status, "profile_shift", "the spaces between the teeth of this internal gear are closed at its root circle," &
                     //" diameter "//quantity(-2*gear%root_radius, "m")//"; choose a smaller profile shift or dedendum")
         return
      end if
      gear%fillet_radius = min(arc, largest)
      if (fillet%has("radius")) gear%fillet_radius = fillet%number("radius")
      if (gear%fillet_radius > largest) then
         call refuse(status, "fillet.radius", "a fillet of "//quantity(real(gear%fillet_radius, wp), "m") &
                     //" does not fit into the spaces of this internal gear; the full round has "//quantity(largest, "m"))
         return
      end if
      gear%form_radius = -hypot(gear%base_radius, ring_form_curvature(-real(gear%base_radius, wp), -real(gear%root_radius, wp), &
                                                                      real(gear%fillet_radius, wp)))
   end subroutine derive_ring_root

   !> Root of a ring cut by a pinion-type cutter.
   subroutine derive_cut_root(input, gear, status)
      type(parameter_view_t), intent(in) :: input !! block of the cutter
      type(gear_t), intent(inout) :: gear
      type(status_t), intent(inout) :: status
      type(cutter_t) :: cutter
      type(cutter_fit_t) :: fit
      character(len=*), parameter :: block = "fillet.cutter."

      cutter = cutter_t(input%whole("teeth"), input%number("profile_shift"), input%number("tip_diameter")/2, &
                        input%number("tip_rounding"))
      if (cutter%teeth >= gear%teeth) then
         call refuse(status, block//"teeth", "a cutter needs fewer teeth than the internal gear that it cuts")
         return
      end if
      gear%cutter_teeth = cutter%teeth
      gear%cutter_shift = cutter%shift
      gear%cutter_tip_radius = cutter%tip_radius
      gear%cutter_rounding = cutter%rounding
      fit = gear_cutter_fit(gear)
      associate (alpha => gear%pressure_angle)
         if (.not. fit%involute > 0) then
            call refuse(status, block//"profile_shift", "the cutter does not reach the gear: its profile shift and the generating" &
                        //" shift of the gear add up to "//quantity(cutter%shift + gear%generating_shift, "")//", at most " &
                        //quantity(involute_of_tangent(tan(alpha))*(gear%teeth - cutter%teeth)/(2*tan(alpha)), ""))
            return
         end if
      end associate
      if (.not. fit%centre > max(fit%base_radius, fit%pitch_radius)) then
         call refuse(status, block//"tip_diameter", "the centre of the cutter's tip rounding, at the diameter " &
                     //quantity(2*fit%centre, "m")//", must lie outside its base circle and its pitch circle in the cut," &
                     //" diameter "//quantity(2*max(fit%base_radius, fit%pitch_radius), "m"))
      else if (fit%delta < 0) then
         call refuse(status, block//"tip_rounding", "the two roundings of the cutter's tip, "//quantity(cutter%rounding, "m") &
                     //", overlap; give at most "//quantity(largest_rounding(), "m"))
      else
         gear%fillet_radius = 0
         gear%root_radius = fit%root_radius
         gear%form_radius = -hypot(gear%base_radius, fit%form_curvature)
      end if

   contains

      !> Largest rounding of the cutter's tip, by bisection [m].
      real(wp) function largest_rounding() result(low)
         type(gear_t) :: other
         type(cutter_fit_t) :: trial
         real(wp) :: high, middle

         other = gear
         low = 0
         high = cutter%rounding
         do
            middle = 0.5_wp*(low + high)
            if (.not. high - low > agreement*high) return
            other%cutter_rounding = middle
            trial = gear_cutter_fit(other)
            if (trial%delta >= 0) then
               low = middle
            else
               high = middle
            end if
         end do
      end function largest_rounding

   end subroutine derive_cut_root

   !> Report an error of a wheel.
   pure subroutine refuse(status, field, message)
      type(status_t), intent(inout) :: status
      character(len=*), intent(in) :: field, message

      call fail(status, code_invalid_input, message, subject_wheel, field=field)
   end subroutine refuse

end module evl_ring_derivation
