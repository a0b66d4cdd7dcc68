!> Quantities of a contact that a force law may use, in one state and in eight.
module evl_contact_context
   use evl_kinds, only: lanes, wp
   implicit none (type, external)
   private

   public :: context_of_lane, contact_context, lane_context

   type :: contact_context
      real(wp) :: h = 0.0_wp       !! penetration [m], negative for a gap
      real(wp) :: h_dot = 0.0_wp   !! its rate [m/s]
      real(wp) :: rho_a = 0.0_wp   !! radius of curvature of the driving flank [m]
      real(wp) :: rho_b = 0.0_wp   !! radius of curvature of the driven flank [m]
      real(wp) :: e_star = 0.0_wp  !! effective modulus E* [Pa]
      real(wp) :: width = 0.0_wp   !! common face width [m]
      real(wp) :: v0 = 0.0_wp      !! approach speed at the last closing [m/s]
      integer :: side = 0          !! of h' = 0, for laws with two: +1 approach, -1 separation; 0: by the sign of h'
   end type contact_context

   !> `contact_context` of eight states with a common discrete state.
   type :: lane_context
      real(wp), dimension(lanes) :: h, h_dot, rho_a, rho_b
      real(wp) :: e_star, width, v0
      integer :: side
   end type lane_context

contains

   !> Context of one of the eight states.
   pure type(contact_context) function context_of_lane(at, l) result(ctx)
      type(lane_context), intent(in) :: at
      integer, intent(in) :: l

      ctx = contact_context(h=at%h(l), h_dot=at%h_dot(l), rho_a=at%rho_a(l), rho_b=at%rho_b(l), &
                            e_star=at%e_star, width=at%width, v0=at%v0, side=at%side)
   end function context_of_lane

end module evl_contact_context
