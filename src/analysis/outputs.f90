!> Evaluation of outputs: all outputs at one state, or those requested by a sampler at up to eight states.
!>
!> One procedure defines each row of the table with the formula of its value, for eight states at once: see
!> `evl_output_registry`. The values of a sampler are ordered by output.
module evl_outputs
   use evl_gearbox, only: gearbox_t
   use evl_housing, only: housing_fixed
   use evl_housing_outputs, only: add_accelerometer, add_mount, add_pose
   use evl_kinds, only: lanes, wp
   use evl_mesh_outputs, only: add_coast_outputs, add_mesh_outputs, evaluate_mesh, find_points, mesh_lanes, mesh_points
   use evl_motion_outputs, only: add_gearbox_outputs, add_loss_outputs, add_shaft_outputs, add_wheel_outputs, find_energies, &
                                 find_losses, find_shaft_motion, find_wheel_motion, gearbox_lanes, shaft_lanes, wheel_lanes
   use evl_output, only: needs_meshes, needs_nothing, needs_pairs, needs_points, needs_positions, needs_pressures, needs_rates, &
                         needs_reactions, needs_roots, needs_temperatures, needs_torques, none
   use evl_output_registry, only: registry_t, store_in
   use evl_output_states, only: evaluate_states, output_states, states_create
   use evl_pair_outputs, only: add_pairs
   use evl_root_outputs, only: add_root_stresses
   use evl_status, only: has_failed, status_t
   use evl_torque_outputs, only: add_bearing_outputs, find_load_torques, find_reactions, find_shaft_torque
   implicit none (type, external)
   private

   public :: gearbox_outputs, output_sampler, request_all, sample_outputs, sample_state, sampler_create

   !> Requested outputs, and work arrays of `sample_outputs`.
   type :: output_sampler
      integer, allocatable :: requested(:)           !! indices in the table
      integer, allocatable :: before(:)           !! number of values before each output; last element: total
      integer :: needed = needs_nothing           !! bits of evl_output
      integer, allocatable :: columns(:)          !! of each row of the table, as for `store_in`
      integer, allocatable, private :: copies(:)  !! index of the previous request of the same output; 0: none
      type(output_states) :: states
      real(wp), allocatable, private :: values(:) !! (lanes, values) of one evaluation
   end type output_sampler

