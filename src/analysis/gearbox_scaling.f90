!> Scales of a gearbox: forces, penetrations, speeds and energies that follow from the loads and the initial condition.
!>
!> Error control is absolute, each state relative to its own scale. That of lengths is the static penetration h_0, that of their
!> rates h_0 times the natural frequency of the contact, that of the reference angle a fraction of a pitch. For shafts the static
!> twist is used likewise.
module evl_gearbox_scaling
   use evl_contact_point, only: base_arc
   use evl_elastic_law, only: elastic_result
   use evl_gearbox, only: gearbox_t
   use evl_housing, only: at_omega, at_orientation, at_position, at_velocity, n_housing_states
   use evl_kinds, only: pi, wp
   use evl_local_variables, only: i_omega, i_theta, n_track
   use evl_nominal_point, only: loads_at_start
   use evl_shaft, only: shaft_t
   use evl_status, only: code_invalid_input, code_ok, fail, status_t, subject_mesh
   use evl_tooth_contact, only: tooth_contact_t
   implicit none (type, external)
   private

   public :: gearbox_set_scales, gearbox_state_scales

   real(wp), parameter :: angle_share = 0.2_wp     !! scale of theta times the pitches per revolution: 1e-2 rad at 20 teeth
   real(wp), parameter :: track_factor = 3.0_wp    !! scale of zeta, and of rotation times rho, over h_0
   real(wp), parameter :: multiplier_factor = 1.0e3_wp !! scale of a multiplier over the force: it follows from the other states
   real(wp), parameter :: smallest_load = 1.0e-9_wp !! force scale of an unloaded mesh over b pi E* rho
   real(wp), parameter :: smallest_twist = 1.0e-9_wp !! of an unloaded shaft [rad]

   real(wp), parameter :: free_time = 1.0_wp !! time scale of the motion of a free housing [s]
   real(wp), parameter :: share = 0.01_wp    !! fraction of that motion: gears move a housing little compared with its weight

