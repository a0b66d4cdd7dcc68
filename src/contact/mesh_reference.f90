!> Mesh properties at nominal load: the oscillator that its two wheels form with one perfect tooth pair at the pitch point.
module evl_mesh_reference
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use evl_contact_context, only: contact_context
   use evl_damping_law, only: viscous_force, viscous_result
   use evl_elastic_law, only: elastic_result
   use evl_flank, only: flank_t, nominal_context
   use evl_force_law, only: choice_of, law_choice
   use evl_kinds, only: pi, wp
   use evl_status, only: code_ok
   use evl_tooth_contact, only: tooth_contact_t
   implicit none (type, external)
   private

   public :: mesh_reference_t, reference_damping, reference_of

   real(wp), parameter :: slow = 1.0e-6_wp !! rate of penetration at which damping is evaluated, relative to that of the mesh mode

   !> Undefined values are NaN: all except the mass for a rigid contact or without load; all except the stiffness for wheels with
   !> prescribed speeds.
   type :: mesh_reference_t
      real(wp) :: stiffness = 0.0_wp !! k: dF/dh of one tooth pair under the whole nominal load [N/m]
      real(wp) :: mass = 0.0_wp      !! effective mass, 1/(r_bA^2/J_A + r_bB^2/J_B) [kg]
      real(wp) :: frequency = 0.0_wp !! of the mesh mode, sqrt(k/m)/(2 pi) [Hz]
      real(wp) :: damping = 0.0_wp   !! c: dF/dh' of its damper [N s/m]
      real(wp) :: ratio = 0.0_wp     !! damping ratio c/(2 sqrt(k m))
      type(law_choice) :: law        !! damping law as given in the case, with parameters from the mesh
      real(wp) :: friction = 0.0_wp  !! coefficient of a friction law that depends on the operating point; 0 for other laws
   end type mesh_reference_t

contains

   !> Stiffness, mass and frequency of an elastic contact. Equation L9.
   type(mesh_reference_t) function reference_of(flank, contact, has_load, mobility) result(reference)
      class(flank_t), intent(in) :: flank
      type(tooth_contact_t), intent(in) :: contact  !! with its scales
      logical, intent(in) :: has_load      !! whether its scales are those of a load
      real(wp), intent(in) :: mobility     !! r_bA^2/J_A + r_bB^2/J_B [1/kg], with 1/J = 0 for a prescribed speed
      type(elastic_result) :: elastic
      real(wp) :: none
      integer :: code

      none = ieee_value(1.0_wp, ieee_quiet_nan)
      reference = mesh_reference_t(none, none, none, none, none, choice_of(contact%damping))
      if (mobility > 0) reference%mass = 1/mobility
      if (contact%rigid .or. .not. has_load) return
      call flank%pair_alone(contact, contact%h_scale, elastic, code)
      if (code /= code_ok) return
      reference%stiffness = elastic%d_h
      if (.not. mobility > 0) return
      reference%frequency = sqrt(reference%stiffness*mobility)/(2*pi)
   end function reference_of

   !> Coefficient and ratio of the active damping law. If the slopes on approach and on separation differ, their mean is used, which
   !> dissipates the same energy in a small vibration.
   subroutine reference_damping(flank, contact, reference)
      class(flank_t), intent(in) :: flank
      type(tooth_contact_t), intent(in) :: contact !! with its active damping law
      type(mesh_reference_t), intent(inout) :: reference
      type(contact_context) :: ctx
      type(elastic_result) :: elastic
      type(viscous_result) :: approach, separation
      integer :: code

      if (.not. reference%frequency > 0) return
      ctx = nominal_context(contact)
      ctx%h = contact%h_scale
      call flank%pair_alone(contact, contact%h_scale, elastic, code)
      ctx%h_dot = slow*2*pi*reference%frequency*ctx%h
      call viscous_force(contact%damping, ctx, elastic, approach)
      ctx%h_dot = -ctx%h_dot
      call viscous_force(contact%damping, ctx, elastic, separation)
      reference%damping = (approach%d_h_dot + separation%d_h_dot)/2
      reference%ratio = reference%damping/(2*sqrt(reference%stiffness*reference%mass))
   end subroutine reference_damping

end module evl_mesh_reference
