!> C interface of the force laws: the table, each family's calls, and the damping law of a mesh.
!>
!> The header documents each procedure, in its sections "law tables" and "parts".
module evl_capi_laws
   use, intrinsic :: iso_c_binding, only: c_bool, c_char, c_double, c_f_pointer, c_int, c_ptr
   use evl_capi_types, only: c_contact_context, c_law_choice, c_law_info, c_max_law_parameters, c_message_length, &
                             c_status, choice_from_c, context_from_c, first_error, status_to_c, to_c
   use evl_contact_laws, only: contact_context, elastic_force, elastic_limit_message, elastic_potential, &
                               elastic_result, friction_factor, friction_knee, friction_mode, law_choice, law_count, &
                               law_describe, law_info_t, law_validate, penetration_from_force, viscous_force, viscous_result
   use evl_gearbox, only: gearbox_t
   use evl_mesh_damping, only: damping_left_to_mesh
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
      do i = 1, c_max_law_parameters
         associate (from => law%parameters(i), to => info%parameters(i))
            call to_c(from%name, to%name)
            call to_c(from%units, to%units)
            call to_c(from%description, to%description)
            to%required = logical(from%required, c_bool)
            to%default_value = from%default_value
            to%minimum = from%minimum
            to%maximum = from%maximum
            to%minimum_open = logical(from%minimum_open, c_bool)
            to%maximum_open = logical(from%maximum_open, c_bool)
         end associate
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
      type(law_choice) :: law
      type(elastic_result) :: elastic
      integer :: i

      law = choice_from_c(choice)
      do i = 1, n
         call elastic_force(law, context_from_c(contexts(i)), elastic, codes(i))
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
      character(len=message_length) :: text

      call elastic_limit_message(choice_from_c(choice), context_from_c(context), text)
      call to_c(text, message)
   end subroutine evl_law_elastic_limit

   integer(c_int) function evl_law_penetration(n, choice, contexts, force, h, codes) bind(c)
      integer(c_int), intent(in), value :: n
      type(c_law_choice), intent(in) :: choice
      type(c_contact_context), intent(in) :: contexts(n)
      real(c_double), intent(in) :: force(n)
      real(c_double), intent(out) :: h(n)
      integer(c_int), intent(out) :: codes(n)
      type(law_choice) :: law
      integer :: i

      law = choice_from_c(choice)
      do i = 1, n
         call penetration_from_force(law, context_from_c(contexts(i)), force(i), h(i), codes(i))
      end do
      evl_law_penetration = first_error(codes)
   end function evl_law_penetration

   integer(c_int) function evl_law_elastic_potential(n, choice, contexts, potential, d_h, d_length, codes) bind(c)
      integer(c_int), intent(in), value :: n
      type(c_law_choice), intent(in) :: choice
      type(c_contact_context), intent(in) :: contexts(n)
      real(c_double), intent(out) :: potential(n), d_h(n), d_length(n)
      integer(c_int), intent(out) :: codes(n)
      type(law_choice) :: law
      type(elastic_result) :: elastic
      integer :: i

      law = choice_from_c(choice)
      do i = 1, n
         call elastic_potential(law, context_from_c(contexts(i)), potential(i))
         call elastic_force(law, context_from_c(contexts(i)), elastic, codes(i))
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
      type(law_choice) :: contact_law, damping_law
      type(contact_context) :: ctx
      type(elastic_result) :: elastic
      type(viscous_result) :: viscous
      integer :: i

      contact_law = choice_from_c(contact)
      damping_law = choice_from_c(damping)
      do i = 1, n
         ctx = context_from_c(contexts(i))
         call elastic_force(contact_law, ctx, elastic, codes(i))
         call viscous_force(damping_law, ctx, elastic, viscous)
         if (damping_left_to_mesh(damping_law) /= "") then
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
      type(law_choice) :: law
      integer :: i

      law = choice_from_c(choice)
      do i = 1, n
         call friction_factor(law, modes(i), v_t(i), factor(i), d_v(i))
      end do
   end subroutine evl_law_friction_factor

   subroutine evl_law_friction_mode(n, choice, v_t, modes) bind(c)
      integer(c_int), intent(in), value :: n
      type(c_law_choice), intent(in) :: choice
      real(c_double), intent(in) :: v_t(n)
      integer(c_int), intent(out) :: modes(n)
      integer :: i

      do i = 1, n
         modes(i) = friction_mode(choice_from_c(choice), v_t(i))
      end do
   end subroutine evl_law_friction_mode

   real(c_double) function evl_law_friction_knee(choice) bind(c)
      type(c_law_choice), intent(in) :: choice

      evl_law_friction_knee = friction_knee(choice_from_c(choice))
   end function evl_law_friction_knee

end module evl_capi_laws
