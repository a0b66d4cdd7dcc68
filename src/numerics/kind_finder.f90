!> Search in a table of kinds, such as laws, loads or supports. A table offers each of its kinds to a finder and creates the
!> one that the finder accepts, so that tables need no loop of their own.
module evl_kind_finder
   use evl_row, only: kind_t
   implicit none (type, external)
   private

   public :: described_t, kind_finder

   !> A kind that describes itself.
   type, abstract :: described_t
   contains
      procedure(describe), deferred :: describe
   end type described_t

   !> State of one pass through a table.
   type :: kind_finder
      integer :: index = -1                    !! index in the table, from 0, of the requested kind; -1: none
      integer :: n = 0                         !! number of kinds offered
      type(kind_t) :: found                    !! description of the requested kind
      type(kind_t), allocatable :: kinds(:)    !! buffer for the descriptions of all kinds, if requested
   contains
      procedure :: meets
   end type kind_finder

   abstract interface

      !> Set name, text, source and rows of the kind; `info` is empty on entry.
      pure subroutine describe(self, info)
         import :: described_t, kind_t
         implicit none (type, external)
         class(described_t), intent(in) :: self
         type(kind_t), intent(inout) :: info
      end subroutine describe

   end interface

contains

   !> Whether the next kind of a table is the requested one.
   logical function meets(self, entry)
      class(kind_finder), intent(inout) :: self
      class(described_t), intent(in) :: entry
      type(kind_t) :: info

      meets = self%n == self%index
      self%n = self%n + 1
      if (.not. (meets .or. allocated(self%kinds))) return
      call entry%describe(info)
      if (.not. allocated(info%rows)) allocate (info%rows(0))
      if (allocated(self%kinds)) self%kinds(self%n) = info
      if (meets) self%found = info
   end function meets

end module evl_kind_finder
