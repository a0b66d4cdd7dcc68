!> The gearbox as a whole and the motion of its wheels and shafts in eight states at once, as evl_motion_outputs has them in one.
module evl_motion_lanes
   use evl_force_lanes, only: lane_slot
   use evl_gearbox, only: gearbox_t, i_turns
   use evl_kinds, only: lanes, pi, wp
   use evl_lane_columns, only: none, of_acceleration, of_angle, of_angle_deviation, of_axle_acceleration, of_displacement, &
                               of_dissipated, of_kinetic, of_potential, of_shaft_loss, of_shaft_twist, of_speed, &
                               of_support_loss, of_theta, of_turns, of_velocity, of_work, put, put_same, put_whole
   use evl_line_lanes, only: turn_wheel
   use evl_local_variables, only: i_omega, i_theta
   use evl_shaft, only: shaft_t
   use evl_springs_and_dampers, only: damper_power
   use evl_support, only: support_t
   implicit none (type, external)
   private

   public :: tell_energies, tell_twists, tell_wheels

contains

   !> The gearbox as a whole.
   subroutine tell_energies(gearbox, columns, y, integers, slots, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: columns(:)
      real(wp), intent(in) :: y(lanes, gearbox%n_states)
      integer, intent(in) :: integers(:)
      type(lane_slot), intent(in) :: slots(*)
      real(wp), intent(inout) :: values(lanes, *)
      real(wp), dimension(lanes) :: kinetic, potential, psi, rate
      integer :: i

      call put(columns(of_theta), 1, y(:, i_theta), values)
      call put_whole(columns(of_turns), 1, integers(i_turns), values)
      call put(columns(of_dissipated), 1, y(:, gearbox%i_dissipated), values)
      call put(columns(of_work), 1, y(:, gearbox%i_work), values)
      if (columns(of_kinetic) == none .and. columns(of_potential) == none) return
      kinetic = 0
      potential = 0
      do i = 1, size(gearbox%flanks)
         associate (flank => gearbox%flanks(i)%flank)
            call flank%add_energy_in_lanes(gearbox%contacts, flank%first, flank%last, slots, potential)
         end associate
      end do
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            call turn_wheel(wheel%i_psi, y, psi, rate)
            call add_motion(wheel%inertia, wheel%ratio, y(:, i_omega), rate, kinetic)
            call add_support(wheel%support, y, kinetic, potential)
         end associate
      end do
      do i = 1, size(gearbox%shafts)
         call add_shaft(gearbox%shafts(i), y, potential)
      end do
      call put(columns(of_kinetic), 1, kinetic, values)
      call put(columns(of_potential), 1, potential, values)
   end subroutine tell_energies

   !> The energy of a wheel that turns.
   pure subroutine add_motion(inertia, ratio, omega, rate, kinetic)
      real(wp), intent(in) :: inertia, ratio, omega(lanes), rate(lanes)
      real(wp), intent(inout) :: kinetic(lanes)
      integer :: l

      !$omp simd
      do l = 1, lanes
         kinetic(l) = kinetic(l) + inertia*(ratio*omega(l) + rate(l))**2/2
      end do
   end subroutine add_motion

   !> The energies of a support.
   pure subroutine add_support(support, y, kinetic, potential)
      type(support_t), intent(in) :: support
      real(wp), intent(in) :: y(lanes, *)
      real(wp), intent(inout) :: kinetic(lanes), potential(lanes)
      integer :: j, l

      do j = 1, support%n
         associate (i => support%i_state(j))
            !$omp simd
            do l = 1, lanes
               kinetic(l) = kinetic(l) + support%mass*y(l, i + 1)**2/2
               potential(l) = potential(l) + support%stiffness(j)*y(l, i)**2/2
            end do
         end associate
      end do
   end subroutine add_support

   !> The energy of an elastic shaft.
   pure subroutine add_shaft(shaft, y, potential)
      type(shaft_t), intent(in) :: shaft
      real(wp), intent(in) :: y(lanes, *)
      real(wp), intent(inout) :: potential(lanes)
      real(wp), dimension(lanes) :: psi_a, psi_b, rate

      if (shaft%rigid) return
      call turn_wheel(shaft%i_psi_a, y, psi_a, rate)
      call turn_wheel(shaft%i_psi_b, y, psi_b, rate)
      potential = potential + shaft%stiffness*(psi_a - psi_b)**2/2
   end subroutine add_shaft

   !> The wheels, but for their loads.
   subroutine tell_wheels(gearbox, columns, y, f, integers, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: columns(:)
      real(wp), intent(in) :: y(lanes, gearbox%n_states), f(lanes, gearbox%n_states)
      integer, intent(in) :: integers(:)
      real(wp), intent(inout) :: values(lanes, *)
      real(wp), dimension(lanes) :: psi, rate, loss
      integer :: i, j

      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i), support => gearbox%wheels(i)%support)
            call turn_wheel(wheel%i_psi, y, psi, rate)
            call put(columns(of_angle_deviation), i, psi, values)
            call put_turned(columns(of_angle), i, wheel%ratio, y(:, i_theta), 2*pi*integers(i_turns), psi, values)
            call put_turned(columns(of_speed), i, wheel%ratio, y(:, i_omega), 0.0_wp, rate, values)
            if (columns(of_acceleration) /= none) then
               call turn_wheel(wheel%i_psi, f, psi, rate)
               call put_turned(columns(of_acceleration), i, wheel%ratio, f(:, i_omega), 0.0_wp, rate, values)
            end if
            call put_axle(columns(of_displacement), i, support, y, 0, values)
            call put_axle(columns(of_velocity), i, support, y, 1, values)
            call put_axle(columns(of_axle_acceleration), i, support, f, 1, values)
            if (columns(of_support_loss) == none) cycle
            loss = 0
            do j = 1, support%n
               loss = loss + damper_power(support%damping(j), y(:, support%i_state(j) + 1))
            end do
            call put(columns(of_support_loss), i, loss, values)
         end associate
      end do
   end subroutine tell_wheels

   !> What the gearbox turns at a ratio, and what a wheel turns more.
   pure subroutine put_turned(column, element, ratio, turned, whole, more, values)
      integer, intent(in) :: column, element
      real(wp), intent(in) :: ratio, turned(lanes), whole, more(lanes)
      real(wp), intent(inout) :: values(lanes, *)
      integer :: l

      if (column == none) return
      !$omp simd
      do l = 1, lanes
         values(l, column + element) = ratio*(turned(l) + whole) + more(l)
      end do
   end subroutine put_turned

   !> Both components of how an axle deviates, or of a rate of that.
   pure subroutine put_axle(column, wheel, support, y, order, values)
      integer, intent(in) :: column, wheel
      type(support_t), intent(in) :: support
      real(wp), intent(in) :: y(lanes, *) !! as of `axle_deviation`
      integer, intent(in) :: order
      real(wp), intent(inout) :: values(lanes, *)
      integer :: j, k, l, to

      if (column == none) return
      do k = 1, 2
         to = column + 2*(wheel - 1) + k
         values(:, to) = 0
         do j = 1, support%n
            !$omp simd
            do l = 1, lanes
               values(l, to) = values(l, to) + y(l, support%i_state(j) + order)*support%direction(k, j)
            end do
         end do
      end do
   end subroutine put_axle

   !> How far shafts are twisted, and what their damping takes; rigid ones are not.
   pure subroutine tell_twists(gearbox, columns, y, values)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: columns(:)
      real(wp), intent(in) :: y(lanes, gearbox%n_states)
      real(wp), intent(inout) :: values(lanes, *)
      real(wp), dimension(lanes) :: psi_a, psi_b, rate_a, rate_b
      integer :: i

      if (columns(of_shaft_twist) == none .and. columns(of_shaft_loss) == none) return
      do i = 1, size(gearbox%shafts)
         associate (shaft => gearbox%shafts(i))
            if (shaft%rigid) then
               call put_same(columns(of_shaft_twist), i, 0.0_wp, values)
               call put_same(columns(of_shaft_loss), i, 0.0_wp, values)
               cycle
            end if
            call turn_wheel(shaft%i_psi_a, y, psi_a, rate_a)
            call turn_wheel(shaft%i_psi_b, y, psi_b, rate_b)
            call put(columns(of_shaft_twist), i, psi_a - psi_b, values)
            call put(columns(of_shaft_loss), i, damper_power(shaft%damping, rate_a - rate_b), values)
         end associate
      end do
   end subroutine tell_twists

end module evl_motion_lanes
