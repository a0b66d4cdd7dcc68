!> C interface of the inputs: loads that are given anew while a gearbox moves.
!>
!> The header's section "inputs" documents each procedure; here is only the passage from C to Fortran.
module evl_capi_inputs
   use, intrinsic :: iso_c_binding, only: c_bool, c_double, c_int, c_ptr
   use evl_capi_types, only: gearbox_of
   use evl_gearbox, only: gearbox_t
   use evl_load, only: load_point, load_t
   use evl_wheel_loads, only: followed_speed
   implicit none (type, external)
   private

   public :: evl_gearbox_feed, evl_gearbox_input, evl_gearbox_wheel_speed

   !> evl_input
   type, bind(c) :: c_input
      integer(c_int) :: load, wheel, place
      logical(c_bool) :: is_speed
      real(c_double) :: value
   end type c_input

contains

   logical(c_bool) function evl_gearbox_input(handle, index, input) result(found) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: index
      type(c_input), intent(out) :: input
      type(gearbox_t), pointer :: g
      integer :: w, k, before

      g => gearbox_of(handle)
      found = .false.
      input = c_input(0, 0, 0, .false._c_bool, 0)
      before = 0
      do w = 1, size(g%wheels)
         do k = 1, size(g%wheels(w)%loads)
            associate (load => g%loads(g%wheels(w)%loads(k))%load)
               if (.not. load%is_input) cycle
               if (before == index) then
                  input = c_input(g%wheels(w)%loads(k) - 1, w - 1, k - 1, logical(load%prescribes, c_bool), value_of(load))
                  found = .true.
                  return
               end if
               before = before + 1
            end associate
         end do
      end do
   end function evl_gearbox_input

   pure real(c_double) function value_of(load) result(value)
      class(load_t), intent(in) :: load
      real(c_double) :: damping, stiffness

      if (load%prescribes) then
         value = load%speed(0.0_c_double, 0)
      else
         call load%ask(load_point(), value, damping, stiffness)
      end if
   end function value_of

   subroutine evl_gearbox_feed(handle, load, value, rate) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: load
      real(c_double), intent(in), value :: value, rate
      type(gearbox_t), pointer :: g

      g => gearbox_of(handle)
      call g%loads(load + 1)%load%feed(value, rate)
   end subroutine evl_gearbox_feed

   real(c_double) function evl_gearbox_wheel_speed(handle, wheel, t, y) result(speed) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: wheel
      real(c_double), intent(in), value :: t
      real(c_double), intent(in) :: y(*)
      type(gearbox_t), pointer :: g

      g => gearbox_of(handle)
      speed = followed_speed(g, wheel + 1, t, y)
   end function evl_gearbox_wheel_speed

end module evl_capi_inputs
