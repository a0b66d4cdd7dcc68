!> Viscous forces that multiply the elastic one, after Hunt and Crossley: F_v = F_e chi h'/v0.
!>
!> v0 is the approach speed at the last closing, so that an impact loses the same fraction of its energy at every speed. The
!> laws differ in how chi depends on their nominal coefficient of restitution e. The actual restitution e' follows from
!> m h'' = -F_e (1 + chi h'/v0) without loads: division by 1 + chi h'/v0 and integration over h, once from v0 to 0 and once from 0
!> to -e' v0, eliminates the elastic energy and gives, for any elastic law,
!>
!>    chi (1 + e') = ln[(1 + chi)/(1 - chi e')]
!>
!> Hence e' < 1/chi: in a free impact the flanks never pull.
!>
!> Source: P. Flores, M. Machado, M. T. Silva, J. M. Martins, On the continuous contact force models for soft materials in multibody
!> dynamics, Multibody Syst. Dyn. 25 (2011) 357, a comparison. The source of each chi is in the table; docs/reference/laws.md has
!> the titles.
module evl_impact_damping
   use evl_damping_law, only: damping_law_t
   use evl_force_law, only: yes
   use evl_kinds, only: wp
   use evl_row, only: kind_t, parameter_row, positive, range_t, span_t
   implicit none (type, external)
   private

   public :: impact_damping_t, impact_factors

   !> Dependence of chi on the coefficient of restitution e: scale (1 - e), times 1 + e, over e.
   type :: impact_factor
      character(len=19) :: name    !! of the law
      character(len=15) :: formula !! of chi
      character(len=63) :: source  !! of it
      real(wp) :: scale
      logical :: times, over       !! a law that divides by e refuses 0
   end type impact_factor

   type(impact_factor), parameter :: impact_factors(*) = [ &
          impact_factor("hunt_crossley", "1.5 (1 - e)", "Hunt & Crossley 1975, J. Appl. Mech. 42, 440", 1.5_wp, .false., .false.), &
                      impact_factor("lankarani_nikravesh", "0.75 (1 - e^2)", "Lankarani & Nikravesh 1990, J. Mech. Des. 112, 369", &
                                                   0.75_wp, .true., .false.), &
          impact_factor("flores", "8 (1 - e)/(5 e)", "Flores et al. 2011, Multibody Syst. Dyn. 25, 357", 1.6_wp, .false., .true.), &
           impact_factor("gonthier", "(1 - e^2)/e", "Gonthier et al. 2004, Multibody Syst. Dyn. 11, 209", 1.0_wp, .true., .true.), &
                               impact_factor("lee_wang", "0.75 (1 - e)", "Lee & Wang 1983, J. Mech. Transm. Autom. Des. 105, 534", &
                                                   0.75_wp, .false., .false.)]

   type, extends(damping_law_t) :: impact_damping_t
      integer :: factor = 1 !! index of the law in impact_factors
   contains
      procedure :: describe
      procedure :: evaluate
      procedure, nopass :: remembers => yes
      procedure :: complete
   end type impact_damping_t

contains

   !> Name, source and parameters.
   pure subroutine describe(self, info)
      class(impact_damping_t), intent(in) :: self
      type(kind_t), intent(inout) :: info
      type(impact_factor) :: factor

      factor = impact_factors(self%factor)
      info%name = factor%name
      info%text = "elastic force times chi h'/v0, chi = "//factor%formula
      info%source = factor%source
      info%rows = [parameter_row("restitution", "", "nominal coefficient of restitution e", &
                                 range=range_t(minimum=0.0_wp, maximum=1.0_wp, minimum_open=factor%over)), &
                   parameter_row("v0_min", "m/s", "lower limit of the approach speed v0; h_0 sqrt(k/m) if not given", &
                                 range=positive, left_open=.true., &
                                 plausible=span_t(1.0e-12_wp, 10.0_wp))]
   end subroutine describe

   !> chi/v0 [s/m]. Equations L11, L17, L18, L19, L20.
   pure real(wp) function share_of(self, v0) result(share)
      class(impact_damping_t), intent(in) :: self
      real(wp), intent(in) :: v0 !! approach speed at the last closing [m/s]

      associate (i => self%factor, e => self%parameters(1))
         share = impact_factors(i)%scale*(1.0_wp - e)
         if (impact_factors(i)%times) share = share*(1.0_wp + e)
         if (impact_factors(i)%over) share = share/e
      end associate
      share = share/max(v0, self%parameters(2))
   end function share_of

   !> F = share F_e h'. Equation L11.
   pure subroutine evaluate(self, n, h, h_dot, elastic, v0, side, force, d_h, d_h_dot, d_elastic)
      class(impact_damping_t), intent(in) :: self
      integer, intent(in) :: n, side
      real(wp), intent(in) :: h(n), h_dot(n), elastic(n), v0
      real(wp), intent(out) :: force(n)
      real(wp), dimension(n), intent(inout), optional :: d_h, d_h_dot, d_elastic
      real(wp) :: share

      share = share_of(self, v0)
      force = share*h_dot*elastic
      if (present(d_h_dot)) d_h_dot = share*elastic
      if (present(d_elastic)) d_elastic = share*h_dot
   end subroutine evaluate

   !> Set v0_min, if it was left open, to the speed amplitude of a vibration as large as the penetration under the nominal load.
   !> Equation L21.
   pure subroutine complete(self, stiffness, mass, h_0)
      class(impact_damping_t), intent(inout) :: self
      real(wp), intent(in) :: stiffness, mass, h_0

      if (self%left_to_mesh() /= "") self%parameters(2) = h_0*sqrt(stiffness/mass)
   end subroutine complete

end module evl_impact_damping
