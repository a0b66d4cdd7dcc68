!> Validation of a description from outside: entries against the table of rows, and the location of errors.
module evl_description_check
   use evl_kinds, only: wp
   use evl_number_text, only: write_integer
   use evl_parameter_view, only: description_t, entry_t
   use evl_row, only: is_in_range, range_error, row_t, type_at_knots, type_block, type_choice, type_knots, type_list, type_map, &
                      type_named, type_size
   use evl_status, only: code_invalid_input, fail, field_length, has_failed, quantity, status_t, subject_housing, subject_initial, &
                         subject_mesh, subject_none, subject_wheel
   implicit none (type, external)
   private

   public :: check_changed_numbers, check_description, entry_path, path_length, path_of_status

   integer, parameter :: path_length = 191 !! length of a path; EVL_PATH_LENGTH without the NUL

   character(len=13), parameter :: counts(0:4) = &
                                   [character(13) :: "no number", "one number", "two numbers", "three numbers", "four numbers"]

   !> Blocks that are subjects of a status, indexed by the subject code.
   character(len=7), parameter :: blocks(*) = [character(7) :: "wheel", "mesh", "load", "initial", "housing", "shaft"]

contains

   !> Check that every entry matches its row and every block is complete.
   !> Errors: code_invalid_input with subject, index and field.
   subroutine check_description(description, status)
      type(description_t), intent(in) :: description
      type(status_t), intent(inout) :: status
      integer :: i

      associate (entries => description%entries, rows => description%rows)
         do i = 1, size(entries)
            if (has_failed(status)) return
            if (entries(i)%row < 1 .or. entries(i)%row > size(rows)) then
               call fail(status, code_invalid_input, "the table has no such row")
            else if (.not. stands_in_its_block(description, i)) then
               call refuse(description, i, "does not belong here", status)
            else
               call check_numbers(description, i, rows(entries(i)%row), status)
            end if
         end do
         ! from here on each word that selects a variant is one of the words of its row
         do i = 1, size(entries)
            if (has_failed(status)) return
            if (is_block(rows(entries(i)%row))) call check_block(description, i, status)
         end do
      end associate
   end subroutine check_description

   !> Check changed numbers of an entry of a checked description. Their count is unchanged; no other check depends on the values.
   !> Errors: as above.
   subroutine check_changed_numbers(description, i_entry, status)
      type(description_t), intent(in) :: description
      integer, intent(in) :: i_entry
      type(status_t), intent(inout) :: status

      call check_numbers(description, i_entry, description%rows(description%entries(i_entry)%row), status)
   end subroutine check_changed_numbers

   !> Whether entries of this row are followed by the entries of a block.
   elemental logical function is_block(row)
      type(row_t), intent(in) :: row

      is_block = row%type == type_block .or. row%type == type_list .or. row%type == type_map
   end function is_block

   !> Index of the entry whose block contains an entry; 0: a key of the case.
   pure integer function parent_of(entries, i_entry) result(i)
      type(entry_t), intent(in) :: entries(:)
      integer, intent(in) :: i_entry

      i = 0
      if (entries(i_entry)%level <= 1) return
      do i = i_entry - 1, 1, -1
         if (entries(i)%level < entries(i_entry)%level) return
      end do
   end function parent_of

   !> Whether the row of an entry belongs to the block that contains it.
   pure logical function stands_in_its_block(description, i_entry) result(good)
      type(description_t), intent(in) :: description
      integer, intent(in) :: i_entry
      integer :: above

      above = parent_of(description%entries, i_entry)
      associate (entry => description%entries(i_entry), rows => description%rows)
         if (above == 0) then
            good = entry%level == 1 .and. rows(entry%row)%block == "case"
         else
            good = entry%level == description%entries(above)%level + 1 .and. &
                   rows(entry%row)%block == rows(description%entries(above)%row)%holds
         end if
      end associate
   end function stands_in_its_block

   !> Check that an entry has the right count of numbers, all in range, or one of the words of its row.
   subroutine check_numbers(description, i_entry, row, status)
      type(description_t), intent(in) :: description
      integer, intent(in) :: i_entry
      type(row_t), intent(in) :: row
      type(status_t), intent(inout) :: status
      integer :: i

      associate (entry => description%entries(i_entry))
         if (row%words /= "" .and. entry%name /= "") then
            if (index(" "//trim(row%words)//" ", " "//entry%name//" ") == 0) &
               call refuse(description, i_entry, "must be one of "//trim(row%words)//", not "//entry%name, status)
            return
         end if
         if (row%type == type_choice) call refuse(description, i_entry, "must be one of "//trim(row%words), status)
         if (type_size(row%type) >= 0 .and. size(entry%numbers) /= type_size(row%type)) then
            call refuse(description, i_entry, trim(row%key)//" needs "//counts(type_size(row%type)), status)
            return
         end if
         do i = 1, size(entry%numbers)
            if (is_in_range(row, entry%numbers(i)) .or. has_failed(status)) cycle
            call refuse(description, i_entry, trim(range_error(row, entry%numbers(i))), status)
         end do
         if (has_failed(status)) return
         if (row%type == type_knots) call check_knots(description, i_entry, entry%numbers, status)
         if (row%type == type_at_knots) call check_at_knots(description, i_entry, status)
      end associate
   end subroutine check_numbers

   !> Check that the knots of a table are strictly increasing.
   subroutine check_knots(description, i_entry, knots, status)
      type(description_t), intent(in) :: description
      integer, intent(in) :: i_entry
      real(wp), intent(in) :: knots(:) !! in the unit of the row
      type(status_t), intent(inout) :: status
      integer :: i

      if (size(knots) < 2) call refuse(description, i_entry, "a table needs at least two knots", status)
      associate (row => description%rows(description%entries(i_entry)%row))
         do i = 2, size(knots)
            if (knots(i) > knots(i - 1) .or. has_failed(status)) cycle
            call refuse(description, i_entry, "the knots of a table must increase, but "//quantity(knots(i), trim(row%unit)) &
                        //" follows "//quantity(knots(i - 1), trim(row%unit)), status)
         end do
      end associate
   end subroutine check_knots

   !> Check that a table has as many values as its block has knots.
   subroutine check_at_knots(description, i_entry, status)
      type(description_t), intent(in) :: description
      integer, intent(in) :: i_entry
      type(status_t), intent(inout) :: status
      integer :: i, n

      n = -1
      associate (entries => description%entries, above => parent_of(description%entries, i_entry))
         do i = above + 1, size(entries)
            if (entries(i)%level <= entries(i_entry)%level - 1) exit
            if (description%rows(entries(i)%row)%type == type_knots) n = size(entries(i)%numbers)
         end do
         if (n >= 0 .and. n /= size(entries(i_entry)%numbers)) &
            call refuse(description, i_entry, "a table needs as many values as knots", status)
      end associate
   end subroutine check_at_knots

   !> Check that a block has all required keys of its variant and no keys of another variant.
   subroutine check_block(description, i_entry, status)
      type(description_t), intent(in) :: description
      integer, intent(in) :: i_entry
      type(status_t), intent(inout) :: status
      integer :: row, key_entry, first, last

      associate (rows => description%rows)
         call find_rows(rows, rows(description%entries(i_entry)%row)%holds, first, last)
         do row = first, last
            if (has_failed(status)) return
            key_entry = entry_of(description, i_entry, rows(row)%key)
            if (.not. in_variant(description, i_entry, rows(row), rows(first))) then
               if (key_entry == 0) cycle
               if (description%entries(key_entry)%row /= row) cycle
               if (rows(row)%variants(1:1) == "+") then
                  call refuse(description, key_entry, "'"//trim(rows(row)%key)//"' needs '"//trim(rows(row)%variants(2:)) &
                              //"' in the same block", status)
               else if (rows(row)%variants(1:1) == "-") then
                  call refuse(description, key_entry, "'"//trim(rows(row)%key)//"' conflicts with '"//trim(rows(row)%variants(2:)) &
                              //"'; give one of them", status)
               else
                  call refuse(description, key_entry, "'"//trim(rows(row)%key)//"' has no meaning here", status)
               end if
            else if (rows(row)%required .and. key_entry == 0) then
               call refuse(description, i_entry, "'"//trim(rows(row)%key)//"' is missing", status, key=trim(rows(row)%key))
            end if
         end do
      end associate
   end subroutine check_block

   !> First and last row of a block; rows of a block are contiguous. None: first > last.
   pure subroutine find_rows(rows, block, first, last)
      type(row_t), intent(in) :: rows(:)
      character(len=*), intent(in) :: block
      integer, intent(out) :: first, last

      do first = 1, size(rows)
         if (rows(first)%block == block) exit
      end do
      do last = first, size(rows) - 1
         if (rows(last + 1)%block /= block) return
      end do
      last = min(last, size(rows))
   end subroutine find_rows

   !> Index of the entry of a key in the block of an entry; 0 if absent.
   pure integer function entry_of(description, i_entry, key) result(i)
      type(description_t), intent(in) :: description
      integer, intent(in) :: i_entry
      character(len=*), intent(in) :: key

      associate (entries => description%entries)
         do i = i_entry + 1, size(entries)
            if (entries(i)%level <= entries(i_entry)%level) exit
            if (entries(i)%level /= entries(i_entry)%level + 1) cycle
            if (entries(i)%row < 1 .or. entries(i)%row > size(description%rows)) cycle
            if (description%rows(entries(i)%row)%key == key) return
         end do
      end associate
      i = 0
   end function entry_of

   !> Whether a row is allowed for the variant of a block, or with its other keys ("+KEY", "-KEY").
   pure logical function in_variant(description, i_entry, row, selector)
      type(description_t), intent(in) :: description
      integer, intent(in) :: i_entry
      type(row_t), intent(in) :: row, selector !! selector: first row of the block, which selects the variant
      integer :: key_entry

      in_variant = .true.
      if (row%variants == "") return
      if (row%variants(1:1) == "+") then
         in_variant = entry_of(description, i_entry, trim(row%variants(2:))) > 0
         return
      else if (row%variants(1:1) == "-") then
         in_variant = entry_of(description, i_entry, trim(row%variants(2:))) == 0
         return
      end if
      key_entry = entry_of(description, i_entry, selector%key)
      if (key_entry > 0) then
         in_variant = index(" "//trim(row%variants)//" ", " "//description%entries(key_entry)%name//" ") > 0
      else
         in_variant = index(" "//trim(row%variants)//" ", " "//trim(selector%default)//" ") > 0
      end if
   end function in_variant

   !> Report an invalid entry, or a key missing in its block.
   subroutine refuse(description, i_entry, message, status, key)
      type(description_t), intent(in) :: description
      integer, intent(in) :: i_entry
      character(len=*), intent(in) :: message
      type(status_t), intent(inout) :: status
      character(len=*), intent(in), optional :: key
      integer :: subject, index
      character(len=field_length) :: field

      if (has_failed(status)) return
      call find_subject(description, i_entry, subject, index, field)
      if (present(key)) field = trim(field)//trim(merge(".", " ", field /= ""))//key
      call fail(status, code_invalid_input, message, subject, index, trim(field))
   end subroutine refuse

   !> Subject of an entry: its type, its number, and the field within it.
   subroutine find_subject(description, i_entry, subject, number, field)
      type(description_t), intent(in) :: description
      integer, intent(in) :: i_entry
      integer, intent(out) :: subject
      integer, intent(out) :: number !! from 1; 0 if there is only one such subject
      character(len=*), intent(out) :: field
      integer :: i, chain(32), n, held
      character(len=path_length) :: path, above

      n = 0
      i = i_entry
      do while (i > 0)
         n = n + 1
         chain(n) = i
         i = parent_of(description%entries, i)
      end do
      chain(:n) = chain(n:1:-1)
      subject = subject_none
      held = 0
      associate (entries => description%entries, rows => description%rows)
         do i = 1, min(n, 2)
            number = findloc(blocks == rows(entries(chain(i))%row)%holds, .true., dim=1)
            if (number == 0) cycle
            subject = number
            held = i
         end do
         number = 0
         if (subject /= subject_none .and. subject /= subject_housing .and. subject /= subject_initial) &
            number = count([(entries(i)%row == entries(chain(held))%row, i=1, chain(held))])
      end associate
      call entry_path(description, i_entry, path)
      call entry_path(description, chain(max(held, 1)), above)
      field = path
      if (held > 0) field = path(len_trim(above) + 2:)
   end subroutine find_subject

   !> Path of an entry as in --set: keys, and names or numbers of elements.
   recursive subroutine entry_path(description, i_entry, path)
      type(description_t), intent(in) :: description
      integer, intent(in) :: i_entry
      character(len=*), intent(out) :: path
      character(len=12) :: number
      integer :: above, i

      path = ""
      if (i_entry == 0) return
      above = parent_of(description%entries, i_entry)
      call entry_path(description, above, path)
      associate (entry => description%entries(i_entry), row => description%rows(description%entries(i_entry)%row))
         if (path /= "") path = trim(path)//"."
         path = trim(path)//row%key
         if (row%type /= type_list .and. row%type /= type_map .and. row%type /= type_named) return
         if (entry%name /= "") then
            path = trim(path)//"."//entry%name
         else
            call write_integer(count([(description%entries(i)%row == entry%row, i=above + 1, i_entry - 1)]), number)
            path = trim(path)//"."//number
         end if
      end associate
   end subroutine entry_path

   !> Path of the subject of a status; "" if it has none.
   subroutine path_of_status(description, status, path)
      type(description_t), intent(in) :: description
      type(status_t), intent(in) :: status
      character(len=*), intent(out) :: path
      integer :: i, n

      path = ""
      associate (subject => status%subject, field => status%field, entries => description%entries)
         if (any(field == ["speeds", "gaps  "]) .and. status%index > 0 .and. any(subject == [subject_wheel, subject_mesh])) then
            path = "simulation.initial."//field
         else if (subject == subject_initial) then
            path = "simulation.initial"
         else if (subject == subject_housing) then
            path = "housing"
         end if
         if (status%index > 0 .and. all(subject /= [subject_none, subject_initial, subject_housing])) then
            n = 0
            do i = 1, size(entries)
               if (description%rows(entries(i)%row)%holds == blocks(subject)) n = n + 1
               if (n == status%index) exit
            end do
            if (i > size(entries)) return
            if (path /= "") then
               path = trim(path)//"."//entries(i)%name
               return
            end if
            call entry_path(description, i, path)
         end if
         if (field /= "") path = trim(path)//trim(merge(".", " ", path /= ""))//field
      end associate
   end subroutine path_of_status

end module evl_description_check
