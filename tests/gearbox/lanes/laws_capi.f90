!> Laws in lanes, for their tests: by their own loops, state by state as for a law without a loop, and gearboxes of such laws.
module laws_capi
   use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_int, c_ptr
   use evl_contact_context, only: contact_context, lane_context
   use evl_damping_law, only: damping_law_t
   use evl_elastic_law, only: elastic_law_t, elastic_one_by_one => lane_by_lane, elastic_result
   use evl_friction_law, only: by_sliding, friction_law_t, n_sliding, sliding_t
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: lanes, wp
   use evl_row, only: kind_t
   use law_calls, only: given_contact, given_damping, given_elastic, given_friction, given_law
   implicit none (type, external)
   private

   public :: lanes_damping, lanes_elastic, lanes_friction, lanes_strip_laws

   !> A law of the table, evaluated state by state.
   type, extends(elastic_law_t) :: bare_elastic_t
      class(elastic_law_t), allocatable :: law
   contains
      procedure :: describe => describe_elastic
      procedure :: force => elastic_force
      procedure :: potential
      procedure :: penetration
      procedure :: limit_message
   end type bare_elastic_t

   type, extends(damping_law_t) :: bare_damping_t
      class(damping_law_t), allocatable :: law
   contains
      procedure :: describe => describe_damping
      procedure :: evaluate => each_damping
   end type bare_damping_t

   type, extends(friction_law_t) :: bare_friction_t
      class(friction_law_t), allocatable :: law
   contains
      procedure :: describe => describe_friction
      procedure :: evaluate => each_factor
      procedure :: evaluate_local => each_local
      procedure :: is_local
      procedure :: acts
      procedure :: falls
      procedure :: knee
   end type bare_friction_t

