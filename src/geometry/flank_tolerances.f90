!> Flank tolerances of a class: pitch, profile and helix.
!>
!> Tolerances in micrometres with the reference diameter d, the module m and the face width b in millimetres, class A from 1 to 11,
!> each with the factor sqrt(2)**(A-5):
!>
!>    f_HaT = 0.4 m + 0.001 d + 4                       f_faT = 0.55 m + 5                        F_aT = sqrt(f_HaT^2 + f_faT^2)
!>    f_HbT = 0.05 sqrt(d) + 0.35 sqrt(b) + 4           f_fbT = 0.07 sqrt(d) + 0.45 sqrt(b) + 4   F_bT = sqrt(f_HbT^2 + f_fbT^2)
!>
!> Totals are formed from the unrounded components; rounding is last.
!>
!> Source: ISO 1328-1:2013, 5.2 and 5.3.
module evl_flank_tolerances
   use evl_kinds, only: nan, wp
   use evl_pitch_errors, only: pitch_tolerances, rounded_tolerance
   use evl_status, only: has_failed, status_t
   implicit none (type, external)
   private

   public :: flank_tolerances_of, flank_tolerances_t

   real(wp), parameter :: micrometre = 1.0e-6_wp, millimetre = 1.0e-3_wp

   !> Tolerances [m]; NaN outside the limits of the standard, which forbids extrapolation.
   type :: flank_tolerances_t
      real(wp) :: single_pitch = nan, total_pitch = nan                         !! f_pT, F_pT
      real(wp) :: profile_slope = nan, profile_form = nan, total_profile = nan  !! f_HaT, f_faT, F_aT
      real(wp) :: helix_slope = nan, helix_form = nan, total_helix = nan        !! f_HbT, f_fbT, F_bT
   end type flank_tolerances_t

contains

   !> Tolerances of a gear. Equation DS10.
   !> Valid: as `pitch_tolerances`; those of the helix for face widths of 4 to 1200 mm
   type(flank_tolerances_t) function flank_tolerances_of(teeth, module, width, class) result(t)
      integer, intent(in) :: teeth   !! z
      real(wp), intent(in) :: module !! m [m]
      real(wp), intent(in) :: width  !! b [m]
      integer, intent(in) :: class   !! A
      type(status_t) :: status
      real(wp) :: single, total, d, m, b, step, slope, form

      call pitch_tolerances(teeth, module, class, single, total, status)
      if (has_failed(status)) return
      t%single_pitch = single
      t%total_pitch = total
      m = module/millimetre
      d = teeth*m
      b = width/millimetre
      step = sqrt(2.0_wp)**(class - 5)
      slope = (0.4_wp*m + 0.001_wp*d + 4)*step
      form = (0.55_wp*m + 5)*step
      t%profile_slope = rounded_tolerance(slope)*micrometre
      t%profile_form = rounded_tolerance(form)*micrometre
      t%total_profile = rounded_tolerance(hypot(slope, form))*micrometre
      if (.not. (b >= 4 .and. b <= 1200)) return
      slope = (0.05_wp*sqrt(d) + 0.35_wp*sqrt(b) + 4)*step
      form = (0.07_wp*sqrt(d) + 0.45_wp*sqrt(b) + 4)*step
      t%helix_slope = rounded_tolerance(slope)*micrometre
      t%helix_form = rounded_tolerance(form)*micrometre
      t%total_helix = rounded_tolerance(hypot(slope, form))*micrometre
   end function flank_tolerances_of

end module evl_flank_tolerances
