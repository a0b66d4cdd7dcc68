!> The registry of outputs. An output is one row where its value stands:
!>
!>    call add_output(registry, "normal_force", "N", "F_n", "normal force of all tooth pairs", mesh%normal)
!>
!> The same row lists the output and stores its value. A procedure begins a section of the table for one of its elements, a wheel
!> or a mesh, and adds its rows in order. A registry as it is declared lists them: name, unit, symbol, text and value of each row;
!> whole numbers and logicals are known by the type of the value. To list all outputs of a gearbox the objects that values come
!> from are empty. A registry that stores puts the values of requested rows into their columns; texts are passed by address and
!> cost nothing.
!>
!> A value is that of eight states, or one that they share. Columns have the width of what they are stored in: 8 states or 1.
!>
!>    call needs(registry, needs_points)    the rows behind need these; where no requested row does, they are not computed
!>    if (stores(registry)) x = ...         what cannot be computed of empty objects
module evl_output_registry
   use evl_kinds, only: lanes, wp
   use evl_output, only: needs_nothing, none, output_rows, output_t, append_row
   implicit none (type, external)
   private

   public :: registry_t, add_components, add_output, begin_section, list_places, needs, store_in, stores, take_rows

   type :: registry_t
      private
      real(wp), pointer, contiguous :: values(:) => null() !! (width, columns), side by side; not associated: rows are listed
      integer, pointer, contiguous :: columns(:) => null() !! before the first of each row, or none
      integer, pointer, contiguous :: rows_before(:) => null() !! each section
      integer :: width = 1   !! states of a column
      integer :: row = 0     !! the last one added
      integer :: element = 1 !! of the section
      type(output_rows) :: rows !! that are listed
   end type registry_t

   !> One row: name, unit, symbol, text, value.
   interface add_output
      module procedure add_real, add_integer, add_logical, add_lanes, add_lane_components
   end interface add_output

