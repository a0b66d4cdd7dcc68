!> Fills what the loops over lanes keep of each tooth contact.
module evl_contacts_in_lanes
   use evl_contact_roots, only: contact_root_directions
   use evl_discrete_state, only: gearbox_mode
   use evl_force_lanes, only: lane_slot
   use evl_gearbox, only: gearbox_t, i_turns
   use evl_kinds, only: wp
   use evl_tooth_contact, only: contact_state, nominal_start, touches, unclipped
   implicit none (type, external)
   private

   public :: put_down, settle_slots

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
         slots(i)%touches = touches(slots(i)%mode)
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
         if (.not. slots(i)%touches) cycle
         associate (at => slots(i)%at, point => contacts(i)%point)
            at%h(lane) = point%h
            at%overlap(lane) = contacts(i)%overlap
            at%v_t(lane) = point%v_t
            at%rho_a(lane) = point%rho_a
            at%rho_b(lane) = point%rho_b
            slots(i)%force%unclipped(lane) = unclipped(contacts(i))
            slots(i)%force%factor(lane) = contacts(i)%factor
         end associate
      end do
   end subroutine put_down

end module evl_contacts_in_lanes
