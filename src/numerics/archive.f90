!> Serialisation of a state as 64-bit words, so that a computation can be resumed with bitwise identical results.
!>
!> One procedure per type lists its components once; the archive determines the direction of the transfer:
!>
!>     call serialize(archive, self%h)
!>     call serialize_reals(archive, size(self%y), self%y)
!>
!> Measuring, writing and reading share this procedure and therefore cannot diverge. Arrays have their allocated lengths: if a
!> length differs, the archive does not fit, and the data read from it are invalid.
module evl_archive
   use, intrinsic :: iso_c_binding, only: c_f_pointer, c_ptr
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: archive_t, archive_fits, serialize, serialize_complex, serialize_integers, serialize_logicals, serialize_raw, &
             serialize_reals
   public :: archive_measures, archive_writes, archive_reads

   integer, parameter :: archive_measures = 0 !! words are only counted
   integer, parameter :: archive_writes = 1   !! from the components to the words
   integer, parameter :: archive_reads = 2    !! from the words to the components

   integer, parameter :: bits_of_word = 64

   type :: archive_t
      integer :: direction = archive_measures
      integer(int64) :: n = 0                         !! words so far
      integer(int64), pointer :: words(:) => null()   !! buffer, if they are written or read
      logical, private :: is_good = .true.
   end type archive_t

   !> Serialise one number.
   interface serialize
      module procedure serialize_real, serialize_integer, serialize_logical
   end interface serialize

contains

   !> Whether the buffer was large enough and all array lengths matched.
   pure logical function archive_fits(self) result(fits)
      type(archive_t), intent(in) :: self

      fits = self%is_good
   end function archive_fits

   !> Count the next word. Return its index, or 0 if it is neither written nor read.
   pure subroutine next(self, i_word)
      type(archive_t), intent(inout) :: self
      integer(int64), intent(out) :: i_word

      i_word = 0
      self%n = self%n + 1
      if (self%direction == archive_measures .or. .not. self%is_good) return
      self%is_good = self%n <= size(self%words, kind=int64)
      if (self%is_good) i_word = self%n
   end subroutine next

   !> Serialise a real.
   pure subroutine serialize_real(self, value)
      type(archive_t), intent(inout) :: self
      real(wp), intent(inout) :: value
      integer(int64) :: i_word

      call next(self, i_word)
      if (i_word == 0) return
      if (self%direction == archive_writes) self%words(i_word) = transfer(value, i_word)
      if (self%direction == archive_reads) value = transfer(self%words(i_word), value)
   end subroutine serialize_real

   !> Serialise an integer.
   pure subroutine serialize_integer(self, value)
      type(archive_t), intent(inout) :: self
      integer, intent(inout) :: value
      integer(int64) :: i_word

      call next(self, i_word)
      if (i_word == 0) return
      if (self%direction == archive_writes) self%words(i_word) = value
      if (self%direction == archive_reads) value = int(self%words(i_word))
   end subroutine serialize_integer

   !> Serialise a logical.
   pure subroutine serialize_logical(self, value)
      type(archive_t), intent(inout) :: self
      logical, intent(inout) :: value
      integer :: number

      number = merge(1, 0, value)
      call serialize_integer(self, number)
      if (self%direction == archive_reads) value = number /= 0
   end subroutine serialize_logical

   !> Serialise the length of an array, which must match when it is read.
   pure subroutine serialize_length(self, n)
      type(archive_t), intent(inout) :: self
      integer, intent(in) :: n
      integer :: length

      length = n
      call serialize_integer(self, length)
      self%is_good = self%is_good .and. length == n
   end subroutine serialize_length

   !> Serialise reals, of an array of any rank.
   pure subroutine serialize_reals(self, n, values)
      type(archive_t), intent(inout) :: self
      integer, intent(in) :: n
      real(wp), intent(inout) :: values(*)
      integer :: i

      call serialize_length(self, n)
      do i = 1, n
         call serialize_real(self, values(i))
      end do
   end subroutine serialize_reals

   !> Serialise integers, of an array of any rank.
   pure subroutine serialize_integers(self, n, values)
      type(archive_t), intent(inout) :: self
      integer, intent(in) :: n
      integer, intent(inout) :: values(*)
      integer :: i

      call serialize_length(self, n)
      do i = 1, n
         call serialize_integer(self, values(i))
      end do
   end subroutine serialize_integers

   !> Serialise logicals, of an array of any rank.
   pure subroutine serialize_logicals(self, n, values)
      type(archive_t), intent(inout) :: self
      integer, intent(in) :: n
      logical, intent(inout) :: values(*)
      integer :: i

      call serialize_length(self, n)
      do i = 1, n
         call serialize_logical(self, values(i))
      end do
   end subroutine serialize_logicals

   !> Serialise complex numbers, of an array of any rank.
   pure subroutine serialize_complex(self, n, values)
      type(archive_t), intent(inout) :: self
      integer, intent(in) :: n
      complex(wp), intent(inout) :: values(*)
      real(wp) :: re, im
      integer :: i

      call serialize_length(self, n)
      do i = 1, n
         re = real(values(i), wp)
         im = aimag(values(i))
         call serialize_real(self, re)
         call serialize_real(self, im)
         if (self%direction == archive_reads) values(i) = cmplx(re, im, wp)
      end do
   end subroutine serialize_complex

   !> Serialise objects of a type with numeric components only, as they lie in memory: in whole words.
   subroutine serialize_raw(self, bits, things)
      type(archive_t), intent(inout) :: self
      integer(int64), intent(in) :: bits !! storage_size of one object, times their number
      type(c_ptr), intent(in) :: things  !! address of the first object
      integer(int64), pointer :: words(:)
      integer(int64) :: i, i_word

      self%is_good = self%is_good .and. mod(bits, int(bits_of_word, int64)) == 0
      call c_f_pointer(things, words, [bits/bits_of_word])
      do i = 1, bits/bits_of_word
         call next(self, i_word)
         if (i_word == 0) cycle
         if (self%direction == archive_writes) self%words(i_word) = words(i)
         if (self%direction == archive_reads) words(i) = self%words(i_word)
      end do
   end subroutine serialize_raw

end module evl_archive