contains

   !> A registry that stores.
   subroutine store_in(registry, rows_before, columns, width, values)
      type(registry_t), intent(out) :: registry
      integer, intent(in), target, contiguous :: rows_before(:) !! each section
      integer, intent(in), target, contiguous :: columns(:)     !! of each row: those before its first, or none
      integer, intent(in) :: width                              !! of columns
      real(wp), intent(inout), target, contiguous :: values(:)

      registry%rows_before => rows_before
      registry%columns => columns
      registry%width = width
      registry%values => values
   end subroutine store_in

   !> Whether it does.
   pure logical function stores(registry)
      type(registry_t), intent(in) :: registry

      stores = associated(registry%values)
   end function stores

   !> List rows without unit, symbol and text, which take time.
   pure subroutine list_places(registry)
      type(registry_t), intent(inout) :: registry

      registry%rows%has_texts = .false.
   end subroutine list_places

   !> The rows that were listed.
   pure subroutine take_rows(registry, table)
      type(registry_t), intent(inout) :: registry !! is left without them
      type(output_t), allocatable, intent(out) :: table(:)

      if (.not. allocated(registry%rows%table)) allocate (registry%rows%table(0))
      table = registry%rows%table(:registry%rows%n)
      registry%rows = output_rows()
   end subroutine take_rows

   !> Begin a section for one of its elements.
   pure subroutine begin_section(registry, section, dims, element, is_static)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: section
      integer, intent(in) :: dims      !! of numbers
      integer, intent(in) :: element   !! from 1
      logical, intent(in), optional :: is_static

      if (associated(registry%values)) then
         registry%row = registry%rows_before(section)
         registry%element = element
      else
         registry%rows%section = section
         registry%rows%of = dims
         registry%rows%needs = needs_nothing
         registry%rows%is_static = .false.
         if (present(is_static)) registry%rows%is_static = is_static
      end if
   end subroutine begin_section

   !> What the rows behind need.
   pure subroutine needs(registry, what)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: what

      registry%rows%needs = what
   end subroutine needs

   !> Values before those of the next row's element, with n components; none if it is not requested.
   pure subroutine find_place(registry, n, before)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: n
      integer, intent(out) :: before

      registry%row = registry%row + 1
      before = none
      if (registry%columns(registry%row) /= none) &
         before = registry%width*(registry%columns(registry%row) + n*(registry%element - 1))
   end subroutine find_place

   !> A value that all states share.
   pure subroutine add_real(registry, name, units, symbol, text, value, rate_of, no_rate)
      type(registry_t), intent(inout) :: registry
      character(len=*), intent(in) :: name, units, symbol, text
      real(wp), intent(in) :: value
      character(len=*), intent(in), optional :: rate_of, no_rate !! as in `output_t`

      call add_components(registry, name, units, symbol, text, [value], rate_of, no_rate)
   end subroutine add_real

   pure subroutine add_integer(registry, name, units, symbol, text, value)
      type(registry_t), intent(inout) :: registry
      character(len=*), intent(in) :: name, units, symbol, text
      integer, intent(in) :: value

      if (associated(registry%values)) then
         call add_components(registry, name, units, symbol, text, [real(value, wp)])
      else
         call append_row(registry%rows, name, units, symbol, text, [real(value, wp)], .true.)
      end if
   end subroutine add_integer

   !> 1 if so, else 0.
   pure subroutine add_logical(registry, name, units, symbol, text, value)
      type(registry_t), intent(inout) :: registry
      character(len=*), intent(in) :: name, units, symbol, text
      logical, intent(in) :: value

      call add_integer(registry, name, units, symbol, text, merge(1, 0, value))
   end subroutine add_logical

   !> Components of a vector that all states share, side by side.
   pure subroutine add_components(registry, name, units, symbol, text, value, rate_of, no_rate)
      type(registry_t), intent(inout) :: registry
      character(len=*), intent(in) :: name, units, symbol, text
      real(wp), intent(in) :: value(:)
      character(len=*), intent(in), optional :: rate_of, no_rate
      integer :: before, k

      if (.not. associated(registry%values)) then
         call append_row(registry%rows, name, units, symbol, text, value, .false., rate_of, no_rate)
         return
      end if
      call find_place(registry, size(value), before)
      if (before == none) return
      do k = 1, size(value)
         registry%values(before + registry%width*(k - 1) + 1:before + registry%width*k) = value(k)
      end do
   end subroutine add_components

   !> A value of each of eight states.
   pure subroutine add_lanes(registry, name, units, symbol, text, value, rate_of, no_rate, is_integer)
      type(registry_t), intent(inout) :: registry !! with columns of that width
      character(len=*), intent(in) :: name, units, symbol, text
      real(wp), intent(in) :: value(lanes)
      character(len=*), intent(in), optional :: rate_of, no_rate
      logical, intent(in), optional :: is_integer !! whole numbers
      logical :: whole
      integer :: before

      if (associated(registry%values)) then
         call find_place(registry, 1, before)
         if (before /= none) registry%values(before + 1:before + lanes) = value
         return
      end if
      whole = .false.
      if (present(is_integer)) whole = is_integer
      call append_row(registry%rows, name, units, symbol, text, [0.0_wp], whole, rate_of, no_rate)
   end subroutine add_lanes

   !> A vector of each of eight states.
   pure subroutine add_lane_components(registry, name, units, symbol, text, value, rate_of, no_rate)
      type(registry_t), intent(inout) :: registry
      character(len=*), intent(in) :: name, units, symbol, text
      real(wp), intent(in), contiguous :: value(:, :) !! (lanes, components)
      character(len=*), intent(in), optional :: rate_of, no_rate
      real(wp), parameter :: nothing(4) = 0.0_wp !! no output has more components
      integer :: before, k

      if (.not. associated(registry%values)) then
         call append_row(registry%rows, name, units, symbol, text, nothing(:size(value, 2)), .false., rate_of, no_rate)
         return
      end if
      call find_place(registry, size(value, 2), before)
      if (before == none) return
      do k = 1, size(value, 2)
         registry%values(before + lanes*(k - 1) + 1:before + lanes*k) = value(:, k)
      end do
   end subroutine add_lane_components

end module evl_output_registry