contains

   !> Force and penetration scales of all meshes at the nominal operating point. Errors: code_invalid_input if there are none.
   subroutine gearbox_set_scales(gearbox, status)
      type(gearbox_t), intent(inout) :: gearbox
      type(status_t), intent(inout) :: status
      integer :: i

      do i = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(i))
            contact%force_scale = max(gearbox%nominal%mesh_scale(contact%mesh), &
                                      smallest_load*pi*contact%e_star*abs(contact%pair%rho_0)*contact%width)
            ! rigid flanks have no deflection: their scale only sets the accuracy, so the loads that accelerate the wheels count too
            if (contact%rigid) contact%force_scale = max(contact%force_scale, &
                                                         gearbox%nominal%torque_scale/abs(contact%pair%advance))
            call static_penetration(gearbox, contact, contact%force_scale, contact%h_scale)
            if (.not. contact%h_scale > 0) then
               call fail(status, code_invalid_input, "its contact has no finite penetration under any load; check the" &
                         //" dimensions and materials of its wheels", subject_mesh, contact%mesh)
               return
            end if
            contact%rate_scale = sqrt(contact%force_scale*contact%h_scale*contact%mobility)
         end associate
      end do
   end subroutine gearbox_set_scales

   !> Scale of theta: a fraction of the pitch of the mesh with the highest mesh frequency.
   pure real(wp) function angle_scale(gearbox) result(scale)
      type(gearbox_t), intent(in) :: gearbox
      integer :: i

      scale = angle_share
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            if (wheel%teeth == 0) cycle
            ! integers before the division: identical for all wheels of a train without shafts
            scale = min(scale, angle_share/(wheel%teeth*real(abs(wheel%exact_ratio%above), wp)/real(wheel%exact_ratio%below, wp)))
         end associate
      end do
   end function angle_scale

   !> Penetration under a force. A force beyond the domain of the law is halved until the law is valid. 0 if no force is valid.
   subroutine static_penetration(gearbox, contact, force, h)
      type(gearbox_t), intent(in) :: gearbox
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(inout) :: force !! [N]
      real(wp), intent(out) :: h       !! [m]
      integer :: code

      do while (force > 0) ! false if NaN
         call gearbox%flanks(contact%i_flank)%flank%pair_under(contact, force, h, code)
         if (code == code_ok) return
         force = force/2
      end do
      h = 0
   end subroutine static_penetration

   !> Scales of states and residuals for error control.
   subroutine gearbox_state_scales(gearbox, speeds, state, row, duration)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: speeds(:)      !! initial angular velocities of the wheels; size 0 if not given [rad/s]
      real(wp), intent(out) :: state(gearbox%n_states), row(gearbox%n_states)
      real(wp), intent(in), optional :: duration !! duration of the run, if any [s]
      real(wp) :: speed, h(size(gearbox%contacts)), rate(size(gearbox%contacts)), frequency
      real(wp) :: start_force(size(gearbox%pairs)), start_torque(size(gearbox%shafts)), energy, housing_energy, time
      real(wp), dimension(2, size(gearbox%wheels)) :: arc, turn
      real(wp), dimension(n_housing_states) :: housing_state, housing_row
      integer :: i, j

      speed = gearbox%nominal%speed_scale
      start_force = 0
      start_torque = 0
      if (size(speeds) > 0) then
         speed = max(speed, maxval(abs(speeds/gearbox%wheels%ratio)))
         call loads_at_start(gearbox, speeds, start_force, start_torque)
      end if
      energy = 0
      do i = 1, size(gearbox%contacts)
         call mesh_scales(gearbox, gearbox%contacts(i), start_force(gearbox%contacts(i)%mesh), speeds, h(i), frequency, energy)
         rate(i) = h(i)*frequency
      end do
      call wheel_scales(gearbox, start_torque, speeds, h, rate, arc, turn, energy)
      state(i_theta) = angle_scale(gearbox)
      state(i_omega) = merge(speed, 1.0_wp, speed > 0)
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            if (wheel%i_psi > 0 .and. wheel%leader == i) state(wheel%i_psi:wheel%i_psi + 1) = turn(:, i)
            do j = 1, wheel%support%n
               state(wheel%support%i_state(j):wheel%support%i_state(j) + 1) = arc(:, i)
            end do
         end associate
      end do
      if (gearbox%housing%is_mounted) then
         time = free_time
         if (present(duration)) time = min(time, duration)
         call housing_scales(gearbox, time, housing_state, housing_row, housing_energy)
         energy = max(energy, housing_energy)
         state(gearbox%housing%i_state:gearbox%housing%i_state + n_housing_states - 1) = housing_state
      end if
      state(gearbox%i_dissipated) = merge(energy, 1.0_wp, energy > 0)
      state(gearbox%i_work) = state(gearbox%i_dissipated)
      row = state
      if (gearbox%housing%is_mounted) row(gearbox%housing%i_state:gearbox%housing%i_state + n_housing_states - 1) = housing_row
      do i = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(i))
            if (contact%i_normal == 0) cycle
            state(contact%i_normal) = multiplier_factor*contact%force_scale
            row(contact%i_normal) = contact%force_scale
         end associate
      end do
      do i = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(i), first => gearbox%contacts(i)%i_track)
            if (first == 0) cycle
            state(first:first + n_track - 1) = [track_factor*h(i)/contact%pair%rho_0, track_factor*h(i), h(i), h(i), 1.0_wp, &
                                                contact%pair%r_bb*h(i)]
            row(first:first + n_track - 1) = [h(i), 1.0_wp, h(i), h(i), h(i), h(i)]
         end associate
      end do
   end subroutine gearbox_state_scales

   !> Penetration, natural frequency and energy scale of a mesh under its nominal load, its load at the start, or the impact of the
   !> initial speeds. Equation T79.
   subroutine mesh_scales(gearbox, contact, start_force, speeds, h, frequency, energy)
      type(gearbox_t), intent(in) :: gearbox
      type(tooth_contact_t), intent(in) :: contact
      real(wp), intent(in) :: start_force      !! normal force at the start [N]; 0 if the start is not given
      real(wp), intent(in) :: speeds(:)        !! of the wheels at the start [rad/s]
      real(wp), intent(out) :: h               !! [m]
      real(wp), intent(out) :: frequency       !! [rad/s]
      real(wp), intent(inout) :: energy        !! raised to the energy of the mesh if that is larger [J]
      type(elastic_result) :: elastic
      real(wp) :: force, approach
      integer :: code

      force = max(gearbox%nominal%mesh_scale(contact%mesh), start_force)
      energy = max(energy, angle_scale(gearbox)*force*abs(contact%pair%advance))
      force = max(force, contact%force_scale)
      call static_penetration(gearbox, contact, force, h)
      call gearbox%flanks(contact%i_flank)%flank%pair_alone(contact, h, elastic, code)
      frequency = sqrt(elastic%d_h*contact%mobility)
      if (size(speeds) == 0) return
      approach = abs(base_arc(contact%pair, speeds(contact%wheel_a), speeds(contact%wheel_b)))
      h = max(h, approach/frequency)
      energy = max(energy, approach**2/contact%mobility/2)
   end subroutine mesh_scales

   !> Scales of the motion of wheels, value and rate: arcs [m], [m/s], the minimum over the meshes of a wheel; angles of its rotor
   !> [rad], [rad/s], the minimum over the meshes and shafts of the rotor's wheels, stored at its leading wheel. 1 if there are
   !> none.
   pure subroutine wheel_scales(gearbox, start_torque, speeds, h, rate, arc, turn, energy)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: start_torque(:)    !! of the shafts at the start [N m]
      real(wp), intent(in) :: speeds(:)          !! of the wheels at the start [rad/s]
      real(wp), intent(in) :: h(:), rate(:)      !! of the meshes [m], [m/s]
      real(wp), intent(out) :: arc(:, :), turn(:, :)
      real(wp), intent(inout) :: energy          !! raised to the energy of the shafts if that is larger [J]
      real(wp) :: twist(2)
      integer :: i, m

      arc = huge(arc)
      turn = huge(turn)
      do m = 1, size(gearbox%contacts)
         associate (a => gearbox%contacts(m)%wheel_a, b => gearbox%contacts(m)%wheel_b)
            arc(:, a) = min(arc(:, a), [h(m), rate(m)])
            arc(:, b) = min(arc(:, b), [h(m), rate(m)])
         end associate
      end do
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            if (abs(wheel%base_radius) > 0) turn(:, wheel%leader) = min(turn(:, wheel%leader), arc(:, i)/abs(wheel%base_radius))
         end associate
      end do
      do i = 1, size(gearbox%shafts)
         if (gearbox%shafts(i)%rigid) cycle
         call shaft_scales(gearbox, gearbox%shafts(i), max(gearbox%nominal%shaft_scale(i), start_torque(i)), speeds, twist, energy)
         associate (a => gearbox%wheels(gearbox%shafts(i)%wheel_a)%leader, b => gearbox%wheels(gearbox%shafts(i)%wheel_b)%leader)
            turn(:, a) = min(turn(:, a), twist)
            turn(:, b) = min(turn(:, b), twist)
         end associate
      end do
      where (arc >= huge(arc)) arc = 1
      where (turn >= huge(turn)) turn = 1
   end subroutine wheel_scales

   !> Twist of an elastic shaft and its rate under the loads, or due to the difference of the initial speeds of its wheels.
   pure subroutine shaft_scales(gearbox, shaft, torque, speeds, twist, energy)
      type(gearbox_t), intent(in) :: gearbox
      type(shaft_t), intent(in) :: shaft
      real(wp), intent(in) :: torque           !! torque that it transmits [N m]
      real(wp), intent(in) :: speeds(:)        !! as in wheel_scales
      real(wp), intent(out) :: twist(2)        !! [rad], [rad/s]
      real(wp), intent(inout) :: energy        !! raised to the energy of the shaft if that is larger [J]
      real(wp) :: angle, mobility, frequency, difference

      associate (a => gearbox%wheels(shaft%wheel_a), b => gearbox%wheels(shaft%wheel_b))
         angle = torque/shaft%stiffness
         mobility = 1/a%rotor_inertia + 1/b%rotor_inertia
      end associate
      if (.not. angle > 0) angle = smallest_twist
      frequency = sqrt(shaft%stiffness*mobility)
      if (size(speeds) > 0) then
         difference = abs(speeds(shaft%wheel_a) - speeds(shaft%wheel_b))
         angle = max(angle, difference/frequency)
         energy = max(energy, difference**2/mobility/2)
      end if
      twist = angle*[1.0_wp, frequency]
   end subroutine shaft_scales

   !> Scales of the states and of the residuals, and the corresponding energy. Positions and speeds get the scales of a long run:
   !> those of a short run could be below the rounding error of positions far from the origin.
   pure subroutine housing_scales(gearbox, time, state, row, energy)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: time   !! time in which loads supply energy [s]
      real(wp), intent(out) :: state(n_housing_states), row(n_housing_states)
      real(wp), intent(out) :: energy !! [J]
      real(wp) :: mass, inertia, force, moment, position, speed, angle, turn, energies(2)

      associate (housing => gearbox%housing)
         mass = housing%mass + sum(gearbox%wheels%support%mass)
         inertia = (housing%inertia(1, 1) + housing%inertia(2, 2) + housing%inertia(3, 3))/3
         force = sum(gearbox%contacts%force_scale) + mass*norm2(housing%gravity) + norm2(housing%force)
         moment = force*maxval(abs(gearbox%wheels%pitch_radius)) + norm2(housing%moment)
         call response(force, mass, minval(housing%stiffness), norm2(housing%velocity), time, position, speed, energies(1))
         call response(moment, inertia, minval(housing%turn_stiffness), norm2(housing%omega), time, angle, turn, energies(2))
      end associate
      state(at_position + 1:at_position + 3) = position
      state(at_orientation + 1:at_orientation + 4) = min(angle, 1.0_wp)/2
      state(at_velocity + 1:at_velocity + 3) = speed
      state(at_omega + 1:at_omega + 3) = turn
      row = state
      row(at_velocity + 1:at_velocity + 3) = mass*speed
      row(at_omega + 1:at_omega + 3) = inertia*turn
      energy = sum(energies)
   end subroutine housing_scales

   !> Displacement and speed of a body under a load, and its energy within a time.
   pure subroutine response(load, inertia, stiffness, start, time, distance, speed, energy)
      real(wp), intent(in) :: load, inertia, stiffness !! stiffness 0: free
      real(wp), intent(in) :: start                    !! speed at the start
      real(wp), intent(in) :: time                     !! [s]
      real(wp), intent(out) :: distance, speed, energy

      real(wp) :: period

      period = free_time
      if (stiffness > 0) period = min(free_time, sqrt(inertia/stiffness))
      speed = share*max(load/inertia*period, start)
      distance = speed*period
      energy = inertia*(share*max(load/inertia*min(period, time), start))**2/2
   end subroutine response

end module evl_gearbox_scaling
