!> A single flank for its tests: force laws for contacts at arbitrary positions, in one state and in eight.
module flank_calls
   use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_int, c_ptr
   use evl_compliant_flank, only: compliant_flank_t
   use evl_contact_point, only: contact_gradient
   use evl_coupled_compliant_flank, only: coupled_compliant_flank_t
   use evl_flank, only: flank_slot
   use evl_force_lanes, only: lane_slot
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: lanes, wp
   use evl_local_variables, only: n_local
   use evl_status, only: status_t
   use evl_tooth_contact, only: contact_state, flanks_open, no_mode
   use evl_wheel_compliance, only: wheel_compliance_t
   use made_up_wheel, only: made_up_t, n_numbers
   implicit none (type, external)
   private

   public :: test_flank_bend
   public :: test_flank_changes, test_flank_contacts, test_flank_laws, test_flank_in_lanes

contains

   !> Give all flanks of a gearbox a synthetic compliance, for each pair separately or coupled.
   subroutine test_flank_bend(handle, couples, scale, influence, k_difference) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: couples
      real(c_double), intent(in), value :: scale, k_difference
      real(c_double), intent(in) :: influence(n_numbers, 2)
      type(gearbox_t), pointer :: gearbox
      integer :: i

      call c_f_pointer(handle, gearbox)
      do i = 1, size(gearbox%flanks)
         call bend(couples /= 0, scale, influence, k_difference, gearbox%flanks(i))
      end do
   end subroutine test_flank_bend

   !> One of them. Built in place: gfortran 12 frees copies of nested polymorphic components twice.
   subroutine bend(couples, scale, influence, k_difference, slot)
      logical, intent(in) :: couples
      real(wp), intent(in) :: scale, influence(n_numbers, 2), k_difference
      type(flank_slot), intent(inout) :: slot
      integer :: first, last
      real(wp) :: reach

      reach = slot%flank%reach
      first = slot%flank%first
      last = slot%flank%last
      deallocate (slot%flank)
      if (couples) then
         allocate (coupled_compliant_flank_t :: slot%flank)
      else
         allocate (compliant_flank_t :: slot%flank)
      end if
      slot%flank%bends = .true.
      slot%flank%couples = couples
      slot%flank%reach = reach
      slot%flank%first = first
      slot%flank%last = last
      select type (flank => slot%flank)
      class is (compliant_flank_t)
         flank%k_difference = k_difference
         allocate (made_up_t :: flank%a, flank%b)
         call make_up(scale, influence(:, 1), flank%a)
         call make_up(scale, influence(:, 2), flank%b)
      end select
   end subroutine bend

   !> Parameters of a synthetic wheel.
   subroutine make_up(scale, p, wheel)
      real(wp), intent(in) :: scale, p(n_numbers)
      class(wheel_compliance_t), intent(inout) :: wheel

      select type (wheel)
      type is (made_up_t)
         wheel%scale = scale
         wheel%p = p
      end select
   end subroutine make_up

   !> Number of tooth contacts of the first flank of a gearbox.
   integer(c_int) function test_flank_contacts(handle) bind(c)
      type(c_ptr), intent(in), value :: handle
      type(gearbox_t), pointer :: gearbox

      call c_f_pointer(handle, gearbox)
      test_flank_contacts = gearbox%flanks(1)%flank%last
   end function test_flank_contacts

   !> Set the contacts of the first flank to given positions.
   subroutine put(n, flanks, positions, at)
      integer, intent(in) :: n
      integer(c_int), intent(in) :: flanks(n)
      real(wp), intent(in) :: positions(4, n) !! h, h', rho_A, rho_B
      type(contact_state), intent(inout) :: at(n)
      integer :: k

      do k = 1, n
         at(k)%mode = no_mode
         at(k)%mode%flanks = flanks(k)
         at(k)%mode%tooth_pair = k
         at(k)%mode%v0 = 0.1_wp
         at(k)%point%h = positions(1, k)
         at(k)%point%h_dot = positions(2, k)
         at(k)%point%rho_a = positions(3, k)
         at(k)%point%rho_b = positions(4, k)
         at(k)%point%l_a = positions(3, k) - positions(1, k) ! as for a rigid wheel B
         at(k)%point%l_b = positions(4, k)
      end do
   end subroutine put

   !> Elastic and viscous forces on one of the flanks; the code of the status.
   integer(c_int) function test_flank_laws(handle, which, n, flanks, positions, elastic, viscous) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: which, n
      integer(c_int), intent(in) :: flanks(n)
      real(c_double), intent(in) :: positions(4, n)
      real(c_double), intent(inout) :: elastic(n), viscous(n) !! of pairs in contact
      type(gearbox_t), pointer :: gearbox
      type(contact_state) :: at(n)
      type(status_t) :: status
      integer :: k

      call c_f_pointer(handle, gearbox)
      call put(n, flanks, positions, at)
      associate (flank => gearbox%flanks(which)%flank)
         call flank%laws(gearbox%contacts(flank%first:), 1, n, at, status)
      end associate
      do k = 1, n
         if (flanks(k) == flanks_open) cycle
         elastic(k) = at(k)%elastic%force
         viscous(k) = at(k)%viscous%force
      end do
      code = status%code
   end function test_flank_laws

   !> Derivatives of both forces of contact `which` to h, h', rho_A and rho_B of the first contact, of the second, and so on, which
   !> take the place of the local variables.
   subroutine test_flank_changes(handle, n, flanks, positions, which, elastic, viscous) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: n, which
      integer(c_int), intent(in) :: flanks(n)
      real(c_double), intent(in) :: positions(4, n)
      real(c_double), intent(inout) :: elastic(4*n), viscous(4*n)
      type(gearbox_t), pointer :: gearbox
      type(contact_state) :: at(n)
      type(contact_gradient) :: d(n)
      type(status_t) :: status
      real(wp) :: of_elastic(n_local), of_viscous(n_local)
      integer :: k

      call c_f_pointer(handle, gearbox)
      call put(n, flanks, positions, at)
      associate (flank => gearbox%flanks(1)%flank)
         call flank%laws(gearbox%contacts, 1, n, at, status)
         do k = 1, n
            d(k)%h = 0
            d(k)%h_dot = 0
            d(k)%rho_a = 0
            d(k)%rho_b = 0
            d(k)%h(4*k - 3) = 1
            d(k)%h_dot(4*k - 2) = 1
            d(k)%rho_a(4*k - 1) = 1
            d(k)%rho_b(4*k) = 1
            d(k)%l_a = d(k)%rho_a - d(k)%h
            d(k)%l_b = d(k)%rho_b
         end do
         call flank%force_changes(gearbox%contacts, at, d, which, of_elastic, of_viscous)
      end associate
      elastic = of_elastic(:4*n)
      viscous = of_viscous(:4*n)
   end subroutine test_flank_changes

   !> Elastic and viscous forces in eight states; 1 if they are valid.
   integer(c_int) function test_flank_in_lanes(handle, n, flanks, positions, elastic, viscous) result(solution) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: n
      integer(c_int), intent(in) :: flanks(n)
      real(c_double), intent(in) :: positions(4, n, lanes)
      real(c_double), intent(inout) :: elastic(n, lanes), viscous(n, lanes)
      type(gearbox_t), pointer :: gearbox
      type(lane_slot), allocatable :: slots(:)
      type(contact_state) :: at(n)
      logical :: is_defined
      integer :: k

      call c_f_pointer(handle, gearbox)
      call put(n, flanks, positions, at)
      allocate (slots(n))
      do k = 1, n
         slots(k)%mode = at(k)%mode
         slots(k)%touches = flanks(k) /= flanks_open
         slots(k)%at%h = positions(1, k, :)
         slots(k)%at%h_dot = positions(2, k, :)
         slots(k)%at%rho_a = positions(3, k, :)
         slots(k)%at%rho_b = positions(4, k, :)
         slots(k)%at%l_a = positions(3, k, :) - positions(1, k, :)
         slots(k)%at%l_b = positions(4, k, :)
         slots(k)%at%e_star = gearbox%contacts(k)%e_star
         slots(k)%at%width = gearbox%contacts(k)%width
         slots(k)%at%v0 = at(k)%mode%v0
         slots(k)%at%side = 0
      end do
      call gearbox%flanks(1)%flank%laws_in_lanes(gearbox%contacts, 1, n, slots, is_defined)
      solution = merge(1, 0, is_defined)
      do k = 1, n
         if (.not. slots(k)%touches) cycle
         elastic(k, :) = slots(k)%force%elastic
         viscous(k, :) = slots(k)%force%viscous
      end do
   end function test_flank_in_lanes

end module flank_calls
