!> Quasi-static analysis of a mesh: transmission error, stiffness and load sharing under a torque of the driving wheel. Positions
!> cover one pitch or, if pitch errors or runout make teeth differ, all pitches until the same teeth meet again.
!>
!> Axles are at their reference positions. Position x is the distance in pitches from where the unloaded tooth pair 0 is at the
!> start of its path; pair k is x - k pitches from its start there. Slots for tooth pairs are ordered by the number of whole pitches
!> that a pair is ahead of the one that entered the path last, -1 for the next one: slot j holds pair floor(x) - j.
!>
!> A torque against the sense of rotation loads the coast flanks. Their path starts at the tip of the driving wheel's teeth, and the
!> driven wheel lags by -(h + backlash), where h is the overlap of these flanks.
!>
!> Source: docs/guides/static_analysis.md.
module evl_static_analysis
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_flank_deviation, only: teeth_differ
   use evl_gearbox, only: gearbox_t
   use evl_johnson, only: johnson_t
   use evl_kinds, only: nan, pi, wp
   use evl_mesh_stiffness, only: iso_stiffness
   use evl_number_text, only: quantity_length
   use evl_output_registry, only: registry_t, store_in
   use evl_pair_point, only: by_a, by_b
   use evl_pair_sequence, only: exactly_one
   use evl_pressed_flank, only: find_pressed, lag_of, pressed_t
   use evl_rational, only: divisor_of
   use evl_static_extremes, only: extremes_t, finish_extremes, n_before, take_position
   use evl_static_mesh, only: loss_factor_at, solve_static, static_mesh_t, static_state
   use evl_static_mesh_setup, only: static_mesh_create
   use evl_static_node, only: static_node, touch
   use evl_static_points, only: find_point_pressures
   use evl_static_outputs, only: add_static_harmonic, add_static_mesh, add_static_pair, add_static_points, add_static_position, &
                                 add_static_root, add_static_start, add_static_torque, add_static_torque_roots, n_harmonics, &
                                 static_columns, static_sum, youngest
   use evl_static_roots, only: extremes_of_pairs, static_roots_t, wheels_with_roots
   use evl_static_search, only: static_search
   use evl_status, only: code_invalid_input, code_ok, fail, has_failed, message_length, quantity, status_t, subject_mesh, &
                         subject_none
   use evl_tooth_contact, only: contact_mode, tooth_contact_t
   implicit none (type, external)
   private

   public :: find_largest, least_points, measure_mesh, most_positions, plan_static, solve_static_mesh, static_plan_t

   integer, parameter :: least_points = 2*n_harmonics + 1 !! per pitch, for the highest harmonic
   integer, parameter :: most_positions = 500000

   !> Extent of an analysis.
   type :: static_plan_t
      integer :: points = 0      !! positions per pitch
      integer :: n_pitches = 1   !! number of pitches until the same teeth meet again
      integer :: n_positions = 0
      integer :: n_pairs = 0     !! number of tooth pair slots
      integer :: n_wheels = 0    !! wheels in the outputs of the root stress: 2, or 0 if neither has it
      integer :: n_values = 0
      real(wp) :: reach = 0.0_wp !! range of tip-edge contact beyond the path [m]
      real(wp) :: torque = 0.0_wp !! of the driving wheel at the nominal operating point, < 0 on the coast flanks [N m]
   end type static_plan_t

