!> Elastic laws of a contact: normal force from penetration. A law extends `elastic_law_t` in a file of its own.
module evl_elastic_law
   use evl_contact_context, only: contact_context, context_of_lane, lane_context
   use evl_force_law, only: force_law_t, no
   use evl_kinds, only: lanes, wp
   use evl_row, only: kind_t
   use evl_status, only: code_ok, quantity
   implicit none (type, external)
   private

   public :: elastic_law_t, elastic_result, lane_by_lane, no_elastic

   !> Elastic force with its derivatives, and those of the elastic energy V of `potential`; r = rho_a + rho_b - h. No law so
   !> far distinguishes the two radii in the energy.
   type :: elastic_result
      real(wp) :: force !! [N], over the whole width
      real(wp) :: d_h   !! dF/dh at constant radii of curvature [N/m]
      real(wp) :: d_rho_a, d_rho_b !! dF/drho_a, dF/drho_b at constant h [N/m]
      real(wp) :: d_energy !! dV/dr at constant h [J/m]
      real(wp) :: excess   !! dV/dh - F at constant r: error of V, which is a series [N]
   end type elastic_result
   type(elastic_result), parameter :: no_elastic = elastic_result(0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp)

   type, abstract, extends(force_law_t) :: elastic_law_t
   contains
      procedure(force), deferred :: force
      procedure(potential), deferred :: potential
      procedure(penetration), deferred :: penetration
      procedure :: limit_message
      procedure :: force_lanes => lane_by_lane
      procedure :: potential_lanes => potential_by_lane
      procedure, nopass :: is_rigid => no
      procedure :: restitution => nothing
      procedure :: rest_velocity => nothing
      procedure :: compliant => itself
   end type elastic_law_t

   abstract interface

      !> Elastic normal force, odd in h. The contact mode determines which sign of h is contact.
      pure subroutine force(self, ctx, result, code)
         import :: contact_context, elastic_law_t, elastic_result
         implicit none (type, external)
         class(elastic_law_t), intent(in) :: self
         type(contact_context), intent(in) :: ctx
         type(elastic_result), intent(out) :: result !! zero on error
         integer, intent(out) :: code                !! code_ok or code_out_of_domain
      end subroutine force

      !> Elastic energy of the contact [J]: dV = F dh where rho_a + rho_b - h is constant, as in a mesh on fixed axles. Even in h.
      pure function potential(self, ctx, force) result(energy)
         import :: contact_context, elastic_law_t, wp
         implicit none (type, external)
         class(elastic_law_t), intent(in) :: self
         type(contact_context), intent(in) :: ctx
         real(wp), intent(in) :: force !! elastic force there [N]
         real(wp) :: energy
      end function potential

      !> Penetration at which the elastic force is `force`; ctx%h is not used.
      pure subroutine penetration(self, ctx, force, h, code)
         import :: contact_context, elastic_law_t, wp
         implicit none (type, external)
         class(elastic_law_t), intent(in) :: self
         type(contact_context), intent(in) :: ctx
         real(wp), intent(in) :: force !! [N], over the whole width
         real(wp), intent(out) :: h    !! [m]; 0 on error
         integer, intent(out) :: code  !! code_ok or code_out_of_domain
      end subroutine penetration

   end interface

contains

   !> Force in eight states, and the terms of the energy. A law without a loop of its own is evaluated state by state.
   pure subroutine lane_by_lane(self, at, force, d_energy, excess, is_defined)
      class(elastic_law_t), intent(in) :: self
      type(lane_context), intent(in) :: at
      real(wp), dimension(lanes), intent(out) :: force, d_energy, excess !! as in `elastic_result`
      logical, intent(out) :: is_defined !! false if the law is undefined in one of the states
      type(elastic_result) :: elastic
      integer :: l, code

      is_defined = .true.
      do l = 1, lanes
         call self%force(context_of_lane(at, l), elastic, code)
         force(l) = elastic%force
         d_energy(l) = elastic%d_energy
         excess(l) = elastic%excess
         is_defined = is_defined .and. code == code_ok
      end do
   end subroutine lane_by_lane

   !> Energy in eight states, evaluated one by one.
   pure subroutine potential_by_lane(self, at, force, energy)
      class(elastic_law_t), intent(in) :: self
      type(lane_context), intent(in) :: at
      real(wp), intent(in) :: force(lanes)   !! elastic force there [N]
      real(wp), intent(out) :: energy(lanes) !! [J]
      integer :: l

      do l = 1, lanes
         energy(l) = self%potential(context_of_lane(at, l), force(l))
      end do
   end subroutine potential_by_lane

   !> Reason why `force` returns code_out_of_domain, as one sentence; "" if it does not. A law with an explicit limit overrides it.
   pure subroutine limit_message(self, ctx, message)
      class(elastic_law_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      character(len=*), intent(out) :: message !! truncated to its length
      type(elastic_result) :: elastic
      type(kind_t) :: info
      integer :: code

      message = ""
      call self%force(ctx, elastic, code)
      if (code == code_ok) return
      call self%describe(info)
      message = "the law "//trim(info%name)//" has no force at the penetration h = "//quantity(ctx%h, "m")
   end subroutine limit_message

   !> Newton's coefficient of restitution, or approach speed below which an impact does not rebound [m/s]: 0, except of rigid
   !> contact.
   pure real(wp) function nothing(self)
      class(elastic_law_t), intent(in) :: self

      nothing = 0
   end function nothing

   !> Law that gives the magnitude of penetrations: a law with penetrations is its own.
   subroutine itself(self, law)
      class(elastic_law_t), intent(in) :: self
      class(elastic_law_t), allocatable, intent(out) :: law

      allocate (law, source=self)
   end subroutine itself

end module evl_elastic_law
