!> The table of outputs: all sections in their order, with empty objects, as a teller that lists asks for them; and what of it a
!> gearbox has.
module evl_output_list
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use evl_constant_outputs, only: active_radius, tell_mesh_constants, tell_mesh_teeth, tell_wheel_constants, tell_wheel_teeth
   use evl_gear, only: gear_t
   use evl_gearbox, only: gearbox_t, section_t, wheel_t
   use evl_gearbox_watch, only: extremes_table
   use evl_housing, only: frame_t, housing_fixed
   use evl_housing_outputs, only: tell_accelerometer, tell_bearing, tell_mesh_position, tell_mount, tell_pose, &
                                  tell_wheel_position
   use evl_kinds, only: wp
   use evl_lane_columns, only: find_lanes
   use evl_mesh_geometry, only: spur_pair_t
   use evl_mesh_outputs, only: mesh_points, mesh_sum, tell_coast, tell_mesh
   use evl_mesh_reference, only: mesh_reference_t
   use evl_motion_outputs, only: tell_gearbox, tell_shaft, tell_shaft_constants, tell_wheel, wheel_motion
   use evl_output, only: dims_accelerometer, dims_mesh, dims_mesh_pair, dims_shaft, dims_wheel, in_coast, in_mount, in_pose, &
                         output_t
   use evl_pair_outputs, only: no_point, nowhere, tell_pair
   use evl_rotation, only: identity
   use evl_shaft, only: shaft_t
   use evl_teller, only: fill, list_places, take_rows, teller_t
   use evl_tooth_contact, only: contact_state, flank_coast, no_force, no_mode, tooth_contact_t
   implicit none (type, external)
   private

   public :: list_extremes, list_outputs, place_outputs

