!> The force laws one by one for the tests: C calls that the kernel does not export.
module law_calls
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int
   use evl_capi_types, only: c_message_length, c_status, status_to_c, to_c
   use evl_contact_context, only: contact_context
   use evl_damping_law, only: damping_law_t, no_viscous, viscous_force, viscous_result
   use evl_elastic_law, only: elastic_law_t, elastic_result
   use evl_force_law, only: force_law_t, max_law_parameters
   use evl_friction_law, only: by_sliding, friction_law_t, n_sliding, sliding_t
   use evl_kind_finder, only: kind_finder
   use evl_kinds, only: lanes
   use evl_law_table, only: damping_law, elastic_law, friction_law
   use evl_lubricated_friction, only: lubricated_friction_t
   use evl_operating_friction, only: operating_friction_t, operating_point
   use evl_row, only: is_left_open, kind_t, range_error
   use evl_status, only: code_invalid_input, code_ok, message_length, status_t
   implicit none (type, external)
   private

   public :: given_contact, given_damping, given_elastic, given_friction, given_law
   public :: test_law_elastic_force, test_law_elastic_limit, test_law_elastic_potential, test_law_friction_factor
   public :: given_operating_point, test_law_local_factor, test_law_operating_coefficient
   public :: test_law_friction_knee, test_law_friction_mode, test_law_penetration, test_law_validate, test_law_viscous_force

   !> A law of a family with its parameters in the order of the table.
   type, bind(c) :: given_law
      integer(c_int) :: law
      real(c_double) :: parameters(max_law_parameters)
   end type given_law

   !> What a law of an operating point knows: the fields of `operating_point` and `mesh_lubricant`.
   type, bind(c) :: given_operating_point
      real(c_double) :: line_load, rolling_speed, radius, diameter, viscosity, roughness
   end type given_operating_point

   !> What a law may know about a contact: the fields of `contact_context` that tests give.
   type, bind(c) :: given_contact
      real(c_double) :: h, h_dot, rho_a, rho_b, e_star, width, v0
   end type given_contact

