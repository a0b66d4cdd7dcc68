!> What went wrong, for whom, and in which words.
!>
!> The codes are those of `evl_code` and `evl_subject` in the C header.
module evl_status
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: status_t, clear, fail, has_failed, quantity
   public :: code_ok, code_invalid_input, code_out_of_domain, code_singular, code_no_solution, code_no_memory
   public :: subject_none, subject_wheel, subject_mesh, subject_load, subject_initial, subject_housing, subject_shaft
   public :: field_length, message_length

   integer, parameter :: code_ok = 0            !! nothing to say
   integer, parameter :: code_invalid_input = 1 !! a parameter is refused
   integer, parameter :: code_out_of_domain = 2 !! a state outside the domain of a law; recoverable for a trial state
   integer, parameter :: code_singular = 3      !! a linear system without a solution
   integer, parameter :: code_no_solution = 4   !! an equation without a solution, or none found
   integer, parameter :: code_no_memory = 5     !! allocation failed

   integer, parameter :: subject_none = 0    !! concerns no single part
   integer, parameter :: subject_wheel = 1   !! a wheel
   integer, parameter :: subject_mesh = 2    !! a mesh
   integer, parameter :: subject_load = 3    !! a load
   integer, parameter :: subject_initial = 4 !! the initial state
   integer, parameter :: subject_housing = 5 !! the housing
   integer, parameter :: subject_shaft = 6   !! a shaft

   integer, parameter :: field_length = 47    !! characters of a field's name
   integer, parameter :: message_length = 319 !! characters of a message

   !> An error exists if and only if `code /= code_ok`.
   type :: status_t
      integer :: code = code_ok                    !! one of the codes above
      integer :: subject = subject_none            !! one of the subjects above
      integer :: index = 0                         !! which wheel, mesh, load or shaft, from 1; 0 if none
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
      integer, intent(in), optional :: subject    !! what it is about
      integer, intent(in), optional :: index      !! which one, from 1
      character(len=*), intent(in), optional :: field !! name of the parameter

      status%code = code
      status%message = message
      if (present(subject)) status%subject = subject
      if (present(index)) status%index = index
      if (present(field)) status%field = field
   end subroutine fail

   !> Whether an error is recorded.
   pure logical function has_failed(status)
      type(status_t), intent(in) :: status !! to ask

      has_failed = status%code /= code_ok
   end function has_failed

   !> A number with its unit for a message, such as "0.04 m" or "1.25E-09 m": six significant digits, no trailing zeros.
   pure function quantity(value, unit) result(text)
      real(wp), intent(in) :: value           !! in `unit`
      character(len=*), intent(in) :: unit    !! "" if without
      character(len=:), allocatable :: text
      character(len=32) :: buffer, form
      integer :: decimals, e

      decimals = 5
      e = 0
      if (abs(value) >= 1.0e-3_wp .and. abs(value) < 1.0e6_wp) then
         decimals = max(0, 5 - floor(log10(abs(value))))
         write (form, "(a, i0, a)") "(f32.", decimals, ")"
         write (buffer, form) value
      else if (abs(value) > 0) then
         write (buffer, "(es32.5e2)") value
         e = index(buffer, "E")
      else
         buffer = "0"
         decimals = 0
      end if
      if (e > 0) then
         text = trim_zeros(trim(adjustl(buffer(:e - 1))))//trim(buffer(e:))
      else if (decimals > 0 .and. index(buffer, ".") > 0) then
         text = trim_zeros(trim(adjustl(buffer)))
      else
         text = trim(adjustl(buffer))
         if (text(len(text):) == ".") text = text(:len(text) - 1)
      end if
      if (len(unit) > 0) text = text//" "//unit
   end function quantity

   !> Without the zeros behind the last significant decimal, and without a decimal point that nothing follows.
   pure function trim_zeros(number) result(text)
      character(len=*), intent(in) :: number !! with a decimal point
      character(len=:), allocatable :: text
      integer :: last

      last = verify(number, "0", back=.true.)
      if (number(last:last) == ".") last = last - 1
      text = number(:last)
   end function trim_zeros

end module evl_status