contains

   !> The table: every section told once, in its order.
   subroutine list_outputs(table, without_texts)
      type(output_t), intent(out), allocatable :: table(:)
      logical, intent(in), optional :: without_texts !! places alone: units, symbols and texts stay blank
      type(teller_t) :: teller
      type(frame_t), parameter :: frame = frame_t(position=0.0_wp, velocity=0.0_wp, orientation=0.0_wp, rotation=identity, &
                                                  omega=0.0_wp, alpha=0.0_wp, acceleration=0.0_wp)
      type(wheel_t) :: wheel
      type(tooth_contact_t) :: contact
      type(spur_pair_t) :: pair
      type(mesh_reference_t) :: reference
      type(gear_t) :: gear
      type(wheel_motion) :: motion
      type(contact_state) :: at
      type(mesh_sum) :: total
      type(mesh_points) :: points
      type(shaft_t) :: shaft

      if (present(without_texts)) then
         if (without_texts) call list_places(teller)
      end if
      at%mode = no_mode
      at%point = no_point
      call tell_wheel_constants(teller, 1, wheel)
      call tell_mesh_constants(teller, 1, contact, .false., pair, reference)
      call tell_wheel_teeth(teller, 1, wheel, gear, 0.0_wp)
      call tell_mesh_teeth(teller, 1, contact, pair)
      call tell_gearbox(teller, 0.0_wp, 0, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp)
      call tell_wheel(teller, 1, motion)
      call tell_mesh(teller, 1, at, 0.0_wp, 0.0_wp, 0.0_wp, total, points)
      call tell_pair(teller, 1, contact, at%mode, no_point, nowhere, no_force, 0, 0)
      call tell_coast(teller, 1, 0.0_wp, 0.0_wp)
      call tell_wheel_position(teller, 1, wheel)
      call tell_mesh_position(teller, 1, contact)
      call tell_bearing(teller, 1, spread(0.0_wp, 1, 6))
      call tell_pose(teller, frame, spread(0.0_wp, 1, 3))
      call tell_mount(teller, 0.0_wp)
      call tell_accelerometer(teller, 1, 0.0_wp)
      call tell_shaft_constants(teller, 1, shaft)
      call tell_shaft(teller, 1, 0.0_wp, 0.0_wp, 0.0_wp)
      call take_rows(teller, table)
   end subroutine list_outputs

   !> The extremes that are told over a run: the outputs that they are of, with texts of their own.
   subroutine list_extremes(table)
      type(output_t), intent(out), allocatable :: table(:)
      type(output_t), allocatable :: outputs(:)
      integer :: i

      call list_outputs(outputs)
      table = [(outputs(findloc(outputs%name, extremes_table(i)%output, dim=1)), i=1, size(extremes_table))]
      table%long_name = extremes_table%long_name
      table%watched = extremes_table%watched
      table%is_largest = extremes_table%is_largest
   end subroutine list_extremes

   !> Which outputs a gearbox has, where they stand among its values, and the values that do not change.
   subroutine place_outputs(gearbox)
      type(gearbox_t), intent(inout), target :: gearbox
      type(output_t), allocatable :: table(:)
      integer :: i

      gearbox%n_drive_places = maxval(gearbox%contacts%n_slots)
      gearbox%n_pair_places = gearbox%n_drive_places*merge(2, 1, any(gearbox%contacts%flank == flank_coast))
      call list_outputs(table, without_texts=.true.)
      gearbox%output_counts = [(elements_of(gearbox, table(i))*table(i)%length, i=1, size(table))]
      allocate (gearbox%output_offsets(size(table)))
      gearbox%n_values = 0
      do i = 1, size(table)
         gearbox%output_offsets(i) = gearbox%n_values
         gearbox%n_values = gearbox%n_values + gearbox%output_counts(i)
      end do
      allocate (gearbox%output_sections(maxval(table%section)))
      do i = size(table), 1, -1
         gearbox%output_sections(table(i)%section) = section_t(gearbox%output_offsets(i), elements_of(gearbox, table(i)))
      end do
      gearbox%output_needs = table%needs
      allocate (gearbox%output_lanes(size(table)))
      call find_lanes(table, gearbox%output_lanes)
      allocate (gearbox%constants(gearbox%n_values), source=ieee_value(1.0_wp, ieee_quiet_nan))
      call tell_constants(gearbox, gearbox%constants)
   end subroutine place_outputs

   !> How many elements an output is told of; 0: it is not there.
   pure integer function elements_of(gearbox, output) result(n)
      type(gearbox_t), intent(in) :: gearbox
      type(output_t), intent(in) :: output

      select case (output%of)
      case (dims_wheel)
         n = size(gearbox%wheels)
      case (dims_mesh)
         n = size(gearbox%pairs)
      case (dims_mesh_pair)
         n = size(gearbox%pairs)*gearbox%n_pair_places
      case (dims_shaft)
         n = size(gearbox%shafts)
      case (dims_accelerometer)
         n = size(gearbox%housing%accelerometers)
      case default
         n = 1
      end select
      if (output%section == in_pose .and. gearbox%housing%kind == housing_fixed) n = 0
      if (output%section == in_mount .and. .not. gearbox%housing%is_mounted) n = 0
      if (output%section == in_coast .and. gearbox%n_pair_places == gearbox%n_drive_places) n = 0
   end function elements_of

   !> The values that do not change.
   subroutine tell_constants(gearbox, values)
      type(gearbox_t), intent(in), target :: gearbox
      real(wp), intent(inout), target, contiguous :: values(:)
      type(teller_t) :: teller
      integer :: i

      call fill(teller, gearbox%output_sections, values)
      do i = 1, size(gearbox%wheels)
         call tell_wheel_constants(teller, i, gearbox%wheels(i))
         call tell_wheel_teeth(teller, i, gearbox%wheels(i), gearbox%gears(i), active_radius(gearbox, i))
         call tell_wheel_position(teller, i, gearbox%wheels(i))
      end do
      do i = 1, size(gearbox%pairs)
         associate (contact => gearbox%contacts(gearbox%first(i)), pair => gearbox%pairs(i))
            call tell_mesh_constants(teller, i, contact, gearbox%flanks(contact%i_flank)%flank%couples, pair, &
                                     gearbox%references(i))
            call tell_mesh_teeth(teller, i, contact, pair)
            call tell_mesh_position(teller, i, contact)
         end associate
      end do
      do i = 1, size(gearbox%shafts)
         call tell_shaft_constants(teller, i, gearbox%shafts(i))
      end do
   end subroutine tell_constants

end module evl_output_list
