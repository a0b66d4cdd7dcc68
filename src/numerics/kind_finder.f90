!> Finds one in a table of kinds, as of laws, loads or supports. A table offers each of its kinds to a finder and makes the one that
!> the finder meets, so that tables need no walk of their own.
module evl_kind_finder
   use evl_row, only: kind_t
   implicit none (type, external)
   private

   public :: described_t, kind_finder

   !> A kind, which describes itself.
   type, abstract :: described_t
   contains
      procedure(describe), deferred :: describe
   end type described_t

   !> Of one walk through a table.
   type :: kind_finder
      integer :: index = -1                    !! in the table, from 0, of the kind that is looked for; -1: of none
      integer :: n = 0                         !! kinds that were offered
      type(kind_t) :: found                    !! what the kind says of itself that was looked for
      type(kind_t), allocatable :: kinds(:)    !! room for what all say of themselves, if that is wanted
   contains
      procedure :: meets
   end type kind_finder

   abstract interface

      !> Name, text, source and rows of the kind; `info` comes empty.
      pure subroutine describe(self, info)
         import :: described_t, kind_t
         implicit none (type, external)
         class(described_t), intent(in) :: self
         type(kind_t), intent(inout) :: info
      end subroutine describe

   end interface

contains

   !> Whether the next kind of a table is the one that is looked for.
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