contains

   !> Check a law's index, the ranges of its parameters by its rows, and how they stand to each other.
   subroutine test_law_validate(family, choice, status) bind(c)
      integer(c_int), intent(in), value :: family
      type(given_law), intent(in) :: choice
      type(c_status), intent(out) :: status
      type(status_t) :: s
      class(elastic_law_t), allocatable :: elastic
      class(damping_law_t), allocatable :: damping
      class(friction_law_t), allocatable :: friction

      write (s%message, "(a, i0, a)") "there is no law ", choice%law, " in this family"
      s%code = code_invalid_input
      s%field = "law"
      select case (family)
      case (0)
         call given_elastic(choice, elastic)
         if (allocated(elastic)) call check(elastic, s)
      case (1)
         call given_damping(choice, damping)
         if (allocated(damping)) call check(damping, s)
      case (2)
         call given_friction(choice, friction)
         if (allocated(friction)) call check(friction, s)
      end select
      call status_to_c(s, status)
   end subroutine test_law_validate

   subroutine check(law, status)
      class(force_law_t), intent(in) :: law
      type(status_t), intent(inout) :: status
      type(kind_t) :: info
      integer :: i

      call law%describe(info)
      status%message = ""
      if (.not. allocated(info%rows)) allocate (info%rows(0))
      do i = 1, size(info%rows)
         status%field = info%rows(i)%key
         if (is_left_open(info%rows(i), law%parameters(i))) cycle
         status%message = range_error(info%rows(i), law%parameters(i))
         if (status%message /= "") exit
      end do
      if (status%message == "") call law%check(status%field, status%message)
      status%code = merge(code_ok, code_invalid_input, status%message == "")
      if (status%message /= "") status%message = trim(status%message)//" (law "//trim(info%name)//")"
   end subroutine check

   !> Elastic normal force with its derivatives to h, rho_a and rho_b.
   subroutine test_law_elastic_force(n, choice, contexts, force, d_h, d_rho_a, d_rho_b, codes) bind(c)
      integer(c_int), intent(in), value :: n
      type(given_law), intent(in) :: choice
      type(given_contact), intent(in) :: contexts(n)
      real(c_double), intent(out) :: force(n), d_h(n), d_rho_a(n), d_rho_b(n)
      integer(c_int), intent(out) :: codes(n)
      class(elastic_law_t), allocatable :: law
      type(elastic_result) :: elastic
      integer :: i

      call given_elastic(choice, law)
      do i = 1, n
         call law%force(context_of(contexts(i)), elastic, codes(i))
         force(i) = elastic%force
         d_h(i) = elastic%d_h
         d_rho_a(i) = elastic%d_rho_a
         d_rho_b(i) = elastic%d_rho_b
      end do
   end subroutine test_law_elastic_force

   !> Why that is out of its domain, as one sentence.
   subroutine test_law_elastic_limit(choice, context, message) bind(c)
      type(given_law), intent(in) :: choice
      type(given_contact), intent(in) :: context
      character(kind=c_char), intent(out) :: message(c_message_length)
      class(elastic_law_t), allocatable :: law
      character(len=message_length) :: text

      call given_elastic(choice, law)
      call law%limit_message(context_of(context), text)
      call to_c(text, message)
   end subroutine test_law_elastic_limit

   !> Penetration at which the elastic force is `force`.
   subroutine test_law_penetration(n, choice, contexts, force, h, codes) bind(c)
      integer(c_int), intent(in), value :: n
      type(given_law), intent(in) :: choice
      type(given_contact), intent(in) :: contexts(n)
      real(c_double), intent(in) :: force(n)
      real(c_double), intent(out) :: h(n)
      integer(c_int), intent(out) :: codes(n)
      class(elastic_law_t), allocatable :: law
      integer :: i

      call given_elastic(choice, law)
      do i = 1, n
         call law%penetration(context_of(contexts(i)), force(i), h(i), codes(i))
      end do
   end subroutine test_law_penetration

   !> Elastic energy with its derivatives to h and to the length rho_a + rho_b - h.
   subroutine test_law_elastic_potential(n, choice, contexts, potential, d_h, d_length, codes) bind(c)
      integer(c_int), intent(in), value :: n
      type(given_law), intent(in) :: choice
      type(given_contact), intent(in) :: contexts(n)
      real(c_double), intent(out) :: potential(n), d_h(n), d_length(n)
      integer(c_int), intent(out) :: codes(n)
      class(elastic_law_t), allocatable :: law
      type(elastic_result) :: elastic
      integer :: i

      call given_elastic(choice, law)
      do i = 1, n
         call law%force(context_of(contexts(i)), elastic, codes(i))
         potential(i) = law%potential(context_of(contexts(i)), elastic%force)
         d_h(i) = elastic%force + elastic%excess
         d_length(i) = elastic%d_energy
      end do
   end subroutine test_law_elastic_potential

   !> Viscous normal force with its derivatives to h, rho_a, rho_b and h_dot.
   subroutine test_law_viscous_force(n, contact, damping, contexts, force, d_h, d_rho_a, d_rho_b, d_h_dot, codes) bind(c)
      integer(c_int), intent(in), value :: n
      type(given_law), intent(in) :: contact, damping
      type(given_contact), intent(in) :: contexts(n)
      real(c_double), intent(out) :: force(n), d_h(n), d_rho_a(n), d_rho_b(n), d_h_dot(n)
      integer(c_int), intent(out) :: codes(n)
      class(elastic_law_t), allocatable :: acting_contact
      class(damping_law_t), allocatable :: acting_damping
      type(contact_context) :: ctx
      type(elastic_result) :: elastic
      type(viscous_result) :: viscous
      integer :: i

      call given_elastic(contact, acting_contact)
      call given_damping(damping, acting_damping)
      do i = 1, n
         ctx = context_of(contexts(i))
         call acting_contact%force(ctx, elastic, codes(i))
         call viscous_force(acting_damping, ctx, elastic, viscous)
         if (acting_damping%left_to_mesh() /= "") then
            viscous = no_viscous
            if (codes(i) == code_ok) codes(i) = code_invalid_input
         end if
         force(i) = viscous%force
         d_h(i) = viscous%d_h
         d_rho_a(i) = viscous%d_rho_a
         d_rho_b(i) = viscous%d_rho_b
         d_h_dot(i) = viscous%d_h_dot
      end do
   end subroutine test_law_viscous_force

   !> phi of F_t = -F_n phi(v_t) and dphi/dv_t, on the branches `modes`.
   subroutine test_law_friction_factor(n, choice, modes, v_t, factor, d_v) bind(c)
      integer(c_int), intent(in), value :: n
      type(given_law), intent(in) :: choice
      integer(c_int), intent(in) :: modes(n)
      real(c_double), intent(in) :: v_t(n)
      real(c_double), intent(out) :: factor(n), d_v(n)
      class(friction_law_t), allocatable :: law
      type(sliding_t) :: at
      real(c_double) :: d_factor(n_sliding)
      integer :: i

      call given_friction(choice, law)
      do i = 1, n
         at%x(1, by_sliding) = v_t(i)
         call law%factor(modes(i), at, factor(i), d_factor)
         d_v(i) = d_factor(by_sliding)
      end do
   end subroutine test_law_friction_factor

   !> The branch that belongs to each sliding velocity.
   subroutine test_law_friction_mode(n, choice, v_t, modes) bind(c)
      integer(c_int), intent(in), value :: n
      type(given_law), intent(in) :: choice
      real(c_double), intent(in) :: v_t(n)
      integer(c_int), intent(out) :: modes(n)
      class(friction_law_t), allocatable :: law
      integer :: i

      call given_friction(choice, law)
      do i = 1, n
         modes(i) = law%branch(v_t(i))
      end do
   end subroutine test_law_friction_mode

   !> The |v_t| at which the branch changes; 0 if it never does.
   real(c_double) function test_law_friction_knee(choice) bind(c)
      type(given_law), intent(in) :: choice
      class(friction_law_t), allocatable :: law

      call given_friction(choice, law)
      test_law_friction_knee = law%knee()
   end function test_law_friction_knee

   !> The coefficient of friction of an operating point, and the factor at 1 m/s of the law that replaces it; -1 for other laws.
   subroutine test_law_operating_coefficient(choice, point, mu, factor) bind(c)
      type(given_law), intent(in) :: choice
      type(given_operating_point), intent(in) :: point
      real(c_double), intent(out) :: mu, factor
      class(friction_law_t), allocatable :: law, acting
      type(operating_point) :: at
      type(sliding_t) :: slides
      real(c_double) :: d_factor(n_sliding)

      mu = -1
      factor = -1
      at = operating_point(point%line_load, point%rolling_speed, point%radius, point%diameter)
      call given_friction(choice, law)
      select type (law)
      class is (operating_friction_t)
         law%lubricant%viscosity = point%viscosity
         law%lubricant%roughness = point%roughness
         mu = law%coefficient(at)
         call law%acting(at, acting)
         slides%x(1, by_sliding) = 1
         call acting%factor(1, slides, factor, d_factor)
      end select
   end subroutine test_law_operating_coefficient

   !> phi of a local law and its derivatives in eight states, each alone and all at once.
   subroutine test_law_local_factor(choice, viscosity, roughness, e_star, x, phi, d_phi, together) bind(c)
      type(given_law), intent(in) :: choice
      real(c_double), intent(in), value :: viscosity, roughness, e_star
      real(c_double), intent(in) :: x(lanes, n_sliding)
      real(c_double), intent(out) :: phi(lanes), d_phi(n_sliding, lanes), together(lanes)
      class(friction_law_t), allocatable :: law
      type(sliding_t) :: all, one
      integer :: l

      call given_friction(choice, law)
      select type (law)
      class is (lubricated_friction_t)
         law%lubricant%viscosity = viscosity
         law%lubricant%roughness = roughness
      end select
      all%x = x
      all%e_star = e_star
      one%e_star = e_star
      do l = 1, lanes
         one%x(1, :) = x(l, :)
         call law%factor(0, one, phi(l), d_phi(:, l))
      end do
      call law%factor_lanes(0, all, together)
   end subroutine test_law_local_factor

   !> The elastic law of a choice; not allocated if there is no such law.
   subroutine given_elastic(choice, law)
      type(given_law), intent(in) :: choice
      class(elastic_law_t), allocatable, intent(out) :: law
      type(kind_finder) :: finder

      finder%index = choice%law
      call elastic_law(finder, law)
      if (allocated(law)) law%parameters = choice%parameters
   end subroutine given_elastic

   !> The damping law of a choice; not allocated if there is no such law.
   subroutine given_damping(choice, law)
      type(given_law), intent(in) :: choice
      class(damping_law_t), allocatable, intent(out) :: law
      type(kind_finder) :: finder

      finder%index = choice%law
      call damping_law(finder, law)
      if (allocated(law)) law%parameters = choice%parameters
   end subroutine given_damping

   !> The friction law of a choice; not allocated if there is no such law.
   subroutine given_friction(choice, law)
      type(given_law), intent(in) :: choice
      class(friction_law_t), allocatable, intent(out) :: law
      type(kind_finder) :: finder

      finder%index = choice%law
      call friction_law(finder, law)
      if (allocated(law)) law%parameters = choice%parameters
   end subroutine given_friction

   !> The kernel's context.
   elemental type(contact_context) function context_of(given) result(context)
      type(given_contact), intent(in) :: given

      context = contact_context(h=given%h, h_dot=given%h_dot, rho_a=given%rho_a, rho_b=given%rho_b, &
                                e_star=given%e_star, width=given%width, v0=given%v0)
   end function context_of

end module law_calls
