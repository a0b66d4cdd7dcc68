!> Serialization of the model of an integration in progress.
submodule(evl_gearbox_ode) evl_gearbox_ode_archive
   use, intrinsic :: iso_c_binding, only: c_loc
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_archive, only: serialize_integers, serialize_raw, serialize_reals
   implicit none (type, external)

contains

   !> Slots contain no pointers or allocatables, so their memory is copied as it is.
   module procedure serialize_gearbox_ode
      call serialize_integers(archive, size(self%integers), self%integers)
      call serialize_reals(archive, size(self%reals), self%reals)
      if (size(self%slots) == 0) return
      call serialize_raw(archive, storage_size(self%slots, int64)*size(self%slots), c_loc(self%slots))
      call serialize_raw(archive, storage_size(self%aside, int64)*size(self%aside), c_loc(self%aside))
   end procedure serialize_gearbox_ode

end submodule evl_gearbox_ode_archive
