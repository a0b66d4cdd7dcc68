!> C interface of the natural modes, and of the modal distance of a start from the steady motion.
!>
!> The header's section "natural modes" documents each procedure; this module converts between C and Fortran.
module evl_capi_modes
   use, intrinsic :: iso_c_binding, only: c_double, c_double_complex, c_f_pointer, c_int, c_ptr
   use evl_capi_types, only: c_status, gearbox_of, return_code
   use evl_discrete_state, only: carrying_contact, take_mode
   use evl_gearbox, only: gearbox_t, i_turns
   use evl_mean_modes, only: gearbox_mean_modes, gearbox_start_distance
   use evl_modes, only: gearbox_modes, gearbox_shape
   use evl_start_positions, only: mesh_position
   use evl_status, only: status_t
   use evl_tooth_contact, only: contact_mode
   implicit none (type, external)
   private

   public :: evl_gearbox_mesh_mode, evl_gearbox_modes, evl_gearbox_shape, evl_gearbox_start_distance

   !> evl_mesh_mode
   type, bind(c) :: c_mesh_mode
      integer(c_int) :: tooth_pair, contact, friction
      real(c_double) :: position
   end type c_mesh_mode

contains

   subroutine evl_gearbox_mesh_mode(handle, mesh, y, integers, reals, mode) bind(c)
      integer(c_int), intent(in), value :: mesh
      real(c_double), intent(in) :: y(*), reals(*)
      integer(c_int), intent(in) :: integers(*)
      type(c_mesh_mode), intent(out) :: mode
      type(contact_mode) :: m
      include "capi/gearbox_of_handle.inc"

      call take_mode(g, carrying_contact(g, mesh + 1, integers), integers, reals, m)
      mode = c_mesh_mode(m%tooth_pair, m%flanks, m%friction, mesh_position(g, mesh + 1, y(:g%n_states), integers(i_turns)))
   end subroutine evl_gearbox_mesh_mode

   integer(c_int) function evl_gearbox_modes(handle, t, y, integers, reals, n_modes, n_rigid, eigenvalues, vectors, means, &
                                             n_positions, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle, eigenvalues, vectors
      real(c_double), intent(in), value :: t
      real(c_double), intent(inout) :: y(*), reals(*)
      integer(c_int), intent(inout) :: integers(*)
      integer(c_int), intent(out) :: n_modes, n_rigid
      real(c_double), intent(inout), optional :: means(*)
      integer(c_int), intent(in), value :: n_positions
      type(c_status), intent(inout), optional :: status
      complex(c_double_complex), pointer :: lambda(:), v(:, :)
      type(gearbox_t), pointer :: g
      type(status_t) :: s

      g => gearbox_of(handle)
      call c_f_pointer(eigenvalues, lambda, [g%n_states])
      call c_f_pointer(vectors, v, [g%n_states, g%n_states])
      if (present(means)) then
         call gearbox_mean_modes(g, t, n_positions, y, integers, reals, n_modes, n_rigid, lambda, v, means, s)
      else
         call gearbox_modes(g, t, y, integers, reals, n_modes, n_rigid, lambda, v, s)
      end if
      code = return_code(s, status)
   end function evl_gearbox_modes

   subroutine evl_gearbox_shape(handle, y, dy, arcs, displacements, penetrations, transmission_errors) bind(c)
      type(c_ptr), intent(in), value :: handle
      real(c_double), intent(in) :: y(*), dy(*)
      real(c_double), intent(inout) :: arcs(*), displacements(2, *), penetrations(*), transmission_errors(*)

      call gearbox_shape(gearbox_of(handle), y, dy, arcs, displacements, penetrations, transmission_errors)
   end subroutine evl_gearbox_shape

   integer(c_int) function evl_gearbox_start_distance(handle, t, start, start_integers, y, integers, reals, n_modes, eigenvalues, &
                                                      vectors, amplitudes, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle, eigenvalues, vectors, amplitudes
      real(c_double), intent(in), value :: t
      real(c_double), intent(in) :: start(*)
      integer(c_int), intent(in) :: start_integers(*)
      real(c_double), intent(inout) :: y(*), reals(*)
      integer(c_int), intent(inout) :: integers(*)
      integer(c_int), intent(out) :: n_modes
      type(c_status), intent(inout), optional :: status
      complex(c_double_complex), pointer :: lambda(:), v(:, :), a(:)
      type(gearbox_t), pointer :: g
      type(status_t) :: s

      g => gearbox_of(handle)
      call c_f_pointer(eigenvalues, lambda, [g%n_states])
      call c_f_pointer(vectors, v, [g%n_states, g%n_states])
      call c_f_pointer(amplitudes, a, [g%n_states])
      call gearbox_start_distance(g, t, start, start_integers(i_turns), y, integers, reals, n_modes, lambda, v, a, s)
      code = return_code(s, status)
   end function evl_gearbox_start_distance

end module evl_capi_modes
