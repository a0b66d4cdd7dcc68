!> What a gearbox tells about itself at a state: the values of the outputs that are wanted.
!>
!> `evl_teller` says how an output is told, `evl_output_list` holds the sections of the table in their order. What takes long is
!> found only if a wanted output needs it.
module evl_outputs
   use evl_gearbox, only: gearbox_t, i_turns
   use evl_housing, only: frame_t, housing_fixed, housing_frame
   use evl_housing_dynamics, only: coupled_rates, ground_energies
   use evl_housing_outputs, only: finish_reaction, tell_bearing, tell_pose
   use evl_kinds, only: wp
   use evl_local_variables, only: i_theta
   use evl_mesh_outputs, only: put_mesh
   use evl_mode_check, only: check_modes
   use evl_motion_outputs, only: find_wheel_motion, tell_gearbox, tell_shaft, tell_wheel, wheel_motion
   use evl_output, only: needs_all, needs_meshes, needs_rates, needs_reactions
   use evl_outside_torques, only: load_torques, shaft_torques
   use evl_shaft, only: shaft_energy, shaft_twist
   use evl_status, only: has_failed, status_t
   use evl_teller, only: fill, teller_t
   use evl_tooth_contact, only: contact_state
   implicit none (type, external)
   private

   public :: gearbox_outputs, wanted_outputs

contains

   !> All values at a state.
   subroutine gearbox_outputs(gearbox, t, y, integers, reals, check, values, status)
      type(gearbox_t), intent(in), target :: gearbox
      real(wp), intent(in) :: t, y(gearbox%n_states), reals(:)
      integer, intent(in) :: integers(:)
      logical, intent(in) :: check !! whether to refuse a state that contradicts its modes, as `check_modes` does
      real(wp), intent(out), target, contiguous :: values(:) !! [n_values]
      type(status_t), intent(inout) :: status
      type(teller_t) :: teller
      integer :: i

      do i = 1, size(gearbox%static_ranges, 2)
         associate (first => gearbox%static_ranges(1, i), last => gearbox%static_ranges(2, i))
            values(first:last) = gearbox%constants(first:last)
         end associate
      end do
      call fill(teller, gearbox%output_sections, values)
      call tell_state(teller, needs_all, gearbox, t, y, integers, reals, check, status)
   end subroutine gearbox_outputs

   !> The values of some outputs at states that share their discrete state, as in a step; the other values stay as they are.
   subroutine wanted_outputs(gearbox, t, y, integers, reals, wanted, values, status)
      type(gearbox_t), intent(in), target :: gearbox
      real(wp), intent(in) :: t(:), y(:, :), reals(:) !! y: (n_states, states)
      integer, intent(in) :: integers(:)
      logical, intent(in) :: wanted(:)                !! of the table
      real(wp), intent(inout), target, contiguous :: values(:, :) !! (n_values, states)
      type(status_t), intent(inout) :: status
      integer, target :: indices(size(wanted))
      type(teller_t) :: teller
      integer :: i, s, needed

      indices = -1
      needed = 0
      do i = 1, size(wanted)
         if (.not. wanted(i) .or. gearbox%output_counts(i) == 0) cycle
         needed = ior(needed, gearbox%output_needs(i))
         indices(i) = gearbox%output_offsets(i)
         if (.not. gearbox%output_is_static(i)) cycle
         associate (first => indices(i) + 1, last => indices(i) + gearbox%output_counts(i))
            values(first:last, :) = spread(gearbox%constants(first:last), 2, size(t))
         end associate
      end do
      do s = 1, size(t)
         call fill(teller, gearbox%output_sections, values(:, s), indices)
         call tell_state(teller, needed, gearbox, t(s), y(:, s), integers, reals, .false., status)
         if (has_failed(status)) return
      end do
   end subroutine wanted_outputs

   !> What changes, at a state.
   subroutine tell_state(teller, needed, gearbox, t, y, integers, reals, check, status)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: needed !! by what is wanted
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, y(gearbox%n_states), reals(:)
      integer, intent(in) :: integers(:)
      logical, intent(in) :: check
      type(status_t), intent(inout) :: status
      real(wp) :: f(gearbox%n_states), reactions(6, size(gearbox%wheels)), kinetic, potential
      real(wp), dimension(size(gearbox%wheels)) :: torque, load_torque
      type(frame_t) :: frame
      type(contact_state) :: contacts(size(gearbox%contacts))
      type(wheel_motion) :: wheel
      integer :: i

      f = 0
      if (iand(needed, needs_rates) == needs_rates) call coupled_rates(gearbox, t, y, integers, reals, f, status, contacts)
      if (has_failed(status)) return
      call housing_frame(gearbox%housing, t, y, frame, f)
      kinetic = 0
      potential = 0
      torque = 0
      load_torque = 0
      reactions = 0
      if (iand(needed, needs_meshes) == needs_meshes) then
         do i = 1, size(gearbox%pairs)
            call put_mesh(teller, needed, gearbox, i, t, y, integers, reals, contacts, torque, reactions, potential)
         end do
         if (check) call check_modes(gearbox, contacts, status)
         if (has_failed(status)) return
         call load_torques(gearbox, t, y, f, frame, integers, torque, load_torque)
      end if
      do i = 1, size(gearbox%wheels)
         call find_wheel_motion(gearbox%wheels(i), y, f, integers(i_turns), load_torque(i), wheel, kinetic, potential)
         call tell_wheel(teller, i, wheel)
      end do
      do i = 1, size(gearbox%shafts)
         potential = potential + shaft_energy(gearbox%shafts(i), y)
      end do
      if (gearbox%housing%is_mounted) call ground_energies(gearbox, y, frame, kinetic, potential)
      call tell_gearbox(teller, y(i_theta), integers(i_turns), kinetic, potential, y(gearbox%i_dissipated), y(gearbox%i_work))
      if (iand(needed, needs_reactions) == needs_reactions) then
         do i = 1, size(gearbox%wheels)
            call finish_reaction(gearbox, i, t, y, f, integers, frame, load_torque(i), reactions(:, i))
            call tell_bearing(teller, i, reactions(:, i))
         end do
      end if
      if (gearbox%housing%kind /= housing_fixed) call tell_pose(teller, frame, gearbox%housing%gravity)
      if (size(gearbox%shafts) > 0) call tell_shafts(teller, needed, gearbox, y, f, frame, torque + load_torque)
   end subroutine tell_state

   !> The shafts at a state.
   subroutine tell_shafts(teller, needed, gearbox, y, f, frame, torque)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: needed
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(:), f(:)      !! f: rates of the states
      type(frame_t), intent(in) :: frame      !! of the housing there
      real(wp), intent(in) :: torque(:)       !! of meshes and loads on every wheel [N m]
      real(wp) :: carried(size(gearbox%shafts))
      integer :: i

      carried = 0
      if (iand(needed, needs_meshes) == needs_meshes) call shaft_torques(gearbox, y, f, frame, torque, carried)
      do i = 1, size(gearbox%shafts)
         call tell_shaft(teller, i, carried(i), shaft_twist(gearbox%shafts(i), y, 0))
      end do
   end subroutine tell_shafts

end module evl_outputs
