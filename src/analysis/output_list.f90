!> Table of outputs: all sections in order, listed by a registry from empty objects; and the subset that a gearbox has.
module evl_output_list
   use evl_constant_outputs, only: active_radius, add_mesh_constants, add_mesh_teeth, add_wheel_constants, add_wheel_teeth
   use evl_extrema_monitor, only: extremes_table
   use evl_gear, only: gear_t
   use evl_gearbox, only: gearbox_t, wheel_t
   use evl_housing, only: frame_t, housing_fixed, housing_t
   use evl_housing_outputs, only: add_accelerometer, add_mesh_position, add_mount, add_pose, add_wheel_position
   use evl_kinds, only: lanes, nan, wp
   use evl_mesh_geometry, only: spur_pair_t
   use evl_mesh_outputs, only: add_coast_outputs, add_mesh_outputs, mesh_lanes, mesh_points
   use evl_mesh_reference, only: mesh_reference_t
   use evl_motion_outputs, only: add_gearbox_outputs, add_loss_outputs, add_shaft_constants, add_shaft_outputs, add_wheel_outputs, &
                                 gearbox_lanes, shaft_lanes, wheel_lanes
   use evl_output, only: dims_accelerometer, dims_mesh, dims_mesh_pair, dims_shaft, dims_wheel, in_coast, in_losses, in_mount, &
                         in_pose, in_roots, in_temperatures, output_t, rows_before_sections
   use evl_output_registry, only: omit_texts, registry_t, store_in, take_rows
   use evl_pair_outputs, only: add_pair_outputs, pair_lanes
   use evl_root_outputs, only: add_root_outputs
   use evl_rotation, only: identity
   use evl_shaft, only: shaft_t
   use evl_temperature_outputs, only: add_temperature_outputs
   use evl_tooth_contact, only: flank_coast, tooth_contact_t
   use evl_torque_outputs, only: add_bearing_outputs
   implicit none (type, external)
   private

   public :: list_extremes, list_outputs, set_output_offsets

