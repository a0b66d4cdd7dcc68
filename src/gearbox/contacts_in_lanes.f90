!> What the loops over lanes keep of each tooth contact: what its discrete state fixes, and what the last rates knew of it.
module evl_contacts_in_lanes
   use evl_contact_lanes, only: lane_contact
   use evl_contact_roots, only: contact_root_directions
   use evl_discrete_state, only: gearbox_mode
   use evl_gearbox, only: gearbox_t, i_turns
   use evl_kinds, only: lanes, wp
   use evl_root_kinds, only: n_root_kinds
   use evl_tooth_contact, only: contact_mode, contact_state, nominal_start, touches
   implicit none (type, external)
   private

   public :: lane_slot, put_down, settle_slots

   type :: lane_slot
      type(contact_mode) :: mode
      integer :: directions(n_root_kinds) = 0 !! of its root functions
      real(wp) :: rho_start = 0               !! nominal radius of curvature on A at theta = 0 [m]
      type(lane_contact) :: at                !! the contact in eight states, if it touches
      real(wp), dimension(lanes) :: unclipped !! elastic + viscous force there [N]
      real(wp), dimension(lanes) :: friction  !! the friction law's factor of the normal force, where there is one
      real(wp) :: rho_seen = 0                !! rho_A where the curvature of deviating flanks was found last; 0: nowhere yet [m]
      real(wp) :: curvature_seen = 0          !! the curvature there [1/m]
   end type lane_slot

contains

   !> Take a discrete state.
   subroutine settle_slots(gearbox, integers, reals, slots)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: integers(:)
      real(wp), intent(in) :: reals(:)
      type(lane_slot), intent(inout) :: slots(:) !! [tooth contacts]
      integer :: i

      do i = 1, size(gearbox%contacts)
         slots(i)%mode = gearbox_mode(gearbox, i, integers, reals)
         call contact_root_directions(gearbox%contacts(i), slots(i)%mode, slots(i)%directions)
         slots(i)%rho_seen = 0
         slots(i)%rho_start = nominal_start(gearbox%contacts(i), integers(i_turns), slots(i)%mode%tooth_pair)
      end do
   end subroutine settle_slots

   !> Put down the contacts of one state, where the states were evaluated one by one.
   pure subroutine put_down(contacts, lane, slots)
      type(contact_state), intent(in) :: contacts(:) !! as from `gearbox_rates`
      integer, intent(in) :: lane
      type(lane_slot), intent(inout) :: slots(:)
      integer :: i

      do i = 1, size(slots)
         if (.not. touches(slots(i)%mode)) cycle
         associate (at => slots(i)%at, point => contacts(i)%point, force => contacts(i)%force)
            at%h(lane) = point%h
            at%v_t(lane) = point%v_t
            at%rho_a(lane) = point%rho_a
            at%rho_b(lane) = point%rho_b
            slots(i)%unclipped(lane) = force%elastic + force%viscous
            slots(i)%friction(lane) = 0
            if (abs(force%normal) > 0) slots(i)%friction(lane) = -force%friction/force%normal
         end associate
      end do
   end subroutine put_down

end module evl_contacts_in_lanes
