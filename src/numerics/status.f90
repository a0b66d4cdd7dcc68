!> Records of errors and warnings: code, subject and message.
!>
!> The codes are those of `evl_code` and `evl_subject` in the C header.
module evl_status
   use evl_kinds, only: pi, wp
   use evl_number_text, only: number_length, quantity_length, write_number
   implicit none (type, external)
   private

   public :: status_t, clear, fail, has_failed, warn, quantity, degrees
   public :: code_ok, code_invalid_input, code_out_of_domain, code_singular, code_no_solution, code_no_memory, code_store_failed
   public :: subject_none, subject_wheel, subject_mesh, subject_load, subject_initial, subject_housing, subject_shaft
   public :: field_length, message_length

   integer, parameter :: code_ok = 0            !! no error
   integer, parameter :: code_invalid_input = 1 !! a parameter is refused
   integer, parameter :: code_out_of_domain = 2 !! a state outside the domain of a law; recoverable for a trial state
   integer, parameter :: code_singular = 3      !! a linear system without a solution
   integer, parameter :: code_no_solution = 4   !! an equation without a solution, or none found
   integer, parameter :: code_no_memory = 5     !! allocation failed
   integer, parameter :: code_store_failed = 6  !! data stored by the caller could not be read or written

   integer, parameter :: subject_none = 0    !! concerns no single component
   integer, parameter :: subject_wheel = 1   !! a wheel
   integer, parameter :: subject_mesh = 2    !! a mesh
   integer, parameter :: subject_load = 3    !! a load
   integer, parameter :: subject_initial = 4 !! the initial state
   integer, parameter :: subject_housing = 5 !! the housing
   integer, parameter :: subject_shaft = 6   !! a shaft

   integer, parameter :: field_length = 47    !! characters of a field's name
   integer, parameter :: message_length = 319 !! characters of a message

   real(wp), parameter :: degree = 180/pi

   !> Subject and text of an error or a warning. It is an error if and only if `code /= code_ok`.
   type :: status_t
      logical :: in_words = .true.                 !! false: only the code is needed, which costs less; `clear` resets it
      integer :: code = code_ok                    !! one of the codes above
      integer :: subject = subject_none            !! one of the subjects above
      integer :: index = 0                         !! index of the wheel, mesh, load or shaft, from 1; 0 if none
      character(len=field_length) :: field = ""    !! name of the offending parameter
      character(len=message_length) :: message = "" !! one sentence
   end type status_t

contains

   !> Reset to "no error".
   pure subroutine clear(status)
      type(status_t), intent(out) :: status !! to reset

      status%code = code_ok
   end subroutine clear

   !> Record an error.
   pure subroutine fail(status, code, message, subject, index, field)
      type(status_t), intent(inout) :: status     !! to fill
      integer, intent(in) :: code                 !! one of the codes
      character(len=*), intent(in) :: message     !! one sentence, no newline
      integer, intent(in), optional :: subject    !! one of the subjects
      integer, intent(in), optional :: index      !! index of the subject, from 1
      character(len=*), intent(in), optional :: field !! name of the parameter

      status%code = code
      status%message = message
      if (present(subject)) status%subject = subject
      if (present(index)) status%index = index
      if (present(field)) status%field = field
   end subroutine fail

   !> Record a warning: an accepted but noteworthy input. The caller of the kernel adds the names of component and field.
   pure subroutine warn(warnings, message, subject, index, field)
      type(status_t), allocatable, intent(inout) :: warnings(:) !! grows by one, with code_ok
      character(len=*), intent(in) :: message     !! one sentence, no newline, without the component's name
      integer, intent(in), optional :: subject    !! one of the subjects
      integer, intent(in), optional :: index      !! index of the subject, from 1
      character(len=*), intent(in), optional :: field !! name of the parameter
      type(status_t) :: warning

      call fail(warning, code_ok, message, subject, index, field)
      warnings = [warnings, warning]
   end subroutine warn

   !> Whether an error is recorded.
   pure logical function has_failed(status)
      type(status_t), intent(in) :: status !! to check

      has_failed = status%code /= code_ok
   end function has_failed

   !> A number with its unit for a message, such as "0.04 m" or "1.25E-09 m": six significant digits, no trailing zeros.
   !>
   !> Its length follows from the arguments: gfortran stores the length of a deferred-length result in a static variable,
   !> which is a data race between threads that write messages.
   pure function quantity(value, unit) result(text)
      real(wp), intent(in) :: value           !! in `unit`
      character(len=*), intent(in) :: unit    !! "" if there is none
      character(len=quantity_length(value, unit)) :: text
      character(len=number_length) :: number
      integer :: n

      call write_number(value, number, n)
      text = number(:n)
      if (len(unit) > 0) text = number(:n)//" "//unit
   end function quantity

   !> `quantity` for an angle, in degrees.
   pure function degrees(angle) result(text)
      real(wp), intent(in) :: angle !! [rad]
      character(len=quantity_length(angle*degree, "deg")) :: text

      text = quantity(angle*degree, "deg")
   end function degrees

end module evl_status
