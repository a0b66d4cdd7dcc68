!> Rigid contact as an entry of the law table: it has no force of its own; its flanks are a constraint of the gearbox.
module evl_rigid
   use evl_contact_context, only: contact_context
   use evl_elastic_law, only: elastic_law_t, elastic_result, no_elastic
   use evl_force_law, only: yes
   use evl_johnson, only: johnson_t
   use evl_kinds, only: wp
   use evl_row, only: between, kind_t, parameter_row, positive, span_t
   use evl_status, only: code_out_of_domain
   implicit none (type, external)
   private

   public :: rigid_t

   type, extends(elastic_law_t) :: rigid_t
   contains
      procedure :: describe
      procedure, nopass :: is_rigid => yes
      procedure :: force
      procedure :: potential
      procedure :: penetration
      procedure :: limit_message
      procedure :: restitution
      procedure :: rest_velocity
      procedure :: compliant
   end type rigid_t

contains

   !> Name, source and parameters.
   pure subroutine describe(self, info)
      class(rigid_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "rigid"
      info%text = "unilateral constraint; the normal force is its multiplier"
      info%source = "Kosenko & Gusev 2011, section 7.3; impacts after Newton"
      info%rows = [parameter_row("restitution", "", "coefficient of restitution: rebound speed divided by approach speed of an" &
                                 //" impact", &
                                 range=between(0.0_wp, 1.0_wp), default="0"), &
                   parameter_row("rest_velocity", "m/s", "approach speed below which an impact does not rebound", range=positive, &
                                 default="1.0e-06", &
                                 plausible=span_t(1.0e-9_wp, 1.0_wp))]
   end subroutine describe

   !> No force at any penetration.
   pure subroutine force(self, ctx, result, code)
      class(rigid_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      type(elastic_result), intent(out) :: result
      integer, intent(out) :: code

      result = no_elastic
      code = code_out_of_domain
   end subroutine force

   !> No energy is stored.
   pure function potential(self, ctx, force) result(energy)
      class(rigid_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      real(wp), intent(in) :: force
      real(wp) :: energy

      energy = 0
   end function potential

   !> No penetration corresponds to a force.
   pure subroutine penetration(self, ctx, force, h, code)
      class(rigid_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      real(wp), intent(in) :: force
      real(wp), intent(out) :: h
      integer, intent(out) :: code

      h = 0
      code = code_out_of_domain
   end subroutine penetration

   !> Reason why there is no force.
   pure subroutine limit_message(self, ctx, message)
      class(rigid_t), intent(in) :: self
      type(contact_context), intent(in) :: ctx
      character(len=*), intent(out) :: message

      message = "a rigid contact has no force law: its normal force is the multiplier of its constraint"
   end subroutine limit_message

   !> Newton's coefficient of restitution.
   pure real(wp) function restitution(self)
      class(rigid_t), intent(in) :: self

      restitution = self%parameters(1)
   end function restitution

   !> Approach speed below which an impact does not rebound [m/s].
   pure real(wp) function rest_velocity(self)
      class(rigid_t), intent(in) :: self

      rest_velocity = self%parameters(2)
   end function rest_velocity

   !> Law that gives the magnitude of penetrations of elastic flanks: two cylinders after Johnson.
   subroutine compliant(self, law)
      class(rigid_t), intent(in) :: self
      class(elastic_law_t), allocatable, intent(out) :: law

      allocate (johnson_t :: law)
   end subroutine compliant

end module evl_rigid