contains

   !> Request outputs of a gearbox.
   subroutine sampler_create(self, gearbox, requested)
      type(output_sampler), intent(out) :: self
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: requested(:) !! indices in the table
      integer :: i, n

      n = size(requested)
      self%requested = requested
      self%before = [(sum(gearbox%output_counts(requested(:i - 1))), i=1, n + 1)]
      self%copies = [(findloc(requested(:i - 1), requested(i), dim=1), i=1, n)]
      allocate (self%columns(size(gearbox%output_counts)), source=none)
      do i = n, 1, -1
         if (gearbox%output_counts(requested(i)) == 0 .or. gearbox%output_is_constant(requested(i))) cycle
         self%columns(requested(i)) = self%before(i)
         self%needed = ior(self%needed, gearbox%output_needs(requested(i)))
      end do
      if (asks(self, needs_torques) .and. (any(gearbox%wheels%prescribed > 0) .or. any(gearbox%shafts%rigid))) &
         self%needed = ior(self%needed, needs_meshes)
      call states_create(self%states, gearbox)
      allocate (self%values(lanes*self%before(n + 1)))
   end subroutine sampler_create

   !> Whether a quantity is required.
   pure logical function asks(self, what)
      type(output_sampler), intent(in) :: self
      integer, intent(in) :: what

      asks = iand(self%needed, what) == what
   end function asks

   !> All output values at a state.
   subroutine gearbox_outputs(gearbox, t, y, integers, reals, check, values, status)
      type(gearbox_t), intent(in), target :: gearbox
      real(wp), intent(in) :: t, y(gearbox%n_states), reals(size(gearbox%contacts))
      integer, intent(in) :: integers(gearbox%n_integers)
      logical, intent(in) :: check !! reject a state inconsistent with its modes, as `check_modes` does
      real(wp), intent(out) :: values(gearbox%n_values)
      type(status_t), intent(inout) :: status
      type(output_sampler), target :: sampler

      call request_all(sampler, gearbox)
      call sample_state(sampler, gearbox, t, y, integers, reals, check, values, status)
   end subroutine gearbox_outputs

   !> Request all outputs of a gearbox.
   subroutine request_all(self, gearbox)
      type(output_sampler), intent(out) :: self
      type(gearbox_t), intent(in) :: gearbox
      integer :: i

      call sampler_create(self, gearbox, [(i, i=1, size(gearbox%output_counts))])
   end subroutine request_all

   !> Values of the requested outputs at one state.
   subroutine sample_state(self, gearbox, t, y, integers, reals, check, values, status)
      type(output_sampler), intent(inout) :: self !! its work arrays change
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, y(gearbox%n_states), reals(size(gearbox%contacts))
      integer, intent(in) :: integers(gearbox%n_integers)
      logical, intent(in) :: check !! as for `gearbox_outputs`
      real(wp), intent(out) :: values(:)
      type(status_t), intent(inout) :: status
      real(wp) :: row(1, size(values))

      row = 0
      call sample_outputs(self, gearbox, 1, [t], reshape(y, [1, gearbox%n_states]), integers, reals, check, row, status)
      values = row(1, :)
   end subroutine sample_state

   !> Values of the requested outputs at states with a common discrete state, as within a step. Values of eight states evaluated
   !> together are bitwise identical to those of single states.
   subroutine sample_outputs(self, gearbox, n, t, y, integers, reals, check, values, status)
      type(output_sampler), intent(inout), target :: self !! its work arrays change
      type(gearbox_t), intent(in), target :: gearbox
      integer, intent(in) :: n                    !! number of states in use
      real(wp), intent(in) :: t(:), reals(size(gearbox%contacts))
      real(wp), intent(in), contiguous :: y(:, :) !! (states, n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      logical, intent(in) :: check                !! as for `gearbox_outputs`
      real(wp), intent(inout), contiguous :: values(:, :) !! (states, requested values)
      type(status_t), intent(inout) :: status
      integer :: first, last

      do first = 1, n, lanes
         last = min(size(t), first + lanes - 1)
         call evaluate_states(self%states, gearbox, self%needed, check, min(lanes, n - first + 1), t(first:last), &
                              y(first:last, :), integers, reals, status)
         if (has_failed(status)) return
         call store_outputs(self, gearbox)
         call take(self, gearbox, first, values)
      end do
   end subroutine sample_outputs

   !> Copy the values from lanes to states, including the constant values.
   pure subroutine take(self, gearbox, first, values)
      type(output_sampler), intent(in) :: self
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: first !! state of the first lane
      real(wp), intent(inout) :: values(:, :)
      integer :: from, i, k

      associate (last => first + self%states%n - 1)
         do i = 1, size(self%requested)
            from = self%before(i)
            if (self%copies(i) > 0) from = self%before(self%copies(i))
            do k = 1, self%before(i + 1) - self%before(i)
               if (gearbox%output_is_constant(self%requested(i))) then
                  values(first:last, self%before(i) + k) = gearbox%constants(gearbox%output_offsets(self%requested(i)) + k)
               else
                  values(first:last, &
                         self%before(i) + k) = self%values(lanes*(from + k - 1) + 1:lanes*(from + k - 1) + self%states%n)
               end if
            end do
         end do
      end associate
   end subroutine take

   !> Compute and store all rows whose requirements are met.
   subroutine store_outputs(self, gearbox)
      type(output_sampler), intent(inout), target :: self !! including its states
      type(gearbox_t), intent(in), target :: gearbox
      type(registry_t) :: registry
      type(gearbox_lanes) :: whole
      type(shaft_lanes) :: shaft
      real(wp), dimension(lanes, size(gearbox%wheels)) :: mesh_torque, load_torque, needed, lost
      integer :: i

      call store_in(registry, gearbox%rows_before, self%columns, lanes, self%values)
      mesh_torque = 0
      load_torque = 0
      if (asks(self, needs_meshes)) call store_meshes(self, registry, gearbox, mesh_torque)
      do i = 1, merge(size(gearbox%pairs), 0, asks(self, needs_pairs))
         call add_pairs(registry, gearbox, i, self%states, asks(self, needs_pressures), asks(self, needs_temperatures))
      end do
      if (asks(self, needs_roots)) call add_root_stresses(registry, gearbox, self%states)
      if (asks(self, needs_torques)) call find_load_torques(gearbox, self%states, mesh_torque, load_torque, needed)
      call find_energies(gearbox, self%states, asks(self, needs_rates), whole)
      call add_gearbox_outputs(registry, whole)
      call store_wheels(self, registry, gearbox, load_torque)
      do i = 1, size(gearbox%shafts)
         call find_shaft_motion(gearbox%shafts(i), self%states%y, shaft)
         if (asks(self, needs_torques)) call find_shaft_torque(gearbox%shafts(i), self%states%y, needed, shaft%torque)
         call add_shaft_outputs(registry, i, shaft)
      end do
      if (size(gearbox%losses) > 0) then
         call find_losses(gearbox, self%states, lost)
         do i = 1, size(gearbox%wheels)
            call add_loss_outputs(registry, i, lost(:, i))
         end do
      end if
      associate (housing => gearbox%housing, frames => self%states%frames)
         if (housing%kind /= housing_fixed) call add_pose(registry, frames, housing%gravity)
         if (housing%is_mounted) call add_mount(registry, housing, frames)
         do i = 1, size(housing%accelerometers)
            call add_accelerometer(registry, i, housing, frames)
         end do
      end associate
   end subroutine store_outputs

   !> Outputs of the meshes; adds their torques on every wheel.
   subroutine store_meshes(self, registry, gearbox, torque)
      type(output_sampler), intent(in) :: self
      type(registry_t), intent(inout) :: registry
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(inout) :: torque(lanes, size(gearbox%wheels)) !! incremented [N m]
      type(mesh_lanes) :: mesh
      type(mesh_points) :: points
      integer :: m

      do m = 1, size(gearbox%pairs)
         call evaluate_mesh(gearbox, m, self%states, asks(self, needs_positions), mesh)
         if (asks(self, needs_points)) call find_points(gearbox, mesh, self%states, points)
         call add_mesh_outputs(registry, m, mesh, points)
         if (gearbox%n_pair_slots > gearbox%n_drive_slots) call add_coast_outputs(registry, m, mesh)
         associate (contact => gearbox%contacts(gearbox%first(m)))
            torque(:, contact%wheel_a) = torque(:, contact%wheel_a) + mesh%torque_a
            torque(:, contact%wheel_b) = torque(:, contact%wheel_b) + mesh%torque_b
         end associate
      end do
   end subroutine store_meshes

   !> Outputs of the wheels, and their reactions on the housing.
   subroutine store_wheels(self, registry, gearbox, load_torque)
      type(output_sampler), intent(in) :: self
      type(registry_t), intent(inout) :: registry
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: load_torque(lanes, size(gearbox%wheels)) !! [N m]
      type(wheel_lanes) :: wheel
      real(wp), allocatable :: reactions(:, :, :)
      integer :: i

      do i = 1, size(gearbox%wheels)
         call find_wheel_motion(gearbox%wheels(i), self%states, asks(self, needs_rates), wheel)
         wheel%load_torque = load_torque(:, i)
         call add_wheel_outputs(registry, i, wheel)
      end do
      if (.not. asks(self, needs_reactions)) return
      allocate (reactions(lanes, 6, size(gearbox%wheels)))
      call find_reactions(gearbox, self%states, load_torque, reactions)
      do i = 1, size(gearbox%wheels)
         call add_bearing_outputs(registry, i, reactions(:, :, i))
      end do
   end subroutine store_wheels

end module evl_outputs
