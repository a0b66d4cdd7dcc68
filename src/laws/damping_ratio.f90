!> Linear damper whose coefficient follows from a damping ratio of one tooth pair at the nominal load: c = 2 value sqrt(k m).
!>
!> It is replaced by a linear damper when the mesh is known.
module evl_damping_ratio
   use evl_damping_law, only: damping_law_t
   use evl_kinds, only: wp
   use evl_linear_damping, only: linear_damping_t
   use evl_row, only: kind_t, parameter_row, range_t, short_length
   implicit none (type, external)
   private

   public :: damping_ratio_t

   type, extends(damping_law_t) :: damping_ratio_t
   contains
      procedure :: describe
      procedure :: evaluate
      procedure :: left_to_mesh
      procedure :: refuse_mesh
      procedure :: acting
   end type damping_ratio_t

contains

   !> Name, source and parameter.
   pure subroutine describe(self, info)
      class(damping_ratio_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "ratio"
      info%text = "c h' with c = 2 value sqrt(k m), by the damping ratio of one tooth pair at the nominal load"
      info%source = "the definition of a damping ratio; k and m: docs/reference/laws.md"
      info%rows = [parameter_row("value", "", "damping ratio of one tooth pair at the nominal load", &
                                 range=range_t(minimum=0.0_wp, maximum=1.0_wp, maximum_open=.true.))]
   end subroutine describe

   !> No force before the mesh is known.
   pure subroutine evaluate(self, n, h, h_dot, elastic, v0, side, force, d_h, d_h_dot, d_elastic)
      class(damping_ratio_t), intent(in) :: self
      integer, intent(in) :: n, side
      real(wp), intent(in) :: h(n), h_dot(n), elastic(n), v0
      real(wp), intent(out) :: force(n)
      real(wp), dimension(n), intent(inout), optional :: d_h, d_h_dot, d_elastic

      force = 0
   end subroutine evaluate

   !> Key of the parameter that needs the mesh.
   pure function left_to_mesh(self) result(name)
      class(damping_ratio_t), intent(in) :: self
      character(len=short_length) :: name

      name = "value"
   end function left_to_mesh

   !> Error message if the mesh has no stiffness or no mass to refer to.
   pure subroutine refuse_mesh(self, reason, field, message)
      class(damping_ratio_t), intent(in) :: self
      character(len=*), intent(in) :: reason
      character(len=*), intent(out) :: field, message

      field = self%left_to_mesh()
      message = "a damping ratio needs a load and a wheel that is free to vibrate: "//reason//"; take {law: linear," &
                //" coefficient: ...}"
   end subroutine refuse_mesh

   !> The linear damper that replaces this law. Equation L8.
   subroutine acting(self, stiffness, mass, law)
      class(damping_ratio_t), intent(in) :: self
      real(wp), intent(in) :: stiffness, mass
      class(damping_law_t), allocatable, intent(out) :: law

      allocate (linear_damping_t :: law)
      law%parameters(1) = 2*self%parameters(1)*sqrt(stiffness*mass)
   end subroutine acting

end module evl_damping_ratio
