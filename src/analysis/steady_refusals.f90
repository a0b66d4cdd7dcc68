!> Reasons why there is no steady state: an unsupported start, a load of the wrong sense, a slope of flanks, or a pair at the end
!> of its path.
module evl_steady_refusals
   use evl_contacts_at_state, only: look_at
   use evl_deviating_flanks, only: flank_value, flanks_turned
   use evl_discrete_state, only: flanks_of, take_mode, tooth_pair_of
   use evl_gearbox, only: gearbox_t, wheel_speed
   use evl_housing, only: housing_prescribed
   use evl_indices, only: joined_to
   use evl_kinds, only: wp
   use evl_load, only: load_point
   use evl_start_positions, only: closed_form_point, gearbox_state
   use evl_status, only: code_no_solution, fail, message_length, quantity, status_t, subject_housing, subject_initial, &
                         subject_load, subject_mesh
   use evl_tooth_contact, only: contact_state, flank_coast, flank_values, flanks_loaded, flanks_off, tooth_contact_t, unclipped
   use evl_wheel_loads, only: load_torque, segment_of
   implicit none (type, external)
   private

   public :: check_pressed, check_steady, refuse_alternation, refuse_slope

   real(wp), parameter :: touching = 1.0e-6_wp !! gap over the penetration scale of flanks in contact without load

