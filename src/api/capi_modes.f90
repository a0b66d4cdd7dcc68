!> C interface of the natural modes.
!>
!> The header's section "natural modes" documents each procedure; here is only the passage from C to Fortran.
module evl_capi_modes
   use, intrinsic :: iso_c_binding, only: c_double, c_double_complex, c_f_pointer, c_int, c_loc, c_ptr
   use evl_capi_types, only: answer, c_status
   use evl_discrete_state, only: gearbox_mode, leading_contact
   use evl_gearbox, only: gearbox_t, i_turns
   use evl_local_variables, only: i_theta
   use evl_mean_modes, only: gearbox_mean_modes
   use evl_modes, only: gearbox_modes, gearbox_shape
   use evl_start_positions, only: mesh_position
   use evl_status, only: status_t
   use evl_tooth_contact, only: contact_mode
   implicit none (type, external)
   private

   public :: evl_gearbox_mean_modes, evl_gearbox_mesh_mode, evl_gearbox_mesh_position, evl_gearbox_modes, evl_gearbox_shape

   !> evl_mesh_mode
   type, bind(c) :: c_mesh_mode
      integer(c_int) :: tooth_pair, contact, friction
   end type c_mesh_mode

contains

   subroutine evl_gearbox_mesh_mode(handle, mesh, integers, reals, mode) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh
      integer(c_int), intent(in) :: integers(*)
      real(c_double), intent(in) :: reals(*)
      type(c_mesh_mode), intent(out) :: mode
      type(gearbox_t), pointer :: g
      type(contact_mode) :: m

      call c_f_pointer(handle, g)
      m = gearbox_mode(g, leading_contact(g, mesh + 1, integers(:g%n_integers)), integers(:g%n_integers), &
                       reals(:size(g%contacts)))
      mode = c_mesh_mode(m%tooth_pair, m%flanks, m%friction)
   end subroutine evl_gearbox_mesh_mode

   integer(c_int) function evl_gearbox_modes(handle, t, y, integers, reals, n_modes, n_rigid, eigenvalues, vectors, &
                                             status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      real(c_double), intent(in), value :: t
      real(c_double), intent(in) :: y(*), reals(*)
      integer(c_int), intent(in) :: integers(*)
      integer(c_int), intent(out) :: n_modes, n_rigid
      real(c_double), intent(inout), target :: eigenvalues(*), vectors(*) !! pairs of real and imaginary part
      type(c_status), intent(inout), optional :: status
      type(gearbox_t), pointer :: g
      complex(c_double_complex), pointer :: values(:), columns(:, :)
      type(status_t) :: s

      call c_f_pointer(handle, g)
      call c_f_pointer(c_loc(eigenvalues), values, [g%n_states])
      call c_f_pointer(c_loc(vectors), columns, [g%n_states, g%n_states])
      call gearbox_modes(g, t, y(:g%n_states), integers(:g%n_integers), reals(:size(g%contacts)), n_modes, n_rigid, &
                         values, columns, s)
      code = answer(s, status)
   end function evl_gearbox_modes

   integer(c_int) function evl_gearbox_mean_modes(handle, t, y, integers, reals, n_modes, n_rigid, eigenvalues, vectors, &
                                                  values, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      real(c_double), intent(in), value :: t
      real(c_double), intent(inout) :: y(*), reals(*), values(*)
      integer(c_int), intent(inout) :: integers(*)
      integer(c_int), intent(out) :: n_modes, n_rigid
      real(c_double), intent(inout), target :: eigenvalues(*), vectors(*) !! pairs of real and imaginary part
      type(c_status), intent(inout), optional :: status
      type(gearbox_t), pointer :: g
      complex(c_double_complex), pointer :: eigen(:), columns(:, :)
      type(status_t) :: s

      call c_f_pointer(handle, g)
      call c_f_pointer(c_loc(eigenvalues), eigen, [g%n_states])
      call c_f_pointer(c_loc(vectors), columns, [g%n_states, g%n_states])
      call gearbox_mean_modes(g, t, y(:g%n_states), integers(:g%n_integers), reals(:size(g%contacts)), n_modes, n_rigid, eigen, &
                              columns, values(:g%n_values), s)
      code = answer(s, status)
   end function evl_gearbox_mean_modes

   real(c_double) function evl_gearbox_mesh_position(handle, mesh, y, integers) result(pitches) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: mesh
      real(c_double), intent(in) :: y(*)
      integer(c_int), intent(in) :: integers(*)
      type(gearbox_t), pointer :: g

      call c_f_pointer(handle, g)
      pitches = mesh_position(g, mesh + 1, y(i_theta), integers(i_turns))
   end function evl_gearbox_mesh_position

   subroutine evl_gearbox_shape(handle, y, dy, arcs, displacements, penetrations, transmission_errors) bind(c)
      type(c_ptr), intent(in), value :: handle
      real(c_double), intent(in) :: y(*), dy(*)
      real(c_double), intent(inout) :: arcs(*), penetrations(*), transmission_errors(*)
      real(c_double), intent(inout) :: displacements(2, *)
      type(gearbox_t), pointer :: g

      call c_f_pointer(handle, g)
      associate (nw => size(g%wheels), nm => size(g%pairs))
         call gearbox_shape(g, y(:g%n_states), dy(:g%n_states), arcs(:nw), displacements(:, :nw), penetrations(:nm), &
                            transmission_errors(:nm))
      end associate
   end subroutine evl_gearbox_shape

end module evl_capi_modes
