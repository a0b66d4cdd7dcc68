!> Case parameters, validated against the schema (rows): a tree of blocks, stored as a list of entries.
!>
!> An entry is a key with its value; the entries of a block follow its own entry, one level deeper. A component reads its
!> block by key and obtains numbers in SI units and radians. A key that is not given has the default of its row.
module evl_parameter_view
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use evl_kinds, only: wp
   use evl_row, only: row_t, short_length, text_length
   implicit none (type, external)
   private

   public :: description_t, entry_t, parameter_view_t

   real(wp), parameter :: radians_per_degree = 0.017453292519943295769_wp

   !> A key, an element of a list or map, or a named number.
   type :: entry_t
      integer :: row = 0                     !! index of its row
      integer :: level = 1                   !! 1: a key of the case; one more in each block
      character(len=:), allocatable :: name  !! of an element or a number; the word or text given; "" if there is none
      real(wp), allocatable :: numbers(:)    !! in the unit of the row
   end type entry_t

   !> All parameters of a case. It must not move while views of it are in use.
   type :: description_t
      type(row_t), allocatable :: rows(:)
      type(entry_t), allocatable :: entries(:)
   end type description_t

   !> A view of a block.
   type :: parameter_view_t
      type(row_t), pointer :: rows(:) => null()
      type(entry_t), pointer :: entries(:) => null()  !! entries of the block, without its own
      integer :: level = 1                            !! level of its keys
      character(len=short_length) :: block = "case"   !! type of the block
      character(len=text_length) :: name = ""         !! name of an element
      integer :: first = 0                            !! index of the first of the entries in the description
      integer :: first_row = 1                        !! index of the first row of the block
   contains
      procedure :: all_of
      procedure :: has
      procedure :: number
      procedure :: in_unit
      procedure :: whole
      procedure :: numbers
      procedure :: word
      procedure :: choice
      procedure :: inner
      procedure :: elements
      procedure, private :: find
      procedure, private :: row_of
   end type parameter_view_t

