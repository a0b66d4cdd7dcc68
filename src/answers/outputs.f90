!> What a gearbox tells about itself at a state: the values of its outputs, or of those that are wanted.
!>
!> `evl_teller` says how an output is told, `evl_output_list` holds the sections of the table in their order.
module evl_outputs
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use evl_gearbox, only: gearbox_t, i_turns
   use evl_housing, only: felt_acceleration, frame_t, housing_fixed, housing_frame, housing_t, mount_force, mount_loss
   use evl_housing_dynamics, only: coupled_rates, ground_energies
   use evl_housing_outputs, only: finish_reaction, tell_accelerometer, tell_bearing, tell_mount, tell_pose
   use evl_kinds, only: wp
   use evl_local_variables, only: i_theta
   use evl_mesh_outputs, only: put_mesh
   use evl_mode_check, only: check_modes
   use evl_motion_outputs, only: find_wheel_motion, tell_gearbox, tell_shaft, tell_wheel, wheel_motion
   use evl_output, only: needs_all, needs_meshes, needs_nothing, needs_rates, needs_reactions
   use evl_outside_torques, only: load_torques, shaft_torques
   use evl_shaft, only: shaft_energy, shaft_loss, shaft_twist
   use evl_status, only: has_failed, status_t
   use evl_teller, only: fill, teller_t
   use evl_tooth_contact, only: contact_state
   implicit none (type, external)
   private

   public :: gearbox_outputs, needed_outputs

contains

   !> All values at a state.
   subroutine gearbox_outputs(gearbox, t, y, integers, reals, check, values, status)
      type(gearbox_t), intent(in), target :: gearbox
      real(wp), intent(in) :: t, y(gearbox%n_states), reals(size(gearbox%contacts))
      integer, intent(in) :: integers(gearbox%n_integers)
      logical, intent(in) :: check !! whether to refuse a state that contradicts its modes, as `check_modes` does
      real(wp), intent(out), target :: values(gearbox%n_values)
      type(status_t), intent(inout) :: status

      call needed_outputs(gearbox, t, y, integers, reals, needs_all, check, values, status)
   end subroutine gearbox_outputs

   !> The values at a state that need no more than what is found; the others are NaN or undefined.
   subroutine needed_outputs(gearbox, t, y, integers, reals, wanted, check, values, status)
      type(gearbox_t), intent(in), target :: gearbox
      real(wp), intent(in) :: t, y(gearbox%n_states), reals(size(gearbox%contacts))
      integer, intent(in) :: integers(gearbox%n_integers)
      integer, intent(in) :: wanted !! needs of the outputs that are asked for
      logical, intent(in) :: check  !! as of `gearbox_outputs`
      real(wp), intent(out), target :: values(gearbox%n_values)
      type(status_t), intent(inout) :: status
      type(teller_t) :: teller
      real(wp) :: f(gearbox%n_states), reactions(6, size(gearbox%wheels)), carried(size(gearbox%shafts)), kinetic, potential
      real(wp) :: of_meshes !! 0 to begin a sum over the meshes, NaN where they are not evaluated
      real(wp), dimension(size(gearbox%wheels)) :: torque, load_torque
      type(frame_t) :: frame
      type(contact_state) :: contacts(size(gearbox%contacts))
      type(wheel_motion) :: wheel
      integer :: i, needed

      needed = ior(wanted, merge(needs_meshes, needs_nothing, check))
      call copy(gearbox%n_values, gearbox%constants, values)
      call fill(teller, gearbox%output_sections, values)
      f = merge(0.0_wp, ieee_value(f, ieee_quiet_nan), iand(needed, needs_rates) == needs_rates)
      of_meshes = merge(0.0_wp, ieee_value(of_meshes, ieee_quiet_nan), iand(needed, needs_meshes) == needs_meshes)
      if (iand(needed, needs_rates) == needs_rates) call coupled_rates(gearbox, t, y, integers, reals, f, status, contacts)
      if (has_failed(status)) return
      call housing_frame(gearbox%housing, t, y, frame, f)
      kinetic = 0
      potential = of_meshes
      torque = of_meshes
      load_torque = of_meshes
      reactions = of_meshes
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
      call tell_housing(teller, gearbox%housing, frame)
      carried = of_meshes
      if (size(gearbox%shafts) > 0 .and. iand(needed, needs_meshes) == needs_meshes) &
         call shaft_torques(gearbox, y, f, frame, torque + load_torque, carried)
      do i = 1, size(gearbox%shafts)
         call tell_shaft(teller, i, carried(i), shaft_twist(gearbox%shafts(i), y, 0), shaft_loss(gearbox%shafts(i), y))
      end do
   end subroutine needed_outputs

   !> The housing, if it moves.
   subroutine tell_housing(teller, housing, frame)
      type(teller_t), intent(inout) :: teller
      type(housing_t), intent(in) :: housing
      type(frame_t), intent(in) :: frame
      real(wp) :: force(3), velocity(3)
      integer :: i

      if (housing%kind /= housing_fixed) call tell_pose(teller, frame, housing%gravity)
      if (housing%is_mounted) then
         call mount_force(housing, frame, force, velocity)
         call tell_mount(teller, mount_loss(housing, frame, velocity))
      end if
      do i = 1, size(housing%accelerometers)
         call tell_accelerometer(teller, i, felt_acceleration(housing, frame, housing%accelerometers(i)))
      end do
   end subroutine tell_housing

   !> Of arrays that are not targets, as which they would be copied twice.
   pure subroutine copy(n, from, to)
      integer, intent(in) :: n
      real(wp), intent(in) :: from(n)
      real(wp), intent(out) :: to(n)

      to = from
   end subroutine copy

end module evl_outputs
