!> Serialisation of the factors of the stage systems. The elimination plan is recomputed from the pattern at creation.
module evl_factor_archive
   use evl_archive, only: archive_reads, archive_t, keep, keep_complex, keep_integers, keep_reals
   use evl_condensed_systems, only: condensed_t
   use evl_dense_lu, only: dense_lu_t
   use evl_radau_coefficients, only: n_systems
   use evl_sparse_lu, only: sparse_lu_t
   implicit none (type, external)
   private

   public :: keep_condensed, keep_dense

contains

   !> Condensed systems with their inverses or factors.
   subroutine keep_condensed(archive, self)
      type(archive_t), intent(inout) :: archive
      type(condensed_t), intent(inout) :: self

      call keep_reals(archive, size(self%inner), self%inner)
      call keep_reals(archive, size(self%product), self%product)
      call keep_reals(archive, size(self%coupling), self%coupling)
      call keep_reals(archive, size(self%rate), self%rate)
      call keep_reals(archive, size(self%inverse_shift), self%inverse_shift)
      call keep_reals(archive, size(self%x), self%x)
      call keep_reals(archive, size(self%b_first), self%b_first)
      call keep_reals(archive, size(self%x_first), self%x_first)
      if (self%is_inverted) then
         call keep_reals(archive, size(self%inverse), self%inverse)
         call keep_reals(archive, size(self%first), self%first)
      else
         call keep_sparse(archive, self%factors)
      end if
   end subroutine keep_condensed

   !> Sparse factors.
   subroutine keep_sparse(archive, self)
      type(archive_t), intent(inout) :: archive
      type(sparse_lu_t), intent(inout) :: self

      call keep_reals(archive, size(self%value), self%value)
      call keep_reals(archive, size(self%first), self%first)
   end subroutine keep_sparse

   !> Full factors, stored only if allocated.
   subroutine keep_dense(archive, self)
      type(archive_t), intent(inout) :: archive
      type(dense_lu_t), intent(inout) :: self
      logical :: is_there

      call keep_integers(archive, size(self%exchange), self%exchange)
      call keep_complex(archive, size(self%x), self%x)
      is_there = allocated(self%a)
      call keep(archive, is_there)
      if (.not. is_there) return
      if (archive%direction == archive_reads .and. .not. allocated(self%a)) allocate (self%a(self%n, self%n, n_systems))
      call keep_complex(archive, size(self%a), self%a)
   end subroutine keep_dense

end module evl_factor_archive
