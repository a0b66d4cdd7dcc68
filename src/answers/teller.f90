!> How outputs are told. An output is one row where its value stands:
!>
!>    call tell(teller, "normal_force", "N", "F_n", "normal force of all tooth pairs", total%normal)
!>
!> The same row lists the output and gives its value. A procedure begins a section of the table for one of its elements, a wheel
!> or a mesh, and tells its rows in order. A teller as it is declared lists them: name, unit, symbol, text and value of each row;
!> whole numbers and logicals are known by the type of the value. To list all that can be told of a gearbox the objects that values
!> come from are empty. A teller that fills puts values where their outputs stand; texts are passed by address and cost nothing.
!>
!>    call needs(teller, needs_points)     the rows behind need these; where no wanted row does, they are not found
!>    if (fills(teller)) x = ...           what cannot be found of empty objects
module evl_teller
   use evl_gearbox, only: section_t
   use evl_kinds, only: wp
   use evl_output, only: needs_nothing, output_rows, output_t, tell_row
   implicit none (type, external)
   private

   public :: teller_t, begin, fill, fills, list_places, needs, take_rows, tell

   type :: teller_t
      private
      real(wp), pointer, contiguous :: all(:) => null()    !! values, that follow each other row by row; none: rows are listed
      integer :: at = 0      !! where the next row's value goes
      integer :: step = 0    !! elements of the section
      integer :: element = 0 !! the present one, from 0
      type(section_t), pointer, contiguous :: sections(:) => null()
      type(output_rows) :: rows !! that are listed
   end type teller_t

   !> One row: name, unit, symbol, text, value.
   interface tell
      module procedure tell_real, tell_integer, tell_logical, tell_vector
   end interface tell

contains

   !> A teller that fills values.
   subroutine fill(teller, sections, values)
      type(teller_t), intent(out) :: teller
      type(section_t), intent(in), target, contiguous :: sections(:)
      real(wp), intent(inout), target, contiguous :: values(:)

      teller%sections => sections
      teller%all => values
   end subroutine fill

   !> Whether it does.
   pure logical function fills(teller)
      type(teller_t), intent(in) :: teller

      fills = associated(teller%all)
   end function fills

   !> A teller that lists rows without unit, symbol and text, which take time.
   pure subroutine list_places(teller)
      type(teller_t), intent(inout) :: teller

      teller%rows%has_texts = .false.
   end subroutine list_places

   !> The rows that were listed.
   pure subroutine take_rows(teller, table)
      type(teller_t), intent(inout) :: teller !! is left without them
      type(output_t), allocatable, intent(out) :: table(:)

      if (.not. allocated(teller%rows%table)) allocate (teller%rows%table(0))
      table = teller%rows%table(:teller%rows%n)
      teller%rows = output_rows()
   end subroutine take_rows

   !> Begin a section for one of its elements.
   pure subroutine begin(teller, section, dims, element, is_static)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: section
      integer, intent(in) :: dims      !! of numbers
      integer, intent(in) :: element   !! from 1
      logical, intent(in), optional :: is_static

      if (associated(teller%sections)) then
         associate (this => teller%sections(section))
            teller%at = this%values_before + element
            teller%step = this%elements
            teller%element = element - 1
         end associate
      else
         teller%rows%section = section
         teller%rows%of = dims
         teller%rows%needs = needs_nothing
         teller%rows%is_static = .false.
         if (present(is_static)) teller%rows%is_static = is_static
      end if
   end subroutine begin

   !> What the rows behind need.
   pure subroutine needs(teller, what)
      type(teller_t), intent(inout) :: teller
      integer, intent(in) :: what

      teller%rows%needs = what
   end subroutine needs

   pure subroutine tell_real(teller, name, units, symbol, text, value, rate_of, no_rate)
      type(teller_t), intent(inout) :: teller
      character(len=*), intent(in) :: name, units, symbol, text
      real(wp), intent(in) :: value
      character(len=*), intent(in), optional :: rate_of, no_rate !! as in `output_t`

      if (associated(teller%all)) then
         teller%all(teller%at) = value
         teller%at = teller%at + teller%step
      else
         call tell_row(teller%rows, name, units, symbol, text, [value], .false., rate_of, no_rate)
      end if
   end subroutine tell_real

   pure subroutine tell_integer(teller, name, units, symbol, text, value)
      type(teller_t), intent(inout) :: teller
      character(len=*), intent(in) :: name, units, symbol, text
      integer, intent(in) :: value

      if (associated(teller%all)) then
         teller%all(teller%at) = real(value, wp)
         teller%at = teller%at + teller%step
      else
         call tell_row(teller%rows, name, units, symbol, text, [real(value, wp)], .true.)
      end if
   end subroutine tell_integer

   !> 1 if so, else 0.
   pure subroutine tell_logical(teller, name, units, symbol, text, value)
      type(teller_t), intent(inout) :: teller
      character(len=*), intent(in) :: name, units, symbol, text
      logical, intent(in) :: value

      call tell_integer(teller, name, units, symbol, text, merge(1, 0, value))
   end subroutine tell_logical

   !> A vector, its components side by side.
   pure subroutine tell_vector(teller, name, units, symbol, text, value, rate_of, no_rate)
      type(teller_t), intent(inout) :: teller
      character(len=*), intent(in) :: name, units, symbol, text
      real(wp), intent(in), contiguous :: value(:)
      character(len=*), intent(in), optional :: rate_of, no_rate !! as in `output_t`
      integer :: i, first, n

      if (associated(teller%all)) then
         n = size(value)
         first = teller%at + (n - 1)*teller%element
         teller%at = teller%at + n*teller%step
         do i = 1, n
            teller%all(first + i - 1) = value(i)
         end do
      else
         call tell_row(teller%rows, name, units, symbol, text, value, .false., rate_of, no_rate)
      end if
   end subroutine tell_vector

end module evl_teller
