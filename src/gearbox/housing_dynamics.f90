!> Newton's and Euler's equations of a mounted housing with all moving parts in it, and their solution for the accelerations.
!>
!> Source: docs/theory/housing.md, section 3. Both balances are about the origin of the housing frame and in its components; contact
!> forces cancel in them.
module evl_housing_dynamics
   use evl_gearbox, only: axle_acceleration, gearbox_t, wheel_position, wheel_speed
   use evl_gearbox_rates, only: gearbox_rates, multiplier_row
   use evl_housing, only: apparent_acceleration, at_omega, at_velocity, frame_acceleration, frame_t, housing_frame, &
                          mount_deflection, wheel_moment
   use evl_kinds, only: wp
   use evl_lapack, only: dgesv
   use evl_local_variables, only: i_omega
   use evl_rotation, only: cross, crossed, skew, turned, turned_back
   use evl_status, only: code_singular, fail, has_failed, status_t
   use evl_tooth_contact, only: contact_state
   use evl_wheel_loads, only: wheel_follows_ground
   implicit none (type, external)
   private

   public :: housing_residual, housing_coupling, coupled_rates, ground_energies

contains

   !> The two balances of a mounted housing: inertia less applied force and moment. They are not added to v' and Omega' themselves,
   !> since moments of 1e-20 N m would be lost beside 1 rad/s^2. Equations H8, H9.
   subroutine housing_residual(gearbox, t, y, yp, f, balances)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, y(gearbox%n_states), yp(gearbox%n_states)
      real(wp), intent(in) :: f(gearbox%n_states) !! as from `gearbox_rates`
      real(wp), intent(out) :: balances(6)        !! [N], [N m]
      type(frame_t) :: frame

      call housing_frame(gearbox%housing, t, y, frame, yp)
      call inertia_wrench(gearbox, frame, y, yp, balances)
      balances = balances - f(gearbox%housing%i_state + at_velocity:gearbox%housing%i_state + at_omega + 2)
   end subroutine housing_residual

   !> Rates of change of linear and angular momentum of housing and wheels, less gravity [N], [N m]. Equations H8, H9.
   pure subroutine inertia_wrench(gearbox, frame, y, yp, wrench)
      type(gearbox_t), intent(in) :: gearbox
      type(frame_t), intent(in) :: frame !! at y, y'
      real(wp), intent(in) :: y(gearbox%n_states), yp(gearbox%n_states)
      real(wp), intent(out) :: wrench(6)
      real(wp) :: centre(3), velocity(3), force(3)
      integer :: i

      associate (housing => gearbox%housing)
         force = housing%mass*frame_acceleration(frame, housing%centre)
         wrench(1:3) = force
         wrench(4:6) = cross(housing%centre, force) + turned(housing%inertia, frame%alpha) &
                       + cross(frame%omega, turned(housing%inertia, frame%omega))
      end associate
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            call wheel_position(wheel, frame%t, y, centre, velocity)
            force = wheel%support%mass*(apparent_acceleration(frame, centre, velocity) + axle_acceleration(wheel, frame%t, yp))
            wrench(1:3) = wrench(1:3) + force
            wrench(4:6) = wrench(4:6) + cross(centre, force) &
                          + wheel_moment(frame, wheel%inertia, wheel%transverse_inertia, wheel_speed(wheel, y), &
                                         wheel_speed(wheel, yp))
         end associate
      end do
   end subroutine inertia_wrench

   !> Coupling of accelerations through a mounted housing: dF/dy', without the unit matrix of the rows y' - f. The balances contain
   !> masses and moments of inertia, which may be far below the rounding of 1.
   pure subroutine housing_coupling(gearbox, frame, y, coupling)
      type(gearbox_t), intent(in) :: gearbox
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: y(gearbox%n_states)
      real(wp), intent(out) :: coupling(gearbox%n_states, gearbox%n_states)
      real(wp) :: tensor(3, 3), first_moment(3)
      integer :: i

      coupling = 0
      associate (housing => gearbox%housing, v => gearbox%housing%i_state + at_velocity, o => gearbox%housing%i_state + at_omega)
         first_moment = housing%mass*housing%centre
         tensor = housing%inertia - housing%mass*crossed(housing%centre, skew(housing%centre))
         do i = 1, size(gearbox%wheels)
            call couple_wheel(gearbox, i, frame, y, first_moment, tensor, coupling)
         end do
         associate (back => transpose(frame%rotation), mass => housing%mass + sum(gearbox%wheels%support%mass))
            coupling(v:v + 2, v:v + 2) = mass*back
            coupling(o:o + 2, v:v + 2) = crossed(first_moment, back)
         end associate
         coupling(v:v + 2, o:o + 2) = -skew(first_moment)
         coupling(o:o + 2, o:o + 2) = tensor
      end associate
   end subroutine housing_coupling

   !> Contribution of a wheel to the coupling; its mass and inertia are added to those of the housing about the origin.
   pure subroutine couple_wheel(gearbox, index, frame, y, first_moment, tensor, coupling)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: y(gearbox%n_states)
      real(wp), intent(inout) :: first_moment(3), tensor(3, 3) !! [kg m], [kg m^2]
      real(wp), intent(inout) :: coupling(:, :)
      real(wp) :: centre(3), velocity(3), direction(3)
      integer :: j

      associate (wheel => gearbox%wheels(index), support => gearbox%wheels(index)%support, &
                 v => gearbox%housing%i_state + at_velocity, o => gearbox%housing%i_state + at_omega)
         call wheel_position(wheel, frame%t, y, centre, velocity)
         first_moment = first_moment + support%mass*centre
         tensor = tensor - support%mass*crossed(centre, skew(centre))
         tensor(1, 1) = tensor(1, 1) + wheel%transverse_inertia
         tensor(2, 2) = tensor(2, 2) + wheel%transverse_inertia
         tensor(3, 3) = tensor(3, 3) + wheel%inertia
         coupling(o + 2, i_omega) = coupling(o + 2, i_omega) + wheel%inertia*wheel%ratio
         if (wheel%i_psi > 0) coupling(o + 2, wheel%i_speed) = coupling(o + 2, wheel%i_speed) + wheel%inertia
         if (.not. wheel_follows_ground(gearbox, index)) &
            coupling(gearbox%i_work, o + 2) = coupling(gearbox%i_work, o + 2) - wheel%inertia*wheel_speed(wheel, y)
         if (wheel%leader == index) then
            if (wheel_follows_ground(gearbox, index)) coupling(wheel%i_speed, o + 2) = coupling(wheel%i_speed, o + 2) + 1
            if (wheel%i_psi > 0 .and. wheel_follows_ground(gearbox, gearbox%reference)) &
               coupling(wheel%i_speed, o + 2) = coupling(wheel%i_speed, o + 2) - wheel%ratio
         end if
         do j = 1, support%n
            direction = [support%direction(:, j), 0.0_wp]
            associate (row => support%i_state(j) + 1)
               coupling(row, v:v + 2) = turned(frame%rotation, direction)
               coupling(row, o:o + 2) = cross(centre, direction)
               coupling(v:v + 2, row) = support%mass*direction
               coupling(o:o + 2, row) = support%mass*cross(centre, direction)
            end associate
         end do
      end associate
   end subroutine couple_wheel

   !> Rates of all states except the tracked ones, including the accelerations of a mounted housing.
   subroutine coupled_rates(gearbox, t, y, integers, reals, f, status, contacts)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, y(gearbox%n_states)
      integer, intent(in) :: integers(gearbox%n_integers)
      real(wp), intent(in) :: reals(size(gearbox%contacts))
      real(wp), intent(out) :: f(gearbox%n_states)
      type(status_t), intent(inout) :: status !! code_out_of_domain or code_singular
      type(contact_state), intent(inout), optional :: contacts(size(gearbox%contacts)) !! as in `gearbox_rates`
      integer :: i

      if (present(contacts)) then ! an absent array is passed by its address, which a sanitizer reports as a use
         call gearbox_rates(gearbox, t, y, integers, reals, f, status, contacts=contacts)
      else
         call gearbox_rates(gearbox, t, y, integers, reals, f, status)
      end if
      if (has_failed(status) .or. .not. gearbox%housing%is_mounted) return
      call solve_accelerations(gearbox, t, y, f, status)
      do i = 1, size(gearbox%contacts)
         if (gearbox%contacts(i)%leads) call multiplier_row(gearbox, i, y, integers, f)
      end do
   end subroutine coupled_rates

   !> Solve dF/dy' y' = -F(y, 0), which is linear in y'. All other rates depend only on v' and Omega', so that six equations remain.
   subroutine solve_accelerations(gearbox, t, y, f, status)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: t, y(gearbox%n_states)
      real(wp), intent(inout) :: f(gearbox%n_states) !! rates at v' = Omega' = 0, then y'
      type(status_t), intent(inout) :: status
      real(wp) :: coupling(gearbox%n_states, gearbox%n_states), others(6, gearbox%n_states), matrix(6, 6), solution(6, 1)
      real(wp) :: none(gearbox%n_states), balances(6)
      type(frame_t) :: frame
      integer :: pivots(6), info

      call housing_frame(gearbox%housing, t, y, frame)
      call housing_coupling(gearbox, frame, y, coupling)
      associate (first => gearbox%housing%i_state + at_velocity, last => gearbox%housing%i_state + at_omega + 2)
         others = coupling(first:last, :)
         matrix = others(:, first:last)
         others(:, first:last) = 0
         matrix = matrix - matmul(others, coupling(:, first:last))
         none = 0
         call housing_residual(gearbox, t, y, none, f, balances)
         solution(:, 1) = -balances - matmul(others, f)
         call dgesv(6, 1, matrix, 6, pivots, solution, 6, info)
         if (info /= 0) then
            call fail(status, code_singular, "the accelerations of the housing are not determined at this state")
            return
         end if
         f = f - matmul(coupling(:, first:last), solution(:, 1))
         f(first:last) = solution(:, 1)
      end associate
   end subroutine solve_accelerations

   !> Kinetic energy of a mounted housing and its wheels relative to the ground; energy of mount and gravity.
   pure subroutine ground_energies(gearbox, y, frame, kinetic, potential)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: y(gearbox%n_states)
      type(frame_t), intent(in) :: frame
      real(wp), intent(out) :: kinetic      !! [J]
      real(wp), intent(inout) :: potential  !! on entry that of contacts and supports; mount and gravity are added [J]
      real(wp) :: centre(3), velocity(3), spin
      integer :: i

      associate (housing => gearbox%housing, omega => frame%omega, q => frame%orientation(2:4))
         velocity = 0
         kinetic = mass_energy(housing%mass, housing%centre, velocity) &
                   + dot_product(omega, turned(housing%inertia, omega))/2
         potential = potential + dot_product(housing%stiffness, mount_deflection(housing, frame)**2)/2 &
                     + 2*dot_product(housing%turn_stiffness, q**2) - weight(housing%mass, housing%centre)
         do i = 1, size(gearbox%wheels)
            associate (wheel => gearbox%wheels(i))
               call wheel_position(wheel, frame%t, y, centre, velocity)
               spin = omega(3) + wheel_speed(wheel, y)
               kinetic = kinetic + mass_energy(wheel%support%mass, centre, velocity) &
                         + (wheel%transverse_inertia*(omega(1)**2 + omega(2)**2) + wheel%inertia*spin**2)/2
               potential = potential - weight(wheel%support%mass, centre)
            end associate
         end do
      end associate

   contains

      !> m |velocity relative to the ground|^2/2.
      pure real(wp) function mass_energy(mass, position, rate) result(energy)
         real(wp), intent(in) :: mass, position(3), rate(3)

         energy = mass*sum((turned_back(frame%rotation, frame%velocity) + cross(frame%omega, position) + rate)**2)/2
      end function mass_energy

      !> m g . position.
      pure real(wp) function weight(mass, position) result(energy)
         real(wp), intent(in) :: mass, position(3)

         energy = mass*dot_product(gearbox%housing%gravity, frame%position + turned(frame%rotation, position))
      end function weight

   end subroutine ground_energies

end module evl_housing_dynamics