contains

   !> Check that a steady state can exist: no prescribed speed changes, and at most one is prescribed.
   subroutine check_steady(gearbox, integers, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: integers(:)
      type(status_t), intent(inout) :: status
      logical :: prescribes(size(gearbox%loads))
      integer :: i

      if (gearbox%housing%kind == housing_prescribed) then
         call fail(status, code_no_solution, "a steady start requires a fixed or mounted housing, but its motion is" &
                   //" prescribed; start from rest or with given speeds", subject_initial, field="kind")
         return
      else if (norm2([gearbox%housing%velocity, gearbox%housing%omega]) > 0) then
         call fail(status, code_no_solution, "a steady start has a housing without velocity", subject_housing, field="velocity")
         return
      end if
      prescribes = [(gearbox%loads(i)%load%prescribes, i=1, size(gearbox%loads))]
      if (count(prescribes) > 1) then
         call fail(status, code_no_solution, "a steady start requires at most one prescribed speed, but several wheels have" &
                   //" one; start with given speeds", subject_initial, field="kind")
         return
      end if
      do i = 1, size(gearbox%loads)
         if (.not. abs(gearbox%loads(i)%load%acceleration(segment_of(gearbox%loads(i)%load, integers))) > 0) cycle
         call fail(status, code_no_solution, "the prescribed speed of a wheel changes at the start, which is not a steady state", &
                   subject_load, i, "time")
         return
      end do
   end subroutine check_steady

   !> Check that the force of every loaded tooth pair is compressive.
   !> Errors: code_no_solution with the load of the wrong sense, the mesh without load, or the pair under tension.
   subroutine check_pressed(gearbox, state, status)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(in) :: state
      type(status_t), intent(inout) :: status
      type(contact_state) :: at(size(gearbox%contacts))
      integer :: first, last, m

      do m = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(m), h => at(m)%point%h)
            if (flanks_of(contact, state%integers) /= flanks_loaded .or. contact%flank == flank_coast) cycle
            call gearbox%flanks(contact%i_flank)%flank%loaded_pairs_range(m, first, last)
            call look_at(gearbox, first, last, state%y, state%integers, state%reals, at, status)
            if (contact%rigid) then
               if (state%y(contact%i_normal) > 0) cycle
            else if (h > -touching*contact%h_scale) then
               if (unclipped(at(m)) >= 0 .or. .not. h > 0) cycle
               call refuse_slope(gearbox, state, status)
               return
            end if
            call refuse_pull(gearbox, contact, state, h, status)
            return
         end associate
      end do
   end subroutine check_pressed

   !> Report the load of the wrong sense that separates the drive flanks of a mesh.
   subroutine refuse_pull(gearbox, contact, state, h, status)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(in) :: state
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: h
      type(status_t), intent(inout) :: status
      character(len=16) :: number
      character(len=message_length) :: consequence
      integer :: i

      write (number, "(a, i0)") "meshes.", contact%mesh - 1
      i = wrong_load(gearbox, contact, state)
      if (i == 0 .and. contact%deviates) then
         call refuse_slope(gearbox, state, status)
         return
      else if (i == 0) then
         call fail(status, code_no_solution, "there is no steady state: no load closes its drive flanks, which would have to" &
                   //" pull (penetration "//quantity(h, "m")//"); start from rest or with given speeds", subject_mesh, &
                   contact%mesh, "driving_rotation")
         return
      end if
      consequence = "has the wrong sense for a steady state: it opens the drive flanks of "//trim(number)//", and the coast" &
                    //" flanks would carry; change its sign, or driving_rotation of that mesh"
      associate (load => gearbox%loads(i)%load)
         if (load%prescribes) then
            call fail(status, code_no_solution, "the prescribed speed " &
                      //quantity(wheel_speed(gearbox%wheels(load%wheel), state%y), "rad/s")//" "//trim(consequence), subject_load, &
                      i, trim(load%sense))
         else
            call fail(status, code_no_solution, "its torque "//quantity(load_torque(gearbox, i, state%t, state%y, state%integers), &
                                                                        "N m")//" "//trim(consequence), subject_load, i, &
                      trim(load%sense))
         end if
      end associate
   end subroutine refuse_pull

   !> The load that separates the drive flanks of a mesh; 0 if none does, or if the paths from loads to the mesh form a loop.
   !>
   !> The contact torque is sigma F r_bA on A and sigma F r_bB on B, F > 0. The loads on either side, transferred to A or B by the
   !> speed ratios, must act against sigma. Torques that depend on the speed take the sense set by other loads: if all loads that
   !> separate the flanks do so, the prescribed speed is reported, or the drive.
   integer function wrong_load(gearbox, contact, state) result(wrong)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(in) :: state
      type(tooth_contact_t), intent(in) :: contact
      logical :: beside_a(size(gearbox%wheels)), follower_parts
      real(wp) :: share, largest, ratio, standstill_torque, damping, stiffness
      integer :: drive, i

      wrong = 0
      beside_a = joined_without(gearbox, contact)
      if (beside_a(contact%wheel_b)) return
      largest = 0
      follower_parts = .false.
      drive = 0
      do i = 1, size(gearbox%loads)
         associate (load => gearbox%loads(i)%load)
            ratio = merge(contact%pair%ratio_a, contact%pair%ratio_b, beside_a(load%wheel))
         share = contact%pair%sigma*load_torque(gearbox, i, state%t, state%y, state%integers)*gearbox%wheels(load%wheel)%ratio/ratio
            if (.not. share > 0) cycle
            if (load%by_speed) then
               follower_parts = .true.
               call load%ask(load_point(), standstill_torque, damping, stiffness)
               if (abs(standstill_torque) > 0) drive = i
            else if (share*abs(ratio) > largest) then
               largest = share*abs(ratio)
               wrong = i
            end if
         end associate
      end do
      if (wrong > 0 .or. .not. follower_parts) return
      wrong = drive
      do i = size(gearbox%loads), 1, -1
         if (gearbox%loads(i)%load%prescribes) wrong = i
      end do
   end function wrong_load

   !> Wheels connected to the driving wheel of a mesh by shafts and other meshes.
   pure function joined_without(gearbox, contact) result(joined)
      type(gearbox_t), intent(in) :: gearbox
      type(tooth_contact_t), intent(in) :: contact
      logical :: joined(size(gearbox%wheels))
      integer :: i

      associate (firsts => gearbox%first(:size(gearbox%pairs)))
         joined = joined_to(contact%wheel_a, [gearbox%contacts(firsts)%wheel_a, gearbox%shafts%wheel_a], &
                            [gearbox%contacts(firsts)%wheel_b, gearbox%shafts%wheel_b], &
                            [(i /= contact%mesh, i=1, size(firsts) + size(gearbox%shafts))], size(joined))
      end associate
   end function joined_without

   !> Report modes that do not settle: the tooth pair that is on its path while others are loaded, and off it while it is loaded.
   subroutine refuse_alternation(gearbox, before, integers, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: before(:), integers(:) !! modes of the last two iterations
      type(status_t), intent(inout) :: status
      character(len=16) :: pair
      integer :: m

      do m = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(m), is_off => flanks_of(gearbox%contacts(m), integers) == flanks_off)
            if (flanks_of(contact, before) == flanks_off .eqv. is_off) cycle
            write (pair, "(i0)") merge(tooth_pair_of(contact, before), tooth_pair_of(contact, integers), is_off)
            call fail(status, code_no_solution, "there is no steady state:" &
                      //" tooth pair "//trim(pair)//" is on the path of contact while others carry the load, and off it when" &
                      //" loaded; start from rest or with given speeds", &
                      subject_mesh, contact%mesh)
            return
         end associate
      end do
   end subroutine refuse_alternation

   !> Report that no steady state was found; with flank deviations, name the tooth pair on the steepest slope.
   subroutine refuse_slope(gearbox, state, status)
      type(gearbox_t), intent(in) :: gearbox
      type(gearbox_state), intent(in) :: state
      type(status_t), intent(inout) :: status
      type(contact_state) :: at
      type(flank_value) :: a, b
      type(flanks_turned) :: turned
      real(wp) :: steepest, rate
      character(len=16) :: pair
      integer :: m, worst

      worst = 0
      steepest = 0
      rate = 0
      pair = ""
      do m = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(m), mode => at%mode)
            call take_mode(gearbox, m, state%integers, state%reals, mode)
            if (.not. contact%deviates .or. mode%flanks == flanks_off) cycle
            call closed_form_point(gearbox, m, state%y, 0, mode%tooth_pair, at)
            if (at%point%h <= 0 .and. mode%flanks /= flanks_loaded) cycle
            call flank_values(contact, mode, at%point, a, b, turned)
            if (.not. abs(a%de - b%de) > abs(steepest)) cycle
            steepest = a%de - b%de
            worst = m
            rate = at%point%h_dot
            write (pair, "(i0)") mode%tooth_pair
         end associate
      end do
      if (worst == 0) then
         call fail(status, code_no_solution, "no steady state was found; start from rest or with given speeds", subject_initial, &
                   field="kind")
         return
      end if
      call fail(status, code_no_solution, "no steady state was found: tooth pair "//trim(pair)//" is on a slope of its deviating" &
                //" flanks, "//quantity(steepest*1.0e3_wp, "um/mm")//", on which its penetration would change by " &
                //quantity(rate, "m/s")//"; start from rest or with given speeds, or with less damping", subject_mesh, &
                gearbox%contacts(worst)%mesh, "damping")
   end subroutine refuse_slope

end module evl_steady_refusals
