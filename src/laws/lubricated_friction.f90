!> Friction laws that need the lubricant and the roughness of a mesh.
module evl_lubricated_friction
   use evl_friction_law, only: friction_law_t
   use evl_kinds, only: wp
   use evl_row, only: short_length
   implicit none (type, external)
   private

   public :: lubricated_friction_t, mesh_lubricant

   !> Lubricant and flanks of a mesh; NaN: not given.
   type :: mesh_lubricant
      real(wp) :: viscosity = 0.0_wp !! dynamic, at the oil temperature [Pa s]
      real(wp) :: roughness = 0.0_wp !! Ra, mean of both flanks [m]
   end type mesh_lubricant

   type, abstract, extends(friction_law_t) :: lubricated_friction_t
      type(mesh_lubricant) :: lubricant
   contains
      procedure, nopass :: uses_roughness
      procedure, non_overridable :: missing
      procedure :: acts
      procedure :: evaluate
   end type lubricated_friction_t

contains

   !> Key of the lubricant that is required but not given; "" if there is none.
   pure function missing(self) result(key)
      class(lubricated_friction_t), intent(in) :: self
      character(len=short_length) :: key

      key = ""
      if (self%uses_roughness() .and. .not. self%lubricant%roughness > 0) key = "roughness"
      if (.not. self%lubricant%viscosity > 0) key = "viscosity"
   end function missing

   !> Whether the law depends on the roughness.
   pure logical function uses_roughness()
      uses_roughness = .true.
   end function uses_roughness

   !> The coefficient is positive at every operating point; the first parameter is no factor of it.
   pure logical function acts(self)
      class(lubricated_friction_t), intent(in) :: self

      acts = .true.
   end function acts

   !> No friction by the sliding velocity alone: a law of an operating point is replaced when the mesh is known, a local law
   !> overrides `evaluate_local`.
   pure subroutine evaluate(self, n, branch, v_t, phi, d_v)
      class(lubricated_friction_t), intent(in) :: self
      integer, intent(in) :: n, branch
      real(wp), intent(in) :: v_t(n)
      real(wp), intent(out) :: phi(n)
      real(wp), intent(inout), optional :: d_v(n)

      phi = 0
   end subroutine evaluate

end module evl_lubricated_friction
