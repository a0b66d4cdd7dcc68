!> C interface of samplers: some outputs at many states.
!>
!> The header's section "outputs" documents each procedure; here is only the passage from C to Fortran. A handle is the address of a
!> sampler with its gearbox.
module evl_capi_sampler
   use, intrinsic :: iso_c_binding, only: c_bool, c_double, c_f_pointer, c_int, c_loc, c_null_ptr, c_ptr
   use evl_capi_types, only: answer, c_status, gearbox_of
   use evl_gearbox, only: gearbox_t
   use evl_outputs, only: output_sampler, sample_outputs, sampler_create
   use evl_status, only: code_ok, status_t
   implicit none (type, external)
   private

   public :: evl_sampler_ask, evl_sampler_create, evl_sampler_delete, evl_sampler_in_lanes

   !> evl_sampler
   type :: sampler_t
      type(gearbox_t), pointer :: gearbox => null()
      type(output_sampler) :: outputs
      type(status_t) :: status !! blank between calls: to make one in each takes time
   end type sampler_t

contains

   type(c_ptr) function evl_sampler_create(gearbox_handle, n, wanted) result(handle) bind(c)
      type(c_ptr), intent(in), value :: gearbox_handle
      integer(c_int), intent(in), value :: n
      integer(c_int), intent(in) :: wanted(n)
      type(sampler_t), pointer :: self

      allocate (self)
      self%gearbox => gearbox_of(gearbox_handle)
      call sampler_create(self%outputs, self%gearbox, wanted + 1)
      handle = c_loc(self)
   end function evl_sampler_create

   logical(c_bool) function evl_sampler_in_lanes(handle) result(in_lanes) bind(c)
      type(c_ptr), intent(in), value :: handle
      type(sampler_t), pointer :: self

      call c_f_pointer(handle, self)
      in_lanes = logical(self%outputs%states%in_lanes, c_bool)
   end function evl_sampler_in_lanes

   subroutine evl_sampler_delete(handle) bind(c)
      type(c_ptr), intent(inout) :: handle
      type(sampler_t), pointer :: self

      call c_f_pointer(handle, self)
      if (associated(self)) deallocate (self)
      handle = c_null_ptr
   end subroutine evl_sampler_delete

   integer(c_int) function evl_sampler_ask(handle, n, n_meant, t, y, integers, reals, check, values, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: n, n_meant
      logical(c_bool), intent(in), value :: check
      real(c_double), intent(in) :: t(n), reals(*)
      real(c_double), intent(in), target :: y(*)
      integer(c_int), intent(in) :: integers(*)
      real(c_double), intent(inout), target :: values(*)
      type(c_status), intent(inout), optional :: status
      real(c_double), pointer, contiguous :: rows(:, :), states(:, :)
      type(sampler_t), pointer :: self

      call c_f_pointer(handle, self)
      associate (g => self%gearbox, n_values => self%outputs%before(size(self%outputs%before)))
         rows(1:n, 1:n_values) => values(:n*n_values)
         states(1:n, 1:g%n_states) => y(:g%n_states*n)
         call sample_outputs(self%outputs, g, n_meant, t, states, integers(:g%n_integers), reals(:size(g%contacts)), &
                             logical(check), rows, self%status)
      end associate
      code = answer(self%status, status)
      if (code /= code_ok) self%status = status_t()
   end function evl_sampler_ask

end module evl_capi_sampler
