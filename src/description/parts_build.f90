!> Creation of loads and supports from their case parameters.
module evl_parts_build
   use evl_gearbox, only: load_slot
   use evl_gearbox_description, only: wheel_input
   use evl_kind_finder, only: kind_finder
   use evl_kinds, only: wp
   use evl_load, only: load_t
   use evl_load_kinds, only: load_of_kind
   use evl_parameter_view, only: parameter_view_t
   use evl_row, only: short_length
   use evl_status, only: code_invalid_input, fail, has_failed, message_length, status_t, subject_load, subject_wheel
   use evl_support, only: support_kind_t, support_t
   use evl_support_kinds, only: support_of_kind
   implicit none (type, external)
   private

   public :: loads_build
   public :: support_build

contains

   !> Create the loads of all wheels, without indices in the discrete state.
   !> Errors: code_invalid_input with the load and the parameter.
   subroutine loads_build(wheels, loads, status)
      type(wheel_input), intent(in) :: wheels(:)
      type(load_slot), allocatable, intent(out) :: loads(:)
      type(status_t), intent(inout) :: status
      type(parameter_view_t), allocatable :: blocks(:)
      logical :: prescribed
      integer :: i, k, n

      n = 0
      do i = 1, size(wheels)
         call wheels(i)%elements("loads", blocks)
         n = n + size(blocks)
      end do
      allocate (loads(n))
      n = 0
      do i = 1, size(wheels)
         call wheels(i)%elements("loads", blocks)
         prescribed = .false.
         do k = 1, size(blocks)
            n = n + 1
            call load_build(blocks(k), i, n, loads(n)%load, status)
            if (has_failed(status)) return
            if (.not. loads(n)%load%prescribes) cycle
            if (prescribed) call fail(status, code_invalid_input, "a second prescribed speed for one wheel; it can have only one", &
                                      subject_load, n)
            if (prescribed) return
            prescribed = .true.
         end do
      end do
   end subroutine loads_build

   !> Create one load.
   subroutine load_build(input, wheel, index, load, status)
      type(parameter_view_t), intent(in) :: input
      integer, intent(in) :: wheel, index
      class(load_t), allocatable, intent(out) :: load
      type(status_t), intent(inout) :: status
      type(kind_finder) :: finder
      character(len=message_length) :: message
      character(len=short_length) :: field

      finder%index = input%choice("kind")
      call load_of_kind(finder, load)
      if (.not. allocated(load)) then
         call fail(status, code_invalid_input, "there is no such kind of load", subject_load, index, "kind")
         return
      end if
      call load%refusal(input, message, field)
      if (message /= "") then
         call fail(status, code_invalid_input, trim(message), subject_load, index, trim(field))
         return
      end if
      call load%take(input)
      call load%find_dependence()
      load%wheel = wheel
      load%against_housing = input%word("against") == "housing"
   end subroutine load_build

   !> Degrees of freedom, springs and dampers. Errors: code_invalid_input if there is no such kind.
   subroutine support_build(input, wheel, wheel_mass, support, status)
      type(parameter_view_t), intent(in) :: input
      integer, intent(in) :: wheel         !! from 1, for the message
      real(wp), intent(in) :: wheel_mass   !! [kg]
      type(support_t), intent(out) :: support
      type(status_t), intent(inout) :: status
      class(support_kind_t), allocatable :: kind
      type(kind_finder) :: finder

      finder%index = input%choice("kind")
      call support_of_kind(finder, kind)
      if (.not. allocated(kind)) then
         call fail(status, code_invalid_input, "there is no such kind of support", subject_wheel, wheel, "support.kind")
         return
      end if
      support%mass = wheel_mass
      call kind%take(input, support)
      support%per_mass = 1/support%mass
      call move_alloc(kind, support%kind)
   end subroutine support_build

end module evl_parts_build