contains

   !> List the table: every section once, in order.
   subroutine list_outputs(table, without_texts)
      type(output_t), intent(out), allocatable :: table(:)
      logical, intent(in), optional :: without_texts !! omit units, symbols and texts
      type(registry_t) :: registry
      type(frame_t), parameter :: frame = frame_t(position=0.0_wp, velocity=0.0_wp, orientation=0.0_wp, rotation=identity, &
                                                  omega=0.0_wp, alpha=0.0_wp, acceleration=0.0_wp)
      type(frame_t) :: frames(lanes)
      type(housing_t) :: housing
      type(wheel_t) :: wheel
      type(tooth_contact_t) :: contact
      type(spur_pair_t) :: pair
      type(mesh_reference_t) :: reference
      type(gear_t) :: gear
      type(gearbox_lanes) :: whole
      type(wheel_lanes) :: motion
      type(mesh_lanes) :: mesh
      type(mesh_points) :: points
      type(pair_lanes) :: tooth_pair
      type(shaft_t) :: shaft
      type(shaft_lanes) :: twisted
      real(wp), parameter :: reaction(lanes, 6) = 0.0_wp, lost(lanes) = 0.0_wp, stress(lanes) = 0.0_wp

      if (present(without_texts)) then
         if (without_texts) call omit_texts(registry)
      end if
      frames = frame
      call add_wheel_constants(registry, 1, wheel)
      call add_mesh_constants(registry, 1, contact, .false., pair, reference)
      call add_wheel_teeth(registry, 1, wheel, gear, 0.0_wp)
      call add_mesh_teeth(registry, 1, contact, pair)
      call add_gearbox_outputs(registry, whole)
      call add_wheel_outputs(registry, 1, motion)
      call add_mesh_outputs(registry, 1, mesh, points)
      call add_pair_outputs(registry, 1, tooth_pair)
      call add_coast_outputs(registry, 1, mesh)
      call add_wheel_position(registry, 1, wheel)
      call add_mesh_position(registry, 1, contact)
      call add_bearing_outputs(registry, 1, reaction)
      call add_pose(registry, frames, [0.0_wp, 0.0_wp, 0.0_wp])
      call add_mount(registry, housing, frames)
      call add_accelerometer(registry, 1, housing, frames)
      call add_shaft_constants(registry, 1, shaft)
      call add_shaft_outputs(registry, 1, twisted)
      call add_loss_outputs(registry, 1, lost)
      call add_root_outputs(registry, 1, stress, stress)
      call add_temperature_outputs(registry, 1, stress, stress)
      call take_rows(registry, table)
   end subroutine list_outputs

   !> List the extremes over a run: their outputs, with separate texts.
   subroutine list_extremes(table)
      type(output_t), intent(out), allocatable :: table(:)
      type(output_t), allocatable :: outputs(:)
      integer :: i

      call list_outputs(outputs)
      table = [(outputs(findloc(outputs%name, extremes_table(i)%output, dim=1)), i=1, size(extremes_table))]
      table%long_name = extremes_table%long_name
      table%monitored = extremes_table%monitored
      table%is_largest = extremes_table%is_largest
   end subroutine list_extremes

   !> Determine the outputs of a gearbox, their offsets in the array of values, and the constant values.
   subroutine set_output_offsets(gearbox)
      type(gearbox_t), intent(inout), target :: gearbox
      type(output_t), allocatable :: table(:)
      integer :: i

      gearbox%n_drive_slots = maxval(gearbox%contacts%n_slots)
      gearbox%n_pair_slots = gearbox%n_drive_slots*merge(2, 1, any(gearbox%contacts%flank == flank_coast))
      call list_outputs(table, without_texts=.true.)
      gearbox%output_counts = [(elements_of(gearbox, table(i))*table(i)%length, i=1, size(table))]
      if (allocated(gearbox%output_offsets)) deallocate (gearbox%output_offsets, gearbox%constants)
      allocate (gearbox%output_offsets(size(table)))
      gearbox%n_values = 0
      do i = 1, size(table)
         gearbox%output_offsets(i) = gearbox%n_values
         gearbox%n_values = gearbox%n_values + gearbox%output_counts(i)
      end do
      call rows_before_sections(table, gearbox%rows_before)
      gearbox%output_needs = table%needs
      gearbox%output_is_constant = table%is_static
      allocate (gearbox%constants(gearbox%n_values), source=nan)
      call store_constants(gearbox, gearbox%constants)
   end subroutine set_output_offsets

   !> Number of elements of an output; 0: the gearbox does not have it.
   pure integer function elements_of(gearbox, output) result(n)
      type(gearbox_t), intent(in) :: gearbox
      type(output_t), intent(in) :: output

      select case (output%of)
      case (dims_wheel)
         n = size(gearbox%wheels)
      case (dims_mesh)
         n = size(gearbox%pairs)
      case (dims_mesh_pair)
         n = size(gearbox%pairs)*gearbox%n_pair_slots
      case (dims_shaft)
         n = size(gearbox%shafts)
      case (dims_accelerometer)
         n = size(gearbox%housing%accelerometers)
      case default
         n = 1
      end select
      if (output%section == in_pose .and. gearbox%housing%kind == housing_fixed) n = 0
      if (output%section == in_mount .and. .not. gearbox%housing%is_mounted) n = 0
      if (output%section == in_coast .and. gearbox%n_pair_slots == gearbox%n_drive_slots) n = 0
      if (output%section == in_losses .and. size(gearbox%losses) == 0) n = 0
      if (output%section == in_roots .and. .not. gearbox%has_root_outputs) n = 0
      if (output%section == in_temperatures .and. .not. allocated(gearbox%thermal)) n = 0
   end function elements_of

   !> Store the constant values.
   subroutine store_constants(gearbox, values)
      type(gearbox_t), intent(in), target :: gearbox
      real(wp), intent(inout), target, contiguous :: values(:)
      type(registry_t) :: registry
      integer :: i

      call store_in(registry, gearbox%rows_before, gearbox%output_offsets, 1, values)
      do i = 1, size(gearbox%wheels)
         call add_wheel_constants(registry, i, gearbox%wheels(i))
         call add_wheel_teeth(registry, i, gearbox%wheels(i), gearbox%gears(i), active_radius(gearbox, i))
         call add_wheel_position(registry, i, gearbox%wheels(i))
      end do
      do i = 1, size(gearbox%pairs)
         associate (contact => gearbox%contacts(gearbox%first(i)), pair => gearbox%pairs(i))
            call add_mesh_constants(registry, i, contact, gearbox%flanks(contact%i_flank)%flank%couples, pair, &
                                    gearbox%references(i))
            call add_mesh_teeth(registry, i, contact, pair)
            call add_mesh_position(registry, i, contact)
         end associate
      end do
      do i = 1, size(gearbox%shafts)
         call add_shaft_constants(registry, i, gearbox%shafts(i))
      end do
   end subroutine store_constants

end module evl_output_list
