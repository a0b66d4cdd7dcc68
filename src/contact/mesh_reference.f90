!> What a mesh is at its nominal load: the oscillator that one perfect tooth pair at the pitch point makes of its two wheels.
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

   real(wp), parameter :: slow = 1.0e-6_wp !! rate of penetration at which dampers are asked, over that of the mesh mode

   !> NaN where there is none: of a rigid contact and without load all but the mass, of wheels whose speeds are prescribed all
   !> but the stiffness.
   type :: mesh_reference_t
      real(wp) :: stiffness = 0.0_wp !! k: dF/dh of one tooth pair under the whole nominal load [N/m]
      real(wp) :: mass = 0.0_wp      !! m: that it accelerates, 1/(r_bA^2/J_A + r_bB^2/J_B) [kg]
      real(wp) :: frequency = 0.0_wp !! of the mesh mode, sqrt(k/m)/(2 pi) [Hz]
      real(wp) :: damping = 0.0_wp   !! c: dF/dh' of its damper [N s/m]
      real(wp) :: ratio = 0.0_wp     !! damping ratio c/(2 sqrt(k m))
      type(law_choice) :: law        !! the damping law as it was stated, with what the mesh gives
   end type mesh_reference_t

contains

   !> Stiffness, mass and frequency of an elastic contact.
   type(mesh_reference_t) function reference_of(flank, contact, has_load, mobility) result(reference)
      class(flank_t), intent(in) :: flank
      type(tooth_contact_t), intent(in) :: contact  !! with its scales
      logical, intent(in) :: has_load      !! its scales are those of a load
      real(wp), intent(in) :: mobility     !! r_bA^2/J_A + r_bB^2/J_B [1/kg], 1/J of a prescribed speed 0
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

   !> Coefficient and ratio of the damper that acts. A law with another slope on approach than on separation counts with the mean of
   !> both, which takes as much from a small vibration.
   subroutine reference_damping(flank, contact, reference)
      class(flank_t), intent(in) :: flank
      type(tooth_contact_t), intent(in) :: contact !! with the damping law that acts
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
