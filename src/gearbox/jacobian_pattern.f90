!> Which entries df/dy of a gearbox in closed form may have.
module evl_jacobian_pattern
   use evl_gearbox, only: gearbox_t, wheel_t
   use evl_local_variables, only: i_omega, i_theta
   use evl_tooth_contact, only: tooth_contact_t
   implicit none (type, external)
   private

   public :: find_pattern

contains

   !> Entries that df/dy may have in any discrete state.
   pure subroutine find_pattern(gearbox, rows, columns)
      type(gearbox_t), intent(in) :: gearbox
      integer, allocatable, intent(out) :: rows(:), columns(:)
      logical :: taken(gearbox%n_states, gearbox%n_states)
      integer :: i, j, n

      taken = .false.
      do i = 1, size(gearbox%wheels)
         call mark_wheel(gearbox, gearbox%wheels(i), taken)
      end do
      do i = 1, size(gearbox%loads)
         if (gearbox%loads(i)%load%by_angle) call mark_angle(gearbox, gearbox%wheels(gearbox%loads(i)%load%wheel), taken)
      end do
      do i = 1, size(gearbox%contacts)
         call mark_contact(gearbox, gearbox%contacts(i), taken)
      end do
      do i = 1, size(gearbox%shafts)
         call mark_shaft(gearbox, i, taken)
      end do
      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i)) ! psi'' = phi'' - g theta''
            if (wheel%i_psi > 0) taken(wheel%i_speed, :) = taken(wheel%i_speed, :) .or. taken(i_omega, :)
         end associate
      end do
      n = count(taken)
      allocate (rows(n), columns(n))
      n = 0
      do j = 1, gearbox%n_states
         do i = 1, gearbox%n_states
            if (.not. taken(i, j)) cycle
            n = n + 1
            rows(n) = i
            columns(n) = j
         end do
      end do
   end subroutine find_pattern

   !> A wheel with its loads and its support, in a housing that is at rest or moves as prescribed.
   pure subroutine mark_wheel(gearbox, wheel, taken)
      type(gearbox_t), intent(in) :: gearbox
      type(wheel_t), intent(in) :: wheel
      logical, intent(inout) :: taken(:, :)
      integer :: j, k

      taken(i_theta, i_omega) = .true.
      if (wheel%i_psi > 0) taken(wheel%i_psi, wheel%i_psi + 1) = .true.
      call mark_speed(wheel, wheel%i_speed, taken)
      call mark_speed(wheel, gearbox%i_work, taken)
      do j = 1, wheel%support%n
         associate (s => wheel%support%i_state(j))
            taken(s, s + 1) = .true.
            taken(s + 1, s:s + 1) = .true.
            taken(gearbox%i_dissipated, s + 1) = .true.
            if (.not. gearbox%housing%acts) cycle
            taken(gearbox%i_work, s:s + 1) = .true.
            do k = 1, wheel%support%n
               associate (other => wheel%support%i_state(k))
                  taken(s + 1, other:other + 1) = .true.
               end associate
            end do
         end associate
      end do
   end subroutine mark_wheel

   !> The force of a tooth contact: on its wheels, their supports, and in the energies.
   pure subroutine mark_contact(gearbox, contact, taken)
      type(gearbox_t), intent(in) :: gearbox
      type(tooth_contact_t), intent(in) :: contact
      logical, intent(inout) :: taken(:, :)
      logical :: row(gearbox%n_states)
      integer :: i, j, side

      row = .false.
      row(gearbox%i_dissipated) = .true.
      do side = 1, 2
         associate (wheel => gearbox%wheels(merge(contact%wheel_a, contact%wheel_b, side == 1)))
            row(merge(wheel%i_speed, gearbox%i_work, wheel%prescribed == 0)) = .true.
            do j = 1, wheel%support%n
               row(wheel%support%i_state(j) + 1) = .true.
            end do
         end associate
      end do
      do i = 1, size(contact%links)
         taken(:, contact%links(i)%state) = taken(:, contact%links(i)%state) .or. row
      end do
   end subroutine mark_contact

   !> The torque of an elastic shaft on its two wheels, and in the energies.
   pure subroutine mark_shaft(gearbox, index, taken)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: index
      logical, intent(inout) :: taken(:, :)
      logical :: row(gearbox%n_states)
      integer :: columns(4), i

      associate (shaft => gearbox%shafts(index))
         if (shaft%rigid) return
         associate (a => gearbox%wheels(shaft%wheel_a), b => gearbox%wheels(shaft%wheel_b))
            row = .false.
            row(gearbox%i_dissipated) = .true.
            row(merge(a%i_speed, gearbox%i_work, a%prescribed == 0)) = .true.
            row(merge(b%i_speed, gearbox%i_work, b%prescribed == 0)) = .true.
         end associate
         columns = [shaft%i_psi_a, shaft%i_psi_a + 1, shaft%i_psi_b, shaft%i_psi_b + 1]
         if (shaft%i_psi_a == 0) columns(1:2) = 0
         if (shaft%i_psi_b == 0) columns(3:4) = 0
      end associate
      do i = 1, size(columns)
         if (columns(i) > 0) taken(:, columns(i)) = taken(:, columns(i)) .or. row
      end do
   end subroutine mark_shaft

   !> A load that depends on a wheel's angle: its torque and its power.
   pure subroutine mark_angle(gearbox, wheel, taken)
      type(gearbox_t), intent(in) :: gearbox
      type(wheel_t), intent(in) :: wheel
      logical, intent(inout) :: taken(:, :)

      associate (rows => [wheel%i_speed, gearbox%i_work])
         taken(rows, i_theta) = .true.
         if (wheel%i_psi > 0) taken(rows, wheel%i_psi) = .true.
      end associate
   end subroutine mark_angle

   !> A row that depends on a wheel's speed.
   pure subroutine mark_speed(wheel, row, taken)
      type(wheel_t), intent(in) :: wheel
      integer, intent(in) :: row
      logical, intent(inout) :: taken(:, :)

      taken(row, i_omega) = .true.
      if (wheel%i_psi > 0) taken(row, wheel%i_psi + 1) = .true.
   end subroutine mark_speed

end module evl_jacobian_pattern
