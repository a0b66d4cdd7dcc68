!> Contributions of housing motion and gravity to dF/dy.
!>
!> Source: the derivatives of docs/theory/housing.md, one by one. Those with respect to y' are in evl_housing_dynamics.
module evl_housing_jacobian
   use evl_gearbox, only: add_turn, axle_acceleration, gearbox_t, of_angle, of_speed, transport_acceleration, wheel_position, &
                          wheel_speed
   use evl_housing, only: apparent_acceleration, at_omega, at_orientation, at_position, at_velocity, frame_t, housing_t, &
                          mount_force, n_housing_states, norm_rate
   use evl_jacobian_entries, only: add_entry, full_matrix, jacobian_entries
   use evl_kinds, only: wp
   use evl_rotation, only: cross, crossed, identity, rotated_back_gradient, rotated_gradient, skew, turned, turned_back
   use evl_support, only: axle_deviation
   use evl_wheel_loads, only: evaluate_load, load_terms, wheel_acceleration, wheel_follows_ground, wheel_housing_torque, &
                              wheel_spin_torque
   implicit none (type, external)
   private

   public :: ride_gradient, mounted_gradient, housing_gradient

contains

   !> Add the contributions to one wheel and its support, before the rows of psi' are coupled with that of the reference wheel.
   pure subroutine ride_gradient(gearbox, index, t, y, integers, frame, entries, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: t, y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      type(frame_t), intent(in) :: frame !! at y, y'
      type(jacobian_entries), intent(in) :: entries
      real(wp), intent(inout) :: values(entries%n_entries)
      real(wp) :: centre(3), velocity(3), by_centre(3, 3), row(3), d(3)
      integer :: j, k

      associate (wheel => gearbox%wheels(index), support => gearbox%wheels(index)%support, work => gearbox%i_work)
         call wheel_position(wheel, t, y, centre, velocity)
         velocity = [axle_deviation(support, y, 1), 0.0_wp]
         if (wheel%prescribed == 0) &
            call add_turn(wheel, of_speed, work, -wheel_spin_torque(gearbox, index, frame%omega(3), t, y, integers), entries, &
                          values)
         by_centre = gradient_by_centre(frame)
         do j = 1, support%n
            row = [support%direction(:, j), 0.0_wp]
            do k = 1, support%n
               d = [support%direction(:, k), 0.0_wp]
               associate (i => support%i_state(j) + 1, s => support%i_state(k))
                  call add_entry(entries, i, s, dot_product(row, turned(by_centre, d)), values)
                  call add_entry(entries, i, s + 1, 2*dot_product(row, cross(frame%omega, d)), values)
               end associate
            end do
         end do
         if (gearbox%housing%is_mounted) return
         if (wheel_follows_ground(gearbox, index)) call add_turn(wheel, of_speed, work, wheel%inertia*frame%alpha(3), entries, &
                                                                 values)
         do k = 1, support%n
            d = [support%direction(:, k), 0.0_wp]
            associate (s => support%i_state(k))
               call add_entry(entries, work, s, support%mass*dot_product(velocity, turned(by_centre, d)), values)
               call add_entry(entries, work, s + 1, support%mass*dot_product(d, transport_acceleration(wheel, frame, centre)), &
                              values)
            end associate
         end do
      end associate
   end subroutine ride_gradient

   !> Add the effect of a mounted housing's motion on one wheel and its support, and of the wheel's loads on the housing, before the
   !> rows of psi' are coupled.
   pure subroutine mounted_gradient(gearbox, index, t, y, integers, frame, jacobian)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: t, y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      type(frame_t), intent(in) :: frame !! at y, y'
      real(wp), intent(inout) :: jacobian(gearbox%n_states, gearbox%n_states)
      real(wp) :: centre(3), velocity(3), row(3)
      integer :: j

      call wheel_position(gearbox%wheels(index), t, y, centre, velocity)
      associate (support => gearbox%wheels(index)%support, p => gearbox%housing%i_state + at_orientation, &
                 o => gearbox%housing%i_state + at_omega)
         do j = 1, support%n
            row = [support%direction(:, j), 0.0_wp]
            associate (i => support%i_state(j) + 1)
               jacobian(i, p:p + 3) = jacobian(i, p:p + 3) + matmul(row, gradient_by_orientation(frame))
               jacobian(i, o:o + 2) = jacobian(i, o:o + 2) + turned_back(gradient_by_omega(frame, centre, velocity), row)
            end associate
         end do
      end associate
      call ground_gradient(gearbox, index, t, y, integers, frame, jacobian)
   end subroutine mounted_gradient

   !> Loads of a wheel in a mounted housing: their torques depend on its Omega_z, and some act from the ground. Terms that depend on
   !> the meshes through a prescribed speed are not included.
   pure subroutine ground_gradient(gearbox, index, t, y, integers, frame, jacobian)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      real(wp), intent(in) :: t, y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      type(frame_t), intent(in) :: frame
      real(wp), intent(inout) :: jacobian(gearbox%n_states, gearbox%n_states)
      type(jacobian_entries) :: entries
      type(load_terms) :: terms
      real(wp), dimension(2) :: from_ground, from_housing ! damping and stiffness
      real(wp) :: omega, total, ground, by_speed, by_angle, by_spin
      integer :: i

      call full_matrix(gearbox%n_states, entries)
      from_ground = 0
      from_housing = 0
      total = 0
      do i = 1, size(gearbox%loads)
         associate (load => gearbox%loads(i)%load)
            if (load%wheel /= index) cycle
            call evaluate_load(gearbox, i, t, y, integers, frame%omega(3), terms)
            total = total + terms%torque
            if (load%against_housing) then
               from_housing = from_housing + [terms%damping, terms%stiffness]
            else
               from_ground = from_ground + [terms%damping, terms%stiffness]
            end if
         end associate
      end do
      associate (wheel => gearbox%wheels(index), work => gearbox%i_work, spin => frame%omega(3), &
                 damping => from_ground(1), o => gearbox%housing%i_state + at_omega + 2)
         omega = wheel_speed(wheel, y)
         total = total + wheel_spin_torque(gearbox, index, spin, t, y, integers)
         if (wheel%prescribed > 0) total = wheel%inertia*wheel_acceleration(gearbox, index, 0.0_wp, integers)
         ground = total - wheel_housing_torque(gearbox, index, spin, total, t, y, integers)
         by_speed = -damping
         by_angle = -from_ground(2)
         by_spin = -damping
         if (wheel%prescribed > 0 .and. wheel_follows_ground(gearbox, index)) then
            by_speed = from_housing(1)
            by_angle = from_housing(2)
            by_spin = 0
         else if (wheel%prescribed == 0) then
            jacobian(wheel%i_speed, o) = jacobian(wheel%i_speed, o) + damping/wheel%rotor_inertia
            jacobian(work, o) = jacobian(work, o) + damping*omega
         else
            call add_turn(wheel, of_speed, work, -wheel%inertia*frame%alpha(3), entries, jacobian)
         end if
         call add_turn(wheel, of_speed, work, -spin*by_speed, entries, jacobian)
         call add_turn(wheel, of_angle, work, -spin*by_angle, entries, jacobian)
         jacobian(work, o) = jacobian(work, o) - ground - spin*by_spin
         call add_turn(wheel, of_speed, o, -by_speed, entries, jacobian)
         call add_turn(wheel, of_angle, o, -by_angle, entries, jacobian)
         jacobian(o, o) = jacobian(o, o) - by_spin
      end associate
   end subroutine ground_gradient

   !> d b/d c at a point.
   pure function gradient_by_centre(frame) result(gradient)
      type(frame_t), intent(in) :: frame
      real(wp) :: gradient(3, 3)

      gradient = skew(frame%alpha) + crossed(frame%omega, skew(frame%omega))
   end function gradient_by_centre

   !> d b/d Omega at a point.
   pure function gradient_by_omega(frame, centre, velocity) result(gradient)
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: centre(3), velocity(3)
      real(wp) :: gradient(3, 3)

      gradient = -skew(cross(frame%omega, centre)) - crossed(frame%omega, skew(centre)) - 2*skew(velocity)
   end function gradient_by_omega

   !> d a/d p at constant v'.
   pure function gradient_by_orientation(frame) result(gradient)
      type(frame_t), intent(in) :: frame
      real(wp) :: gradient(3, 4), rate(3)

      associate (p => frame%orientation)
         rate = turned(frame%rotation, frame%acceleration)/dot_product(p, p)**2 ! v' - g
         gradient = rotated_back_gradient(p, rate)
      end associate
   end function gradient_by_orientation

   !> Add the rows of a mounted housing, and the powers of its mount.
   pure subroutine housing_gradient(gearbox, y, yp, frame, jacobian)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(gearbox%n_states), yp(gearbox%n_states)
      type(frame_t), intent(in) :: frame !! at y, y'
      real(wp), intent(inout) :: jacobian(gearbox%n_states, gearbox%n_states)
      real(wp) :: wrench(6, n_housing_states)
      integer :: i

      wrench = 0
      associate (housing => gearbox%housing, first => gearbox%housing%i_state)
         call kinematic_gradient(housing, frame, jacobian)
         call mount_gradient(gearbox, frame, wrench, jacobian)
         call add_body(frame, housing%mass, housing%centre, [0.0_wp, 0.0_wp, 0.0_wp], wrench)
         associate (o => at_omega + 1)
            wrench(4:6, o:o + 2) = wrench(4:6, o:o + 2) + crossed(frame%omega, housing%inertia) &
                                   - skew(turned(housing%inertia, frame%omega))
         end associate
         do i = 1, size(gearbox%wheels)
            call add_wheel(gearbox, i, frame, y, yp, wrench, jacobian)
         end do
         associate (rows => first + at_velocity, columns => first + n_housing_states - 1)
            jacobian(rows:rows + 5, first:columns) = jacobian(rows:rows + 5, first:columns) + wrench
         end associate
      end associate
   end subroutine housing_gradient

   !> Rows of r' and p'.
   pure subroutine kinematic_gradient(housing, frame, jacobian)
      type(housing_t), intent(in) :: housing
      type(frame_t), intent(in) :: frame
      real(wp), intent(inout) :: jacobian(:, :)
      integer :: j

      associate (r => housing%i_state + at_position, p => housing%i_state + at_orientation, v => housing%i_state + at_velocity, &
                 o => housing%i_state + at_omega, quaternion => frame%orientation, q => frame%orientation(2:4))
         jacobian(r:r + 2, v:v + 2) = -identity
         jacobian(p + 1:p + 3, p) = -frame%omega/2
         jacobian(p, p + 1:p + 3) = frame%omega/2
         jacobian(p + 1:p + 3, p + 1:p + 3) = skew(frame%omega)/2
         do j = 0, 3
            jacobian(p:p + 3, p + j) = jacobian(p:p + 3, p + j) + 2*norm_rate*quaternion(1 + j)*quaternion
            jacobian(p + j, p + j) = jacobian(p + j, p + j) - norm_rate*(1 - dot_product(quaternion, quaternion))
         end do
         jacobian(p, o:o + 2) = q/2
         jacobian(p + 1:p + 3, o:o + 2) = -(quaternion(1)*identity + skew(q))/2
      end associate
   end subroutine kinematic_gradient

   !> Mount, external force and moment: subtract their derivatives with respect to the housing states, add those of their powers.
   pure subroutine mount_gradient(gearbox, frame, wrench, jacobian)
      type(gearbox_t), intent(in) :: gearbox
      type(frame_t), intent(in) :: frame
      real(wp), intent(inout) :: wrench(6, n_housing_states), jacobian(:, :)
      real(wp), dimension(3, n_housing_states) :: speed, mount
      real(wp) :: arm(3, 3), sweep(3), force(3), velocity(3), outside(3, 4), twist(3, 4), by_turn(3, 4)
      real(wp), dimension(n_housing_states) :: lost, done
      integer, parameter :: r = at_position + 1, p = at_orientation + 1, v = at_velocity + 1, o = at_omega + 1
      integer :: j

      associate (housing => gearbox%housing, quaternion => frame%orientation, rotation => frame%rotation)
         call mount_force(housing, frame, force, velocity)
         arm = -skew(housing%mount_point)
         sweep = cross(frame%omega, housing%centre)
         speed = 0
         speed(:, p:p + 3) = rotated_gradient(quaternion, cross(frame%omega, housing%mount_point))
         speed(:, v:v + 2) = identity
         speed(:, o:o + 2) = matmul(rotation, arm)
         by_turn = rotated_gradient(quaternion, housing%mount_point)
         do j = 1, n_housing_states
            mount(:, j) = -housing%damping*speed(:, j)
         end do
         do j = 1, 4
            mount(:, p + j - 1) = mount(:, p + j - 1) - housing%stiffness*by_turn(:, j)
         end do
         do j = 1, 3
            mount(j, r + j - 1) = mount(j, r + j - 1) - housing%stiffness(j)
         end do
         lost = 2*matmul(housing%damping*velocity, speed)
         lost(o:o + 2) = lost(o:o + 2) + 2*housing%turn_damping*frame%omega
         do j = 1, n_housing_states
            mount(:, j) = turned_back(rotation, mount(:, j))
         end do
         mount(:, p:p + 3) = mount(:, p:p + 3) + rotated_back_gradient(quaternion, force)
         outside = rotated_back_gradient(quaternion, housing%force)
         twist = rotated_back_gradient(quaternion, housing%moment)
         wrench(1:3, :) = wrench(1:3, :) - mount
         wrench(4:6, :) = wrench(4:6, :) - crossed(housing%mount_point, mount)
         wrench(1:3, p:p + 3) = wrench(1:3, p:p + 3) - outside
         wrench(4:6, p:p + 3) = wrench(4:6, p:p + 3) - crossed(housing%centre, outside) - twist
         call turn_gradient(housing, frame, wrench(4:6, p:p + 3), wrench(4:6, o:o + 2))
         done = 0
         done(p:p + 3) = matmul(sweep, outside) + matmul(frame%omega, twist)
         done(v:v + 2) = housing%force
         done(o:o + 2) = cross(housing%centre, turned_back(rotation, housing%force)) + turned_back(rotation, housing%moment)
         associate (first => housing%i_state, last => housing%i_state + n_housing_states - 1)
            jacobian(gearbox%i_dissipated, first:last) = jacobian(gearbox%i_dissipated, first:last) - lost
            jacobian(gearbox%i_work, first:last) = jacobian(gearbox%i_work, first:last) - done
         end associate
      end associate
   end subroutine mount_gradient

   !> Subtract the derivatives of the mount's torsional moment.
   pure subroutine turn_gradient(housing, frame, by_orientation, by_omega)
      type(housing_t), intent(in) :: housing
      type(frame_t), intent(in) :: frame
      real(wp), intent(inout) :: by_orientation(3, 4), by_omega(3, 3)
      real(wp) :: matrix(3, 3), of_turn(3, 3)
      integer :: j

      associate (p_0 => frame%orientation(1), q => frame%orientation(2:4), k => housing%turn_stiffness)
         of_turn = skew(q)
         matrix = skew(k*q)
         do j = 1, 3
            matrix(:, j) = matrix(:, j) - of_turn(:, j)*k(j)
            matrix(j, j) = matrix(j, j) + p_0*k(j)
            by_omega(j, j) = by_omega(j, j) + housing%turn_damping(j)
         end do
         by_orientation(:, 1) = by_orientation(:, 1) + 2*k*q
         by_orientation(:, 2:4) = by_orientation(:, 2:4) + 2*matrix
      end associate
   end subroutine turn_gradient

   !> Inertia of a point mass.
   pure subroutine add_body(frame, mass, centre, velocity, wrench)
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: mass, centre(3), velocity(3)
      real(wp), intent(inout) :: wrench(6, n_housing_states)
      real(wp) :: by_orientation(3, 4), by_omega(3, 3)
      integer, parameter :: p = at_orientation + 1, o = at_omega + 1

      by_orientation = mass*gradient_by_orientation(frame)
      by_omega = mass*gradient_by_omega(frame, centre, velocity)
      wrench(1:3, p:p + 3) = wrench(1:3, p:p + 3) + by_orientation
      wrench(4:6, p:p + 3) = wrench(4:6, p:p + 3) + crossed(centre, by_orientation)
      wrench(1:3, o:o + 2) = wrench(1:3, o:o + 2) + by_omega
      wrench(4:6, o:o + 2) = wrench(4:6, o:o + 2) + crossed(centre, by_omega)
   end subroutine add_body

   !> Inertia of a wheel and its support: derivatives with respect to the states of housing and support and the wheel's speed.
   pure subroutine add_wheel(gearbox, index, frame, y, yp, wrench, jacobian)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: y(gearbox%n_states), yp(gearbox%n_states)
      real(wp), intent(inout) :: wrench(6, n_housing_states)
      real(wp), intent(inout) :: jacobian(gearbox%n_states, gearbox%n_states)
      type(jacobian_entries) :: entries
      real(wp) :: centre(3), velocity(3), total(3), spin, d(3), by_position(3), by_rate(3)
      integer, parameter :: o = at_omega + 1
      integer :: j

      associate (wheel => gearbox%wheels(index), support => gearbox%wheels(index)%support, omega => frame%omega, &
                 row => gearbox%housing%i_state + at_velocity)
         call full_matrix(gearbox%n_states, entries)
         call wheel_position(wheel, frame%t, y, centre, velocity)
         total = apparent_acceleration(frame, centre, velocity) + axle_acceleration(wheel, frame%t, yp)
         call add_body(frame, support%mass, centre, velocity, wrench)
         spin = wheel%inertia*(omega(3) + wheel_speed(wheel, y)) - wheel%transverse_inertia*omega(3)
         associate (difference => wheel%inertia - wheel%transverse_inertia)
            wrench(4, o + 1:o + 2) = wrench(4, o + 1:o + 2) + [spin, omega(2)*difference]
            wrench(5, o) = wrench(5, o) - spin
            wrench(5, o + 2) = wrench(5, o + 2) - omega(1)*difference
         end associate
         call add_turn(wheel, of_speed, row + 3, wheel%inertia*omega(2), entries, jacobian)
         call add_turn(wheel, of_speed, row + 4, -wheel%inertia*omega(1), entries, jacobian)
         do j = 1, support%n
            d = [support%direction(:, j), 0.0_wp]
            by_position = turned(gradient_by_centre(frame), d)
            by_rate = 2*cross(omega, d)
            associate (s => support%i_state(j), mass => support%mass)
               jacobian(row:row + 2, s) = jacobian(row:row + 2, s) + mass*by_position
               jacobian(row + 3:row + 5, s) = jacobian(row + 3:row + 5, s) + mass*(cross(d, total) + cross(centre, by_position))
               jacobian(row:row + 2, s + 1) = jacobian(row:row + 2, s + 1) + mass*by_rate
               jacobian(row + 3:row + 5, s + 1) = jacobian(row + 3:row + 5, s + 1) + mass*cross(centre, by_rate)
            end associate
         end do
      end associate
   end subroutine add_wheel

end module evl_housing_jacobian
