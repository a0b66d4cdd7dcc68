!> C interface of the force laws: the table, each family's calls, and the damping law of a mesh.
!>
!> The header documents each procedure, in its sections "law tables" and "parts".
module evl_capi_laws
   use, intrinsic :: iso_c_binding, only: c_bool, c_char, c_double, c_f_pointer, c_int, c_ptr
   use evl_capi_types, only: c_contact_context, c_law_choice, c_law_info, c_max_parameters, c_message_length, c_status, &
                             choice_from_c, context_from_c, first_error, parameter_to_c, status_to_c, to_c
   use evl_contact_context, only: contact_context
   use evl_damping_law, only: damping_law_t, viscous_force, viscous_result
   use evl_elastic_law, only: elastic_law_t, elastic_result
   use evl_friction_law, only: friction_law_t
   use evl_gearbox, only: gearbox_t
   use evl_law_info, only: law_info_t
   use evl_law_table, only: damping_law, elastic_law, friction_law, law_count, law_describe, law_validate
   use evl_status, only: code_invalid_input, code_ok, message_length, status_t
   implicit none (type, external)
   private

   public :: evl_gearbox_damping
   public :: evl_law_count, evl_law_describe, evl_law_elastic_force, evl_law_elastic_limit, evl_law_elastic_potential
   public :: evl_law_friction_factor, evl_law_friction_knee, evl_law_friction_mode, evl_law_penetration
   public :: evl_law_validate, evl_law_viscous_force

