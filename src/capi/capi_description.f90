!> C interface of descriptions: the table of rows, and cases as lists of entries. Indices are 0-based in C, 1-based here.
module evl_capi_description
   use, intrinsic :: ieee_arithmetic, only: ieee_negative_inf, ieee_positive_inf, ieee_value
   use, intrinsic :: iso_c_binding, only: c_associated, c_bool, c_char, c_double, c_f_pointer, c_int, c_loc, &
                                                                             c_null_char, c_null_ptr, c_ptr
   use evl_capi_types, only: c_status, return_code, status_from_c, status_to_c, take_text, to_c
   use evl_case_table, only: case_table, kinds_of
   use evl_description_check, only: check_changed_numbers, check_description, entry_path, path_length, path_of_status
   use evl_gearbox, only: gearbox_t
   use evl_gearbox_initial, only: initial_t
   use evl_parameter_view, only: description_t, entry_t
   use evl_row, only: kind_t, row_t, short_length, text_length
   use evl_status, only: has_failed, status_t
   implicit none (type, external)
   private

   public :: c_initial, initial_from_c
   public :: evl_description_create, evl_description_delete, evl_description_parameter
   public :: evl_description_path, evl_description_renew, evl_description_set, evl_kinds, evl_rows

   !> evl_row
   type, bind(c) :: c_row
      character(kind=c_char), dimension(short_length + 1) :: block, key
      integer(c_int) :: type
      character(kind=c_char) :: unit(short_length + 1), text(text_length + 1)
      real(c_double) :: minimum, maximum, plausible_least, plausible_most
      logical(c_bool) :: minimum_open, maximum_open, required
      character(kind=c_char) :: default_text(2*short_length + 2), words(text_length + 1), holds(short_length + 1), &
                                variants(text_length + 1)
   end type c_row

   !> evl_kind
   type, bind(c) :: c_kind
      character(kind=c_char) :: name(short_length + 1), text(text_length + 1), source(text_length + 1)
   end type c_kind

   !> evl_entry
   type, bind(c) :: c_entry
      integer(c_int) :: row, level
      type(c_ptr) :: name
      integer(c_int) :: n
      type(c_ptr) :: numbers
   end type c_entry

   !> evl_parameter
   type, bind(c) :: c_parameter
      character(kind=c_char) :: path(path_length + 1), unit(short_length + 1)
      integer(c_int) :: row, n
   end type c_parameter

   !> evl_initial
   type, bind(c) :: c_initial
      integer(c_int) :: kind
      type(c_ptr) :: speeds, gaps
      real(c_double) :: mesh_position
   end type c_initial

