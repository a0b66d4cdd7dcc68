!> C interface of the kinds of load and of support: their tables, and which way a support lets its axle move.
module evl_capi_kinds
   use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_int, c_ptr
   use evl_capi_types, only: c_kind_info, c_max_parameters, parameter_to_c, to_c
   use evl_gearbox, only: gearbox_t
   use evl_load, only: load_t
   use evl_load_kinds, only: load_kind_count, load_of_kind
   use evl_parameter, only: kind_info_t
   use evl_status, only: code_invalid_input, code_ok
   use evl_support, only: support_kind_t
   use evl_support_kinds, only: support_kind_count, support_of_kind
   implicit none (type, external)
   private

   public :: evl_gearbox_support_directions
   public :: evl_load_kind_count, evl_load_kind_describe, evl_support_kind_count, evl_support_kind_describe

contains

   integer(c_int) function evl_load_kind_count() bind(c)

      evl_load_kind_count = load_kind_count()
   end function evl_load_kind_count

   integer(c_int) function evl_support_kind_count() bind(c)

      evl_support_kind_count = support_kind_count()
   end function evl_support_kind_count

   integer(c_int) function evl_load_kind_describe(kind, info) bind(c)
      integer(c_int), intent(in), value :: kind
      type(c_kind_info), intent(out) :: info
      class(load_t), allocatable :: load
      type(kind_info_t) :: from

      call load_of_kind(kind, load)
      evl_load_kind_describe = merge(code_ok, code_invalid_input, allocated(load))
      if (allocated(load)) from = load%describe()
      call info_to_c(from, info)
   end function evl_load_kind_describe

   integer(c_int) function evl_support_kind_describe(kind, info) bind(c)
      integer(c_int), intent(in), value :: kind
      type(c_kind_info), intent(out) :: info
      class(support_kind_t), allocatable :: support
      type(kind_info_t) :: from

      call support_of_kind(kind, support)
      evl_support_kind_describe = merge(code_ok, code_invalid_input, allocated(support))
      if (allocated(support)) from = support%describe()
      call info_to_c(from, info)
   end function evl_support_kind_describe

   integer(c_int) function evl_gearbox_support_directions(handle, wheel, directions) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: wheel
      real(c_double), intent(out) :: directions(4)
      type(gearbox_t), pointer :: g

      call c_f_pointer(handle, g)
      associate (support => g%wheels(wheel + 1)%support)
         directions = [support%direction(:, 1), support%direction(:, 2)]
         evl_gearbox_support_directions = support%n
      end associate
   end function evl_gearbox_support_directions

   !> A kind for C.
   subroutine info_to_c(from, info)
      type(kind_info_t), intent(in) :: from
      type(c_kind_info), intent(out) :: info
      integer :: i

      call to_c(from%name, info%name)
      call to_c(from%description, info%description)
      info%n_parameters = from%n_parameters
      do i = 1, c_max_parameters
         call parameter_to_c(from%parameters(i), info%parameters(i))
      end do
   end subroutine info_to_c

end module evl_capi_kinds
