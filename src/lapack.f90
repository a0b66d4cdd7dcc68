!> The one procedure of LAPACK that the kernel calls.
module evl_lapack
   implicit none (type, external)
   private

   public :: dgesv

   interface
      !> Solve a linear system of n equations for nrhs right-hand sides; the matrix is overwritten by its factors.
      subroutine dgesv(n, nrhs, a, lda, ipiv, b, ldb, info)
         use evl_kinds, only: wp
         implicit none (type, external)
         integer, intent(in) :: n, nrhs, lda, ldb
         real(wp), intent(inout) :: a(lda, *) !! matrix
         real(wp), intent(inout) :: b(ldb, *) !! right-hand sides, then solutions
         integer, intent(out) :: ipiv(*)      !! row exchanges
         integer, intent(out) :: info         !! 0 if solved, > 0 if the matrix is singular
      end subroutine dgesv
   end interface

end module evl_lapack