contains

   integer(c_int) function evl_law_count(family) bind(c)
      integer(c_int), intent(in), value :: family

      evl_law_count = law_count(family)
   end function evl_law_count

   integer(c_int) function evl_law_describe(family, index, info) bind(c)
      integer(c_int), intent(in), value :: family, index
      type(c_law_info), intent(out) :: info
      type(law_info_t) :: law
      integer :: i

      call law_describe(family, index, law, evl_law_describe)
      call to_c(law%name, info%name)
      call to_c(law%description, info%description)
      call to_c(law%source, info%source)
      info%n_parameters = law%n_parameters
      do i = 1, c_max_parameters
         call parameter_to_c(law%parameters(i), info%parameters(i))
      end do
   end function evl_law_describe

   subroutine evl_gearbox_damping(handle, mesh, choice) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh
      type(c_law_choice), intent(out) :: choice
      type(gearbox_t), pointer :: g

      call c_f_pointer(handle, g)
      choice = c_law_choice(g%references(mesh + 1)%law%law, g%references(mesh + 1)%law%parameters)
   end subroutine evl_gearbox_damping

   integer(c_int) function evl_law_validate(family, choice, status) bind(c)
      integer(c_int), intent(in), value :: family
      type(c_law_choice), intent(in) :: choice
      type(c_status), intent(out), optional :: status
      type(status_t) :: s

      call law_validate(family, choice_from_c(choice), s%code, s%field, s%message)
      if (present(status)) call status_to_c(s, status)
      evl_law_validate = s%code
   end function evl_law_validate

   integer(c_int) function evl_law_elastic_force(n, choice, contexts, force, d_h, d_rho, codes) bind(c)
      integer(c_int), intent(in), value :: n
      type(c_law_choice), intent(in) :: choice
      type(c_contact_context), intent(in) :: contexts(n)
      real(c_double), intent(out) :: force(n), d_h(n), d_rho(n)
      integer(c_int), intent(out) :: codes(n)
      class(elastic_law_t), allocatable :: law
      type(elastic_result) :: elastic
      integer :: i

      call elastic_law(choice_from_c(choice), law)
      do i = 1, n
         call law%force(context_from_c(contexts(i)), elastic, codes(i))
         force(i) = elastic%force
         d_h(i) = elastic%d_h
         d_rho(i) = elastic%d_rho
      end do
      evl_law_elastic_force = first_error(codes)
   end function evl_law_elastic_force

   subroutine evl_law_elastic_limit(choice, context, message) bind(c)
      type(c_law_choice), intent(in) :: choice
      type(c_contact_context), intent(in) :: context
      character(kind=c_char), intent(out) :: message(c_message_length)
      class(elastic_law_t), allocatable :: law
      character(len=message_length) :: text

      call elastic_law(choice_from_c(choice), law)
      call law%limit_message(context_from_c(context), text)
      call to_c(text, message)
   end subroutine evl_law_elastic_limit

   integer(c_int) function evl_law_penetration(n, choice, contexts, force, h, codes) bind(c)
      integer(c_int), intent(in), value :: n
      type(c_law_choice), intent(in) :: choice
      type(c_contact_context), intent(in) :: contexts(n)
      real(c_double), intent(in) :: force(n)
      real(c_double), intent(out) :: h(n)
      integer(c_int), intent(out) :: codes(n)
      class(elastic_law_t), allocatable :: law
      integer :: i

      call elastic_law(choice_from_c(choice), law)
      do i = 1, n
         call law%penetration(context_from_c(contexts(i)), force(i), h(i), codes(i))
      end do
      evl_law_penetration = first_error(codes)
   end function evl_law_penetration

   integer(c_int) function evl_law_elastic_potential(n, choice, contexts, potential, d_h, d_length, codes) bind(c)
      integer(c_int), intent(in), value :: n
      type(c_law_choice), intent(in) :: choice
      type(c_contact_context), intent(in) :: contexts(n)
      real(c_double), intent(out) :: potential(n), d_h(n), d_length(n)
      integer(c_int), intent(out) :: codes(n)
      class(elastic_law_t), allocatable :: law
      type(elastic_result) :: elastic
      integer :: i

      call elastic_law(choice_from_c(choice), law)
      do i = 1, n
         call law%force(context_from_c(contexts(i)), elastic, codes(i))
         potential(i) = law%potential(context_from_c(contexts(i)), elastic%force)
         d_h(i) = elastic%force + elastic%excess
         d_length(i) = elastic%d_energy
      end do
      evl_law_elastic_potential = first_error(codes)
   end function evl_law_elastic_potential

   integer(c_int) function evl_law_viscous_force(n, contact, damping, contexts, force, d_h, d_rho, d_h_dot, codes) bind(c)
      integer(c_int), intent(in), value :: n
      type(c_law_choice), intent(in) :: contact, damping
      type(c_contact_context), intent(in) :: contexts(n)
      real(c_double), intent(out) :: force(n), d_h(n), d_rho(n), d_h_dot(n)
      integer(c_int), intent(out) :: codes(n)
      class(elastic_law_t), allocatable :: acting_contact
      class(damping_law_t), allocatable :: acting_damping
      type(contact_context) :: ctx
      type(elastic_result) :: elastic
      type(viscous_result) :: viscous
      integer :: i

      call elastic_law(choice_from_c(contact), acting_contact)
      call damping_law(choice_from_c(damping), acting_damping)
      do i = 1, n
         ctx = context_from_c(contexts(i))
         call acting_contact%force(ctx, elastic, codes(i))
         call viscous_force(acting_damping, ctx, elastic, viscous)
         if (acting_damping%left_to_mesh() /= "") then
            viscous = viscous_result()
            if (codes(i) == code_ok) codes(i) = code_invalid_input
         end if
         force(i) = viscous%force
         d_h(i) = viscous%d_h
         d_rho(i) = viscous%d_rho
         d_h_dot(i) = viscous%d_h_dot
      end do
      evl_law_viscous_force = first_error(codes)
   end function evl_law_viscous_force

   subroutine evl_law_friction_factor(n, choice, modes, v_t, factor, d_v) bind(c)
      integer(c_int), intent(in), value :: n
      type(c_law_choice), intent(in) :: choice
      integer(c_int), intent(in) :: modes(n)
      real(c_double), intent(in) :: v_t(n)
      real(c_double), intent(out) :: factor(n), d_v(n)
      class(friction_law_t), allocatable :: law
      integer :: i

      call friction_law(choice_from_c(choice), law)
      do i = 1, n
         call law%factor(modes(i), v_t(i), factor(i), d_v(i))
      end do
   end subroutine evl_law_friction_factor

   subroutine evl_law_friction_mode(n, choice, v_t, modes) bind(c)
      integer(c_int), intent(in), value :: n
      type(c_law_choice), intent(in) :: choice
      real(c_double), intent(in) :: v_t(n)
      integer(c_int), intent(out) :: modes(n)
      class(friction_law_t), allocatable :: law
      integer :: i

      call friction_law(choice_from_c(choice), law)
      do i = 1, n
         modes(i) = law%branch(v_t(i))
      end do
   end subroutine evl_law_friction_mode

   real(c_double) function evl_law_friction_knee(choice) bind(c)
      type(c_law_choice), intent(in) :: choice
      class(friction_law_t), allocatable :: law

      call friction_law(choice_from_c(choice), law)
      evl_law_friction_knee = law%knee()
   end function evl_law_friction_knee

end module evl_capi_laws
