!> Registry of outputs. One line defines an output where its value is computed:
!>
!>    call add_output(registry, "normal_force", "N", "F_n", "normal force of all tooth pairs", mesh%normal)
!>
!> The same line lists the output and stores its value. A procedure begins a section of the table for one of its elements, a wheel
!> or a mesh, and adds its rows in order. By default a registry lists them: name, unit, symbol, text and value of each row;
!> integer and logical outputs are recognised by the type of the value. All outputs are listed from empty objects.
!> After `store_in` a registry stores the values of requested rows in their columns; texts are passed by address at no cost.
!>
!> A value consists of eight values, one per state, or of one common to all states. Columns have the width of the storage: 8 or 1.
!>
!>    call needs(registry, needs_points)    requirements of the following rows; computed only if such a row is requested
!>    if (stores(registry)) x = ...         for values that cannot be computed from empty objects
module evl_output_registry
   use evl_kinds, only: lanes, wp
   use evl_output, only: append_row, needs_nothing, none, output_rows, output_t
   implicit none (type, external)
   private

   public :: registry_t, add_components, add_output, begin_section, omit_texts, needs, store_in, stores, take_rows

   type :: registry_t
      private
      real(wp), pointer, contiguous :: values(:) => null() !! (width, columns), contiguous per column; not associated: list rows
      integer, pointer, contiguous :: columns(:) => null() !! columns before the first one of each row, or none
      integer, pointer, contiguous :: rows_before(:) => null() !! number of rows before each section
      integer :: width = 1   !! states per column
      integer :: row = 0     !! index of the last row added
      integer :: element = 1 !! index of the element in the section
      type(output_rows) :: rows !! rows listed
   end type registry_t

   !> Add a row: name, unit, symbol, text, value.
   interface add_output
      module procedure add_real, add_integer, add_logical, add_lanes, add_lane_components
   end interface add_output

contains

   !> Make a registry store values.
   subroutine store_in(registry, rows_before, columns, width, values)
      type(registry_t), intent(out) :: registry
      integer, intent(in), target, contiguous :: rows_before(:) !! before each section
      integer, intent(in), target, contiguous :: columns(:)     !! of each row: number of columns before its first one, or none
      integer, intent(in) :: width                              !! states per column
      real(wp), intent(inout), target, contiguous :: values(:)

      registry%rows_before => rows_before
      registry%columns => columns
      registry%width = width
      registry%values => values
   end subroutine store_in

   !> Whether the registry stores values.
   pure logical function stores(registry)
      type(registry_t), intent(in) :: registry

      stores = associated(registry%values)
   end function stores

   !> List rows without unit, symbol and text, which is faster.
   pure subroutine omit_texts(registry)
      type(registry_t), intent(inout) :: registry

      registry%rows%has_texts = .false.
   end subroutine omit_texts

   !> Return the listed rows.
   pure subroutine take_rows(registry, table)
      type(registry_t), intent(inout) :: registry !! is cleared
      type(output_t), allocatable, intent(out) :: table(:)

      if (.not. allocated(registry%rows%table)) allocate (registry%rows%table(0))
      table = registry%rows%table(:registry%rows%n)
      registry%rows = output_rows()
   end subroutine take_rows

   !> Begin a section of the table for one of its elements.
   pure subroutine begin_section(registry, section, dims, element, is_static)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: section
      integer, intent(in) :: dims      !! dimension of a scalar of this section
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

   !> Set the requirements of the following rows.
   pure subroutine needs(registry, what)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: what

      registry%rows%needs = what
   end subroutine needs

   !> Number of values before those of the next row's element, with n components; none if the row is not requested.
   pure subroutine find_offset(registry, n, before)
      type(registry_t), intent(inout) :: registry
      integer, intent(in) :: n
      integer, intent(out) :: before

      registry%row = registry%row + 1
      before = none
      if (registry%columns(registry%row) /= none) &
         before = registry%width*(registry%columns(registry%row) + n*(registry%element - 1))
   end subroutine find_offset

   !> Add a value common to all states.
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

   !> Add 1 for true, 0 for false.
   pure subroutine add_logical(registry, name, units, symbol, text, value)
      type(registry_t), intent(inout) :: registry
      character(len=*), intent(in) :: name, units, symbol, text
      logical, intent(in) :: value

      call add_integer(registry, name, units, symbol, text, merge(1, 0, value))
   end subroutine add_logical

   !> Add a vector common to all states.
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
      call find_offset(registry, size(value), before)
      if (before == none) return
      do k = 1, size(value)
         registry%values(before + registry%width*(k - 1) + 1:before + registry%width*k) = value(k)
      end do
   end subroutine add_components

   !> Add one value per state, for eight states.
   pure subroutine add_lanes(registry, name, units, symbol, text, value, rate_of, no_rate, is_integer)
      type(registry_t), intent(inout) :: registry !! with columns of eight states
      character(len=*), intent(in) :: name, units, symbol, text
      real(wp), intent(in) :: value(lanes)
      character(len=*), intent(in), optional :: rate_of, no_rate
      logical, intent(in), optional :: is_integer !! the values are integers
      logical :: whole
      integer :: before

      if (associated(registry%values)) then
         call find_offset(registry, 1, before)
         if (before /= none) registry%values(before + 1:before + lanes) = value
         return
      end if
      whole = .false.
      if (present(is_integer)) whole = is_integer
      call append_row(registry%rows, name, units, symbol, text, [0.0_wp], whole, rate_of, no_rate)
   end subroutine add_lanes

   !> Add one vector per state, for eight states.
   pure subroutine add_lane_components(registry, name, units, symbol, text, value, rate_of, no_rate)
      type(registry_t), intent(inout) :: registry
      character(len=*), intent(in) :: name, units, symbol, text
      real(wp), intent(in), contiguous :: value(:, :) !! (lanes, components)
      character(len=*), intent(in), optional :: rate_of, no_rate
      real(wp), parameter :: nothing(4) = 0.0_wp !! maximum number of components of an output
      integer :: before, k

      if (.not. associated(registry%values)) then
         call append_row(registry%rows, name, units, symbol, text, nothing(:size(value, 2)), .false., rate_of, no_rate)
         return
      end if
      call find_offset(registry, size(value, 2), before)
      if (before == none) return
      do k = 1, size(value, 2)
         registry%values(before + lanes*(k - 1) + 1:before + lanes*k) = value(:, k)
      end do
   end subroutine add_lane_components

end module evl_output_registry