contains

   !> An elastic law in eight states that differ in h and the radii only; 1 if the forces are valid, else 0.
   integer(c_int) function lanes_elastic(choice, contexts, bare, force, d_energy, excess) result(answer) bind(c)
      type(given_law), intent(in) :: choice
      type(given_contact), intent(in) :: contexts(lanes)
      integer(c_int), intent(in), value :: bare !! 1: as a law without a loop
      real(c_double), intent(inout) :: force(lanes), d_energy(lanes), excess(lanes)
      class(elastic_law_t), allocatable :: law
      logical :: is_defined

      call given_elastic(choice, law)
      if (bare == 1) then
         call elastic_one_by_one(law, context_of_lanes(contexts), force, d_energy, excess, is_defined)
      else
         call law%force_lanes(context_of_lanes(contexts), force, d_energy, excess, is_defined)
      end if
      answer = merge(1, 0, is_defined)
   end function lanes_elastic

   !> A damping law in eight states; `side` as in the discrete state.
   subroutine lanes_damping(choice, contexts, side, bare, elastic, force) bind(c)
      type(given_law), intent(in) :: choice
      type(given_contact), intent(in) :: contexts(lanes)
      integer(c_int), intent(in), value :: side, bare
      real(c_double), intent(in) :: elastic(lanes)
      real(c_double), intent(inout) :: force(lanes)
      class(damping_law_t), allocatable :: law
      type(bare_damping_t) :: stripped
      type(lane_context) :: at

      call given_damping(choice, law)
      at = context_of_lanes(contexts)
      at%side = side
      if (bare == 1) then
         call move_alloc(law, stripped%law)
         call stripped%force_lanes(at, elastic, force)
      else
         call law%force_lanes(at, elastic, force)
      end if
   end subroutine lanes_damping

   !> A friction law in eight states on one branch.
   subroutine lanes_friction(choice, branch, v_t, bare, factor) bind(c)
      type(given_law), intent(in) :: choice
      integer(c_int), intent(in), value :: branch, bare
      real(c_double), intent(in) :: v_t(lanes)
      real(c_double), intent(inout) :: factor(lanes)
      class(friction_law_t), allocatable :: law
      type(bare_friction_t) :: stripped
      type(sliding_t) :: at

      call given_friction(choice, law)
      at%x(:, by_sliding) = v_t
      if (bare == 1) then
         call move_alloc(law, stripped%law)
         call stripped%factor_lanes(branch, at, factor)
      else
         call law%factor_lanes(branch, at, factor)
      end if
   end subroutine lanes_friction

   !> Replace all laws of a gearbox by equivalent laws without a loop.
   subroutine lanes_strip_laws(handle) bind(c)
      type(c_ptr), intent(in), value :: handle
      type(gearbox_t), pointer :: gearbox
      class(elastic_law_t), allocatable :: elastic
      class(damping_law_t), allocatable :: damping
      class(friction_law_t), allocatable :: friction
      integer :: i

      call c_f_pointer(handle, gearbox)
      do i = 1, size(gearbox%contacts)
         associate (contact => gearbox%contacts(i))
            call move_alloc(contact%elastic, elastic)
            call move_alloc(contact%damping, damping)
            call move_alloc(contact%friction, friction)
            allocate (bare_elastic_t :: contact%elastic)
            allocate (bare_damping_t :: contact%damping)
            allocate (bare_friction_t :: contact%friction)
            select type (bare => contact%elastic)
            type is (bare_elastic_t)
               call move_alloc(elastic, bare%law)
            end select
            select type (bare => contact%damping)
            type is (bare_damping_t)
               call move_alloc(damping, bare%law)
            end select
            select type (bare => contact%friction)
            type is (bare_friction_t)
               call move_alloc(friction, bare%law)
            end select
         end associate
      end do
   end subroutine lanes_strip_laws

   !> Contact quantities available to laws in eight states.
   type(lane_context) function context_of_lanes(contexts) result(at)
      type(given_contact), intent(in) :: contexts(lanes)

      at%h = contexts%h
      at%h_dot = contexts%h_dot
      at%rho_a = contexts%rho_a
      at%rho_b = contexts%rho_b
      at%e_star = contexts(1)%e_star
      at%width = contexts(1)%width
      at%v0 = contexts(1)%v0
      at%side = 0
   end function context_of_lanes

   pure subroutine describe_elastic(self, info)
      class(bare_elastic_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "bare"
   end subroutine describe_elastic

   pure subroutine describe_damping(self, info)
      class(bare_damping_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "bare"
   end subroutine describe_damping

   pure subroutine describe_friction(self, info)
      class(bare_friction_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "bare"
   end subroutine describe_friction

   pure subroutine elastic_force(self, ctx, result, code)
      class(bare_elastic_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      type(elastic_result), intent(out) :: result
      integer, intent(out) :: code

      call self%law%force(ctx, result, code)
   end subroutine elastic_force

   pure function potential(self, ctx, force) result(energy)
      class(bare_elastic_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      real(wp), intent(in) :: force
      real(wp) :: energy

      energy = self%law%potential(ctx, force)
   end function potential

   pure subroutine penetration(self, ctx, force, h, code)
      class(bare_elastic_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      real(wp), intent(in) :: force
      real(wp), intent(out) :: h
      integer, intent(out) :: code

      call self%law%penetration(ctx, force, h, code)
   end subroutine penetration

   pure subroutine limit_message(self, ctx, message)
      class(bare_elastic_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      character(len=*), intent(out) :: message

      call self%law%limit_message(ctx, message)
   end subroutine limit_message

   pure subroutine each_damping(self, n, h, h_dot, elastic, v0, side, force, d_h, d_h_dot, d_elastic)
      class(bare_damping_t), intent(in) :: self
      integer, intent(in) :: n, side
      real(wp), intent(in) :: h(n), h_dot(n), elastic(n), v0
      real(wp), intent(out) :: force(n)
      real(wp), dimension(n), intent(inout), optional :: d_h, d_h_dot, d_elastic
      integer :: i

      do i = 1, n
         if (present(d_h)) then
            call self%law%evaluate(1, h(i), h_dot(i), elastic(i), v0, side, force(i), d_h(i), d_h_dot(i), d_elastic(i))
         else
            call self%law%evaluate(1, h(i), h_dot(i), elastic(i), v0, side, force(i))
         end if
      end do
   end subroutine each_damping

   pure subroutine each_local(self, n, branch, at, phi, d_phi)
      class(bare_friction_t), intent(in) :: self
      integer, intent(in) :: n, branch
      type(sliding_t), intent(in) :: at
      real(wp), intent(out) :: phi(n)
      real(wp), intent(inout), optional :: d_phi(n, n_sliding)
      type(sliding_t) :: one
      real(wp) :: slopes(n_sliding)
      integer :: i

      if (self%law%is_local()) one%e_star = at%e_star
      do i = 1, n
         one%x(1, by_sliding) = at%x(i, by_sliding)
         if (self%law%is_local()) one%x(1, :) = at%x(i, :)
         call self%law%factor(branch, one, phi(i), slopes)
         if (present(d_phi)) d_phi(i, :) = slopes
      end do
   end subroutine each_local

   pure subroutine each_factor(self, n, branch, v_t, phi, d_v)
      class(bare_friction_t), intent(in) :: self
      integer, intent(in) :: n, branch
      real(wp), intent(in) :: v_t(n)
      real(wp), intent(out) :: phi(n)
      real(wp), intent(inout), optional :: d_v(n)

      call self%law%evaluate(n, branch, v_t, phi, d_v)
   end subroutine each_factor

   pure logical function is_local(self)
      class(bare_friction_t), intent(in) :: self

      is_local = self%law%is_local()
   end function is_local

   pure logical function acts(self)
      class(bare_friction_t), intent(in) :: self

      acts = self%law%acts()
   end function acts

   pure logical function falls(self)
      class(bare_friction_t), intent(in) :: self

      falls = self%law%falls()
   end function falls

   pure real(wp) function knee(self)
      class(bare_friction_t), intent(in) :: self

      knee = self%law%knee()
   end function knee

end module laws_capi
