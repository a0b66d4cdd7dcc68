!> Serialisation of the factors of the stage systems. The elimination plan is recomputed from the pattern at creation.
module evl_factor_archive
   use evl_archive, only: archive_reads, archive_t, serialize, serialize_complex, serialize_integers, serialize_reals
   use evl_condensed_systems, only: condensed_t
   use evl_dense_lu, only: dense_lu_t
   use evl_radau_coefficients, only: n_systems
   use evl_sparse_lu, only: sparse_lu_t
   implicit none (type, external)
   private

   public :: serialize_condensed, serialize_dense

contains

   !> Condensed systems with their inverses or factors.
   subroutine serialize_condensed(archive, self)
      type(archive_t), intent(inout) :: archive
      type(condensed_t), intent(inout) :: self

      call serialize_reals(archive, size(self%inner), self%inner)
      call serialize_reals(archive, size(self%product), self%product)
      call serialize_reals(archive, size(self%coupling), self%coupling)
      call serialize_reals(archive, size(self%rate), self%rate)
      call serialize_reals(archive, size(self%inverse_shift), self%inverse_shift)
      call serialize_reals(archive, size(self%x), self%x)
      call serialize_reals(archive, size(self%b_first), self%b_first)
      call serialize_reals(archive, size(self%x_first), self%x_first)
      if (self%is_inverted) then
         call serialize_reals(archive, size(self%inverse), self%inverse)
         call serialize_reals(archive, size(self%first), self%first)
      else
         call serialize_sparse(archive, self%factors)
      end if
   end subroutine serialize_condensed

   !> Sparse factors.
   subroutine serialize_sparse(archive, self)
      type(archive_t), intent(inout) :: archive
      type(sparse_lu_t), intent(inout) :: self

      call serialize_reals(archive, size(self%value), self%value)
      call serialize_reals(archive, size(self%first), self%first)
   end subroutine serialize_sparse

   !> Full factors, stored only if allocated.
   subroutine serialize_dense(archive, self)
      type(archive_t), intent(inout) :: archive
      type(dense_lu_t), intent(inout) :: self
      logical :: is_there

      call serialize_integers(archive, size(self%exchange), self%exchange)
      call serialize_complex(archive, size(self%x), self%x)
      is_there = allocated(self%a)
      call serialize(archive, is_there)
      if (.not. is_there) return
      if (archive%direction == archive_reads .and. .not. allocated(self%a)) allocate (self%a(self%n, self%n, n_systems))
      call serialize_complex(archive, size(self%a), self%a)
   end subroutine serialize_dense

end module evl_factor_archive