contains

   !> View the whole case.
   subroutine all_of(self, description)
      class(parameter_view_t), intent(out) :: self
      type(description_t), target, intent(in) :: description

      self%rows => description%rows
      self%entries => description%entries
      self%first = 1
      do while (self%rows(self%first_row)%block /= self%block)
         self%first_row = self%first_row + 1
      end do
   end subroutine all_of

   !> Index of the entry of a key; 0 if it is not given.
   pure integer function find(self, key) result(i)
      class(parameter_view_t), intent(in) :: self
      character(len=*), intent(in) :: key

      do i = 1, size(self%entries)
         if (self%entries(i)%level /= self%level) cycle
         if (self%rows(self%entries(i)%row)%key(1:1) /= key(1:1)) cycle ! distinguishes most keys, at a much lower cost
         if (self%rows(self%entries(i)%row)%key == key) return
      end do
      i = 0
   end function find

   !> Index of the row of a key that is not given, in the block's variant; 0 if there is none.
   pure integer function row_of(self, key) result(i)
      class(parameter_view_t), intent(in) :: self
      character(len=*), intent(in) :: key

      if (self%first_row > 0) then
         do i = self%first_row, size(self%rows)
            if (self%rows(i)%block /= self%block) exit
            if (self%rows(i)%key(1:1) /= key(1:1)) cycle
            if (self%rows(i)%key /= key) cycle
            if (self%rows(i)%variants(1:1) == "" .or. self%rows(i)%variants(1:1) == "+") return
            if (index(" "//trim(self%rows(i)%variants)//" ", " "//trim(self%word(trim(self%rows(self%first_row)%key)))//" ") > 0) &
               return
         end do
      end if
      i = 0
   end function row_of

   !> Whether a key is given.
   pure logical function has(self, key)
      class(parameter_view_t), intent(in) :: self
      character(len=*), intent(in) :: key

      has = self%find(key) > 0
   end function has

   !> Number of a key in SI units, angles in radians; if it is not given its default, or NaN without one.
   pure real(wp) function number(self, key)
      class(parameter_view_t), intent(in) :: self
      character(len=*), intent(in) :: key
      character(len=short_length) :: unit

      call take_number(self, key, number, unit)
      if (unit == "deg") number = number*radians_per_degree
   end function number

   !> `number` in the unit of the row.
   pure real(wp) function in_unit(self, key) result(number)
      class(parameter_view_t), intent(in) :: self
      character(len=*), intent(in) :: key
      character(len=short_length) :: unit

      call take_number(self, key, number, unit)
   end function in_unit

   !> First number of a key, and its unit.
   pure subroutine take_number(self, key, number, unit)
      class(parameter_view_t), intent(in) :: self
      character(len=*), intent(in) :: key
      real(wp), intent(out) :: number !! NaN: there is none
      character(len=*), intent(out) :: unit
      real(wp), allocatable :: all(:)

      call take_numbers(self, key, all, unit)
      number = ieee_value(number, ieee_quiet_nan)
      if (size(all) > 0) number = all(1)
   end subroutine take_number

   !> Integer of a key; 0 if it is not given and has no default.
   pure integer function whole(self, key)
      class(parameter_view_t), intent(in) :: self
      character(len=*), intent(in) :: key
      real(wp) :: number

      number = self%in_unit(key)
      whole = 0
      if (.not. ieee_is_nan(number)) whole = nint(number)
   end function whole

   !> All numbers of a key in SI units, angles in radians; if it is not given those of its default, or none without one.
   pure function numbers(self, key) result(all)
      class(parameter_view_t), intent(in) :: self
      character(len=*), intent(in) :: key
      real(wp), allocatable :: all(:)
      character(len=short_length) :: unit

      call take_numbers(self, key, all, unit)
      if (unit == "deg") all(:) = all*radians_per_degree
   end function numbers

   !> All numbers of a key, and their unit.
   pure subroutine take_numbers(self, key, all, unit)
      class(parameter_view_t), intent(in) :: self
      character(len=*), intent(in) :: key
      real(wp), allocatable, intent(out) :: all(:)
      character(len=*), intent(out) :: unit
      integer :: i

      unit = ""
      i = self%find(key)
      if (i > 0) then
         unit = self%rows(self%entries(i)%row)%unit
         allocate (all, source=self%entries(i)%numbers)
         return
      end if
      i = self%row_of(key)
      if (i > 0) unit = self%rows(i)%unit
      if (i > 0) allocate (all, source=self%rows(i)%defaults(:self%rows(i)%n_defaults))
      if (i == 0) allocate (all(0))
   end subroutine take_numbers

   !> Word or text of a key; if it is not given its default, or "" without one.
   pure function word(self, key)
      class(parameter_view_t), intent(in) :: self
      character(len=*), intent(in) :: key
      character(len=text_length) :: word
      integer :: i

      word = ""
      i = self%find(key)
      if (i > 0) then
         word = self%entries(i)%name
         return
      end if
      if (self%first_row == 0) return
      do i = self%first_row, size(self%rows)
         if (self%rows(i)%block /= self%block) return
         if (self%rows(i)%key /= key) cycle
         word = self%rows(i)%default
         return
      end do
   end function word

   !> Index of the word of a key among the words of its row, from 0; -1 if it is none of them.
   pure integer function choice(self, key)
      class(parameter_view_t), intent(in) :: self
      character(len=*), intent(in) :: key
      character(len=text_length) :: word
      integer :: blank, i, last, n, start

      choice = -1
      word = self%word(key)
      i = self%row_of(key)
      if (i == 0 .or. word == "") return
      associate (words => self%rows(i)%words)
         last = len_trim(words)
         start = 1
         n = 0
         do while (start <= last)
            blank = index(words(start:last), " ")
            if (blank == 0) blank = last - start + 2
            if (words(start:start + blank - 2) == word) then
               choice = n
               return
            end if
            n = n + 1
            start = start + blank
         end do
      end associate
   end function choice

   !> Block of a key. If it is not given, it has no entries: all its keys have their defaults.
   subroutine inner(self, key, block)
      class(parameter_view_t), intent(in) :: self
      character(len=*), intent(in) :: key
      type(parameter_view_t), intent(out) :: block
      integer :: i

      i = self%find(key)
      if (i > 0) then
         call view(self, i, block)
      else
         block%rows => self%rows
         block%entries => self%entries(1:0)
         block%level = self%level + 1
         i = self%row_of(key)
         block%first_row = 0
         if (i == 0) return
         block%block = self%rows(i)%holds
         block%first_row = self%rows(i)%first_held
      end if
   end subroutine inner

   !> The elements of a list or map.
   subroutine elements(self, key, blocks)
      class(parameter_view_t), intent(in) :: self
      character(len=*), intent(in) :: key
      type(parameter_view_t), allocatable, intent(out) :: blocks(:)
      integer :: i, n

      n = 0
      do i = 1, size(self%entries)
         if (is_element(i)) n = n + 1
      end do
      allocate (blocks(n))
      n = 0
      do i = 1, size(self%entries)
         if (.not. is_element(i)) cycle
         n = n + 1
         call view(self, i, blocks(n))
      end do

   contains

      pure logical function is_element(i)
         integer, intent(in) :: i

         is_element = self%entries(i)%level == self%level
         if (is_element) is_element = self%rows(self%entries(i)%row)%key(1:1) == key(1:1) ! as in `find`
         if (is_element) is_element = self%rows(self%entries(i)%row)%key == key
      end function is_element

   end subroutine elements

   !> View the block whose own entry has the index `i_entry`.
   subroutine view(self, i_entry, block)
      class(parameter_view_t), intent(in) :: self
      integer, intent(in) :: i_entry
      type(parameter_view_t), intent(out) :: block
      integer :: last

      last = i_entry
      do while (last < size(self%entries))
         if (self%entries(last + 1)%level <= self%level) exit
         last = last + 1
      end do
      block%rows => self%rows
      block%entries => self%entries(i_entry + 1:last)
      block%level = self%level + 1
      block%block = self%rows(self%entries(i_entry)%row)%holds
      block%first_row = self%rows(self%entries(i_entry)%row)%first_held
      block%name = self%entries(i_entry)%name
      block%first = self%first + i_entry
   end subroutine view

end module evl_parameter_view