contains

   integer(c_int) function evl_rows(most, rows) result(n) bind(c)
      integer(c_int), intent(in), value :: most
      type(c_row), intent(out) :: rows(most)
      type(row_t), allocatable :: all(:)
      integer :: i

      call case_table(all)
      n = size(all)
      do i = 1, min(n, most)
         associate (from => all(i), to => rows(i))
            call to_c(from%block, to%block)
            call to_c(from%key, to%key)
            to%type = from%type
            call to_c(from%unit, to%unit)
            call to_c(from%text, to%text)
            to%minimum = merge(from%range%minimum, ieee_value(1.0_c_double, ieee_negative_inf), &
                               from%range%minimum > -huge(1.0_c_double))
            to%maximum = merge(from%range%maximum, ieee_value(1.0_c_double, ieee_positive_inf), &
                               from%range%maximum < huge(1.0_c_double))
            to%plausible_least = from%plausible%least
            to%plausible_most = from%plausible%most
            to%minimum_open = logical(from%range%minimum_open, c_bool)
            to%maximum_open = logical(from%range%maximum_open, c_bool)
            to%required = logical(from%required, c_bool)
            call to_c(from%default, to%default_text)
            call to_c(from%words, to%words)
            call to_c(from%holds, to%holds)
            call to_c(from%variants, to%variants)
         end associate
      end do
   end function evl_rows

   integer(c_int) function evl_kinds(block, most, kinds) result(n) bind(c)
      character(kind=c_char), intent(in) :: block(short_length + 1)
      integer(c_int), intent(in), value :: most
      type(c_kind), intent(out) :: kinds(most)
      type(kind_t), allocatable :: all(:)
      character(len=:), allocatable :: name
      integer :: i

      call take_text(block, name)
      call kinds_of(name, all)
      n = size(all)
      do i = 1, min(n, most)
         call to_c(all(i)%name, kinds(i)%name)
         call to_c(all(i)%text, kinds(i)%text)
         call to_c(all(i)%source, kinds(i)%source)
      end do
   end function evl_kinds

   type(c_ptr) function evl_description_create(n, entries, status) result(handle) bind(c)
      integer(c_int), intent(in), value :: n
      type(c_entry), intent(in) :: entries(n)
      type(c_status), intent(out), optional :: status
      type(description_t), pointer :: description
      type(status_t) :: s
      integer :: i

      handle = c_null_ptr
      allocate (description)
      call case_table(description%rows)
      allocate (description%entries(n))
      do i = 1, n
         call entry_from_c(entries(i), description%entries(i))
      end do
      call check_description(description, s)
      if (has_failed(s)) then
         deallocate (description)
      else
         handle = c_loc(description)
      end if
      if (present(status)) call status_to_c(s, status)
   end function evl_description_create

   !> Fortran entry with copies of the name and numbers of a C entry.
   subroutine entry_from_c(c, entry)
      type(c_entry), intent(in) :: c
      type(entry_t), intent(out) :: entry
      character(kind=c_char), pointer :: name(:)

      entry%row = c%row + 1
      entry%level = c%level
      entry%numbers = array_from_c(c%numbers, c%n)
      entry%name = ""
      if (.not. c_associated(c%name)) return
      call c_f_pointer(c%name, name, [huge(c%n)])
      call take_text(name, entry%name)
   end subroutine entry_from_c

   logical(c_bool) function evl_description_renew(handle, n, entries) result(good) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: n
      type(c_entry), intent(in) :: entries(n)
      type(description_t), pointer :: description
      type(status_t) :: s
      integer :: i

      call c_f_pointer(handle, description)
      good = logical(n == size(description%entries), c_bool)
      do i = 1, n
         if (good) good = logical(same_but_for_numbers(entries(i), description%entries(i)), c_bool)
         if (.not. good) return
         call exchange_numbers(description, i, entries(i), s)
         good = logical(.not. has_failed(s), c_bool)
      end do
   end function evl_description_renew

   !> Whether two entries are identical except for their numbers.
   logical function same_but_for_numbers(c, entry) result(good)
      type(c_entry), intent(in) :: c
      type(entry_t), intent(in) :: entry
      character(kind=c_char), pointer :: name(:)
      integer :: i

      good = c%row + 1 == entry%row .and. c%level == entry%level .and. merge(c%n, 0, c_associated(c%numbers)) == size(entry%numbers)
      if (.not. good) return
      if (.not. c_associated(c%name)) then
         good = entry%name == ""
         return
      end if
      call c_f_pointer(c%name, name, [len(entry%name) + 1])
      do i = 1, len(entry%name)
         good = name(i) == entry%name(i:i)
         if (.not. good) return
      end do
      good = name(len(entry%name) + 1) == c_null_char
   end function same_but_for_numbers

   !> Replace the numbers of an entry; changed numbers are checked.
   subroutine exchange_numbers(description, i_entry, c, status)
      type(description_t), intent(inout) :: description
      integer, intent(in) :: i_entry
      type(c_entry), intent(in) :: c
      type(status_t), intent(inout) :: status
      real(c_double), pointer :: numbers(:)
      logical :: is_changed

      associate (to => description%entries(i_entry)%numbers)
         if (size(to) == 0) return
         call c_f_pointer(c%numbers, numbers, [size(to)])
         is_changed = .not. all(to >= numbers .and. to <= numbers)
         to(:) = numbers
      end associate
      if (is_changed) call check_changed_numbers(description, i_entry, status)
   end subroutine exchange_numbers

   subroutine evl_description_delete(handle) bind(c)
      type(description_t), pointer :: self
      include "capi/delete_of_handle.inc"
   end subroutine evl_description_delete

   !> Index of the entry of a parameter: an entry with numbers. 0 if there is none.
   pure integer function entry_of_parameter(description, index) result(i)
      type(description_t), intent(in) :: description
      integer, intent(in) :: index !! from 0
      integer :: n

      n = -1
      do i = 1, size(description%entries)
         if (size(description%entries(i)%numbers) > 0) n = n + 1
         if (n == index) return
      end do
      i = 0
   end function entry_of_parameter

   logical(c_bool) function evl_description_parameter(handle, index, parameter, most, numbers) result(is_one) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: index, most
      type(c_parameter), intent(out) :: parameter
      real(c_double), intent(inout) :: numbers(most)
      type(description_t), pointer :: d
      character(len=path_length) :: path
      integer :: i, n

      call c_f_pointer(handle, d)
      i = entry_of_parameter(d, index)
      is_one = logical(i > 0, c_bool)
      if (i == 0) return
      call entry_path(d, i, path)
      associate (entry => d%entries(i))
         call to_c(path, parameter%path)
         call to_c(d%rows(entry%row)%unit, parameter%unit)
         parameter%row = entry%row - 1
         parameter%n = size(entry%numbers)
         n = min(size(entry%numbers), most)
         numbers(:n) = entry%numbers(:n)
      end associate
   end function evl_description_parameter

   integer(c_int) function evl_description_set(handle, index, numbers, status) result(code) bind(c)
      type(c_ptr), intent(in), value :: handle
      integer(c_int), intent(in), value :: index
      real(c_double), intent(in) :: numbers(*)
      type(c_status), intent(inout), optional :: status
      type(description_t), pointer :: d
      type(status_t) :: s
      real(c_double), allocatable :: before(:)
      integer :: i_entry

      call c_f_pointer(handle, d)
      i_entry = entry_of_parameter(d, index)
      associate (to => d%entries(i_entry)%numbers)
         allocate (before, source=to)
         to(:) = numbers(:size(to))
         call check_changed_numbers(d, i_entry, s)
         if (has_failed(s)) to(:) = before
      end associate
      code = return_code(s, status)
   end function evl_description_set

   subroutine evl_description_path(handle, status, path) bind(c)
      type(c_ptr), intent(in), value :: handle
      type(c_status), intent(in) :: status
      character(kind=c_char), intent(out) :: path(path_length + 1)
      type(description_t), pointer :: d
      character(len=path_length) :: text

      call c_f_pointer(handle, d)
      call path_of_status(d, status_from_c(status), text)
      call to_c(text, path)
   end subroutine evl_description_path

   type(initial_t) function initial_from_c(c, gearbox) result(initial)
      type(c_initial), intent(in) :: c
      type(gearbox_t), intent(in) :: gearbox

      initial%kind = c%kind
      initial%mesh_position = c%mesh_position
      allocate (initial%speeds, source=array_from_c(c%speeds, size(gearbox%wheels)))
      allocate (initial%gaps, source=array_from_c(c%gaps, size(gearbox%pairs)))
   end function initial_from_c

   !> Copy of a C array; size 0 for NULL.
   function array_from_c(pointer, n) result(array)
      type(c_ptr), intent(in) :: pointer
      integer, intent(in) :: n
      real(c_double), allocatable :: array(:)
      real(c_double), pointer :: view(:)

      allocate (array(merge(n, 0, c_associated(pointer))))
      if (.not. c_associated(pointer)) return
      call c_f_pointer(pointer, view, [n])
      array(:) = view
   end function array_from_c

end module evl_capi_description
