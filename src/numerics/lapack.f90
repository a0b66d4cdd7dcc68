!> The procedures of LAPACK that the kernel calls.
module evl_lapack
   implicit none (type, external)
   private

   public :: dgeevx, dgesv, dgesvd

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

      !> Eigenvalues and eigenvectors of a general matrix, with condition numbers; the matrix is destroyed.
      subroutine dgeevx(balanc, jobvl, jobvr, sense, n, a, lda, wr, wi, vl, ldvl, vr, ldvr, ilo, ihi, scale, abnrm, rconde, &
                        rcondv, work, lwork, iwork, info)
         use evl_kinds, only: wp
         implicit none (type, external)
         character(len=1), intent(in) :: balanc, jobvl, jobvr !! "B": permute and scale; "V": left, right vectors
         character(len=1), intent(in) :: sense                !! "E": rconde is computed, rcondv and iwork are not used
         integer, intent(in) :: n, lda, ldvl, ldvr, lwork     !! lwork >= 3n
         real(wp), intent(inout) :: a(lda, *)                 !! matrix
         real(wp), intent(out) :: wr(*), wi(*)                !! eigenvalues; pairs are adjacent, wi > 0 first
         real(wp), intent(out) :: vl(ldvl, *), vr(ldvr, *)    !! columns; for a pair, the real and the imaginary part
         integer, intent(out) :: ilo, ihi, iwork(*)
         real(wp), intent(out) :: scale(*)                    !! scaling factors of the balancing
         real(wp), intent(out) :: abnrm                       !! 1-norm of the balanced matrix
         real(wp), intent(out) :: rconde(*), rcondv(*)        !! reciprocal condition numbers of values, of vectors
         real(wp), intent(out) :: work(*)
         integer, intent(out) :: info                         !! 0 if all were found
      end subroutine dgeevx

      !> Singular values of an m x n matrix; the matrix is destroyed.
      subroutine dgesvd(jobu, jobvt, m, n, a, lda, s, u, ldu, vt, ldvt, work, lwork, info)
         use evl_kinds, only: wp
         implicit none (type, external)
         character(len=1), intent(in) :: jobu, jobvt          !! "N": no vectors, u and vt are not used
         integer, intent(in) :: m, n, lda, ldu, ldvt, lwork   !! lwork >= max(3 min(m, n) + max(m, n), 5 min(m, n))
         real(wp), intent(inout) :: a(lda, *)                 !! matrix
         real(wp), intent(out) :: s(*)                        !! singular values, descending
         real(wp), intent(out) :: u(ldu, *), vt(ldvt, *), work(*)
         integer, intent(out) :: info                         !! 0 if all were found
      end subroutine dgesvd
   end interface

end module evl_lapack