contains

   !> Determine the extent of the analysis of a mesh.
   !> Errors: code_invalid_input if the mesh does not support it, or for too few or too many points.
   subroutine plan_static(gearbox, mesh, points, plan, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      integer, intent(in) :: points !! per pitch
      type(static_plan_t), intent(out) :: plan
      type(status_t), intent(inout) :: status
      integer, allocatable :: rows_before(:), columns(:)

      call measure_mesh(gearbox, mesh, plan, status)
      if (has_failed(status)) return
      if (points < least_points) then
         call fail(status, code_invalid_input, counted(points)//" positions a pitch are too few: "//counted(least_points) &
                   //" or more show "//counted(n_harmonics)//" harmonics", subject_none)
      else if (points > most_positions/plan%n_pitches) then
         call fail(status, code_invalid_input, "teeth differ, so that "//counted(plan%n_pitches)//" pitches of "//counted(points) &
                   //" positions are required, more than "//counted(most_positions)//" positions", subject_none)
      end if
      if (has_failed(status)) return
      plan%points = points
      plan%n_positions = points*plan%n_pitches
      plan%torque = sign(gearbox%nominal%mesh_load(mesh), gearbox%nominal%force(mesh))*abs(gearbox%pairs(mesh)%base_radius_a)
      call static_columns(plan%n_positions, plan%n_pairs, plan%n_wheels, rows_before, columns, plan%n_values)
   end subroutine plan_static

   !> Range of tooth pairs beyond the path, number of slots, and number of pitches until the same teeth meet again.
   subroutine measure_mesh(gearbox, mesh, plan, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      type(static_plan_t), intent(inout) :: plan
      type(status_t), intent(inout) :: status

      call check_mesh(gearbox, mesh, status)
      if (has_failed(status)) return
      associate (contact => gearbox%contacts(gearbox%first(mesh)), pair => gearbox%pairs(mesh))
         plan%reach = gearbox%flanks(contact%i_flank)%flank%reach*pair%base_pitch
         if (.not. plan%reach > 0 .and. pair%contact_ratio < 1 - exactly_one) then
            call fail(status, code_invalid_input, &
                      "its contact" &
                      //" ratio is "//quantity(pair%contact_ratio, "")//": without a tooth pair on the path only tip" &
                      //" edges are in contact; give a wheel a compliance, or the mesh" &
                      //" edge_contact: true", subject_mesh, mesh)
            return
         end if
         associate (a => int(merge(contact%deviation_a%teeth, 1, teeth_differ(contact%deviation_a)), int64), &
                    b => int(merge(contact%deviation_b%teeth, 1, teeth_differ(contact%deviation_b)), int64))
            plan%n_pitches = int(min(a/divisor_of(a, b)*b, int(huge(1), int64))) ! least common multiple
         end associate
         if (allocated(gearbox%root_stresses)) &
            plan%n_wheels = merge(2, 0, any(gearbox%root_stresses([contact%wheel_a, contact%wheel_b])%exists))
         plan%n_pairs = floor(pair%contact_ratio + plan%reach/pair%base_pitch) + 1 - youngest
      end associate
   end subroutine measure_mesh

   !> Check that the gears have a basic rack and the contact law is Johnson's.
   subroutine check_mesh(gearbox, mesh, status)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      type(status_t), intent(inout) :: status

      if (.not. gearbox%gear_meshes(mesh)%exists) then
         call fail(status, code_invalid_input, "the static analysis requires gears with a basic rack, whose tips limit the" &
                   //" path of contact; give both wheels a module", subject_mesh, mesh)
         return
      end if
      select type (law => gearbox%contacts(gearbox%first(mesh))%elastic)
      type is (johnson_t)
         return
      class default
         call fail(status, code_invalid_input, "the static analysis supports only the contact law: johnson", subject_mesh, mesh, &
                   "contact.law")
      end select
   end subroutine check_mesh

   !> Text of an integer.
   pure function counted(n) result(text)
      integer, intent(in) :: n
      character(len=quantity_length(real(n, wp), "")) :: text

      text = quantity(real(n, wp), "")
   end function counted

   !> Compute all values at one torque, in the columns of evl_static_outputs.
   !> Errors: code_invalid_input for a torque that loads no flanks; those of evl_static_mesh if no equilibrium is found.
   subroutine solve_static_mesh(gearbox, mesh, plan, torque, speed, values, status)
      type(gearbox_t), intent(in), target :: gearbox
      integer, intent(in) :: mesh
      type(static_plan_t), intent(in) :: plan !! of this mesh
      real(wp), intent(in) :: torque          !! of the driving wheel in its sense of rotation [N m]
      real(wp), intent(in) :: speed           !! of the driving wheel in that sense, for friction; 0: no friction [rad/s]
      real(wp), intent(inout), target, contiguous :: values(:)
      type(status_t), intent(inout) :: status
      integer, allocatable, target :: rows_before(:), columns(:)
      type(static_mesh_t), target :: static_mesh
      type(static_search) :: search
      type(static_state) :: state
      type(static_sum) :: total
      type(registry_t) :: registry
      complex(wp) :: harmonics(n_harmonics)
      type(pressed_t) :: flank
      type(static_node) :: node
      integer :: i, n_values

      call find_pressed(gearbox, mesh, torque, speed, flank, status)
      if (has_failed(status)) return
      call static_columns(plan%n_positions, plan%n_pairs, plan%n_wheels, rows_before, columns, n_values)
      call store_in(registry, rows_before, columns, 1, values)
      associate (contact => gearbox%contacts(flank%contact), pair => gearbox%pairs(mesh))
         call static_mesh_create(contact, gearbox%compliances(contact%wheel_a), gearbox%compliances(contact%wheel_b), &
                                 gearbox%flanks(contact%i_flank)%flank%couples, plan%reach, speed, static_mesh)
         call add_static_mesh(registry, pair, static_mesh%width, speed)
         call start_sum(gearbox, mesh, static_mesh, abs(torque), total)
         harmonics = 0
         call start_search(search, contact, static_mesh, flank, total%force)
         if (plan%n_wheels > 0) call wheels_with_roots(gearbox, contact, plan%n_pitches, search%roots)
         do i = -n_before, plan%n_positions - 1
            associate (x => real(i, wp)/plan%points)
               call solve_static(static_mesh, flank%rho_a + flank%turns*(x*pair%base_pitch), total%force, state, status)
               if (.not. has_failed(status)) call take_position(search, x, state, node, status)
               if (has_failed(status)) then
                  call report_position(torque, modulo(x, real(plan%n_pitches, wp)), mesh, status)
                  return
               end if
               if (i < 0) cycle
               call add_static_start(registry, i + 1, x*pair%base_pitch/abs(pair%base_radius_a), lag_of(flank, state%h_0))
               call add_static_position(registry, i + 1, total%force, lag_of(flank, state%h), abs(pair%base_radius_b), state)
               call add_pairs(registry, contact, flank, static_mesh, i/plan%points, i*plan%n_pairs, plan%n_pairs, total%force, &
                              state)
               if (plan%n_wheels > 0) call add_roots(registry, search%roots, 2*i, node)
            end associate
            associate (n => plan%n_positions)
               total%mean = total%mean + lag_of(flank, state%h)/n
               total%secant = total%secant + total%force/(state%h - state%h_0)/n
               total%tangent = total%tangent + state%stiffness/n
               total%carrying = total%carrying + count(state%potential%solution%force(:state%n) > 0)/real(n, wp)
               total%loss_factor = total%loss_factor + loss_factor_at(static_mesh, state, total%force)/n
            end associate
            call add_harmonics(i, plan, lag_of(flank, state%h), harmonics)
         end do
      end associate
      call finish_extremes(search, total%extremes, status)
      if (.not. has_failed(status)) call find_point_pressures(search, gearbox%pairs(mesh), total%points, status)
      if (has_failed(status)) then
         call report_position(torque, search%at, mesh, status)
         return
      end if
      total%share = total%extremes%force/total%force
      total%per_width = total%secant/static_mesh%width
      call add_static_torque(registry, total)
      call add_static_points(registry, total%extremes, total%points)
      if (plan%n_wheels > 0) call add_static_torque_roots(registry, total%extremes%largest_root, total%extremes%least_root)
      do i = 1, n_harmonics
         call add_static_harmonic(registry, i, harmonics(i))
      end do
   end subroutine solve_static_mesh

   !> Extremes under a torque over a number of pitches, or over all different ones if these are fewer, also between positions.
   !> Errors: those of `plan_static` and `solve_static_mesh`.
   subroutine find_largest(gearbox, mesh, first, pitches, torque, with_roots, extremes, status)
      type(gearbox_t), intent(in), target :: gearbox
      integer, intent(in) :: mesh
      integer, intent(in) :: first, pitches   !! index of the first pitch, number of pitches
      real(wp), intent(in) :: torque          !! of the driving wheel in its sense of rotation [N m]
      logical, intent(in) :: with_roots       !! also of the root stress, if the wheels have it
      type(extremes_t), intent(out) :: extremes
      type(status_t), intent(inout) :: status
      integer, parameter :: points = 100      ! per pitch
      type(static_plan_t) :: plan
      type(static_mesh_t), target :: static_mesh
      type(static_search) :: search
      type(static_state) :: state
      type(pressed_t) :: flank
      type(static_node) :: node
      real(wp) :: x
      integer :: i

      call measure_mesh(gearbox, mesh, plan, status)
      if (.not. has_failed(status)) call find_pressed(gearbox, mesh, torque, 0.0_wp, flank, status)
      if (has_failed(status)) return
      associate (contact => gearbox%contacts(flank%contact), pair => gearbox%pairs(mesh))
         call static_mesh_create(contact, gearbox%compliances(contact%wheel_a), gearbox%compliances(contact%wheel_b), &
                                 gearbox%flanks(contact%i_flank)%flank%couples, plan%reach, 0.0_wp, static_mesh)
         call start_search(search, contact, static_mesh, flank, abs(torque/pair%base_radius_a))
         if (with_roots) call wheels_with_roots(gearbox, contact, plan%n_pitches, search%roots)
         do i = -n_before, points*min(pitches, plan%n_pitches)
            x = modulo(first, plan%n_pitches) + real(i, wp)/points
            call solve_static(static_mesh, flank%rho_a + flank%turns*(x*pair%base_pitch), search%force, state, status)
            if (.not. has_failed(status)) call take_position(search, x, state, node, status)
            if (has_failed(status)) then
               call report_position(torque, modulo(x, real(plan%n_pitches, wp)), mesh, status)
               return
            end if
         end do
      end associate
      call finish_extremes(search, extremes, status)
      if (has_failed(status)) call report_position(torque, search%at, mesh, status)
   end subroutine find_largest

   !> Start the search for extremes.
   subroutine start_search(search, contact, static_mesh, flank, force)
      type(static_search), intent(inout) :: search
      type(tooth_contact_t), intent(in), target :: contact
      type(static_mesh_t), intent(in), target :: static_mesh
      type(pressed_t), intent(in) :: flank
      real(wp), intent(in) :: force !! total tooth force [N]

      search%contact => contact
      search%mesh => static_mesh
      search%rho_a = flank%rho_a
      search%turns = flank%turns
      search%force = force
   end subroutine start_search

   !> Data of a torque that do not depend on the position: forces, stiffness of a single pair, and values of ISO 6336-1.
   subroutine start_sum(gearbox, mesh, static_mesh, torque, total)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      type(static_mesh_t), intent(in) :: static_mesh
      real(wp), intent(in) :: torque
      type(static_sum), intent(out) :: total
      real(wp) :: h
      integer :: code

      associate (pair => gearbox%pairs(mesh))
         total%force = torque/abs(pair%base_radius_a)
         total%line_load = total%force/static_mesh%width
         associate (contact => gearbox%contacts(gearbox%first(mesh)))
            call gearbox%flanks(contact%i_flank)%flank%pair_under(contact, total%force, h, code)
         end associate
         total%single = nan
         if (code == code_ok) total%single = total%line_load/h
         total%iso_single = iso_stiffness(gearbox, mesh, total%line_load)
         total%iso = total%iso_single*(0.75_wp*pair%contact_ratio + 0.25_wp)
      end associate
   end subroutine start_sum

   !> Add torque and position to the error message.
   subroutine report_position(torque, position, mesh, status)
      real(wp), intent(in) :: torque, position
      integer, intent(in) :: mesh
      type(status_t), intent(inout) :: status
      character(len=message_length) :: reason

      reason = status%message
      call fail(status, status%code, "under "//quantity(torque, "N m")//", "//quantity(position, "") &
                //" pitches from the start of contact: "//trim(reason), subject_mesh, mesh)
   end subroutine report_position

   !> Store the tooth pairs at a position.
   subroutine add_pairs(registry, contact, flank, static_mesh, pitches, before, n_pairs, force_of_teeth, state)
      type(registry_t), intent(inout) :: registry
      type(tooth_contact_t), intent(in) :: contact
      type(pressed_t), intent(in) :: flank
      type(static_mesh_t), intent(in) :: static_mesh
      integer, intent(in) :: pitches !! whole pitches of the position
      integer, intent(in) :: before  !! number of slots of the positions before it
      integer, intent(in) :: n_pairs
      real(wp), intent(in) :: force_of_teeth !! total [N]
      type(static_state), intent(in) :: state
      type(contact_mode) :: mode
      real(wp) :: force, share, pressure
      integer :: i, pair_slot

      do pair_slot = 1, n_pairs
         i = findloc(state%numbers(:state%n), flank%turns*(pitches - (pair_slot - 1 + youngest)), dim=1)
         force = 0
         share = 0
         pressure = 0
         if (i > 0) then
            force = state%potential%solution%force(i)*static_mesh%width
            share = force/force_of_teeth
            if (force > 0) call touch(contact, flank%turns*state%numbers(i), static_mesh, state, i, mode, pressure)
         end if
         call add_static_pair(registry, before + pair_slot, state, i, share, force, pressure)
      end do
   end subroutine add_pairs

   !> Store the root stress of both wheels at a position.
   subroutine add_roots(registry, roots, before, node)
      type(registry_t), intent(inout) :: registry
      type(static_roots_t), intent(in) :: roots
      integer, intent(in) :: before !! number of wheels of the positions before it
      type(static_node), intent(in) :: node

      call add_static_root(registry, before + by_a, associated(roots%a), extremes_of_pairs(node%roots(by_a, :node%n)))
      call add_static_root(registry, before + by_b, associated(roots%b), extremes_of_pairs(node%roots(by_b, :node%n)))
   end subroutine add_roots

   !> Add the contribution of a position to the amplitudes of the harmonics.
   pure subroutine add_harmonics(i, plan, h, harmonics)
      integer, intent(in) :: i !! index of the position, from 0
      type(static_plan_t), intent(in) :: plan
      real(wp), intent(in) :: h
      complex(wp), intent(inout) :: harmonics(n_harmonics)
      real(wp) :: angle
      integer :: n

      do n = 1, n_harmonics
         angle = 2*pi*mod(i*n, plan%points)/plan%points
         harmonics(n) = harmonics(n) + 2*h/plan%n_positions*cmplx(cos(angle), -sin(angle), wp)
      end do
   end subroutine add_harmonics

end module evl_static_analysis
