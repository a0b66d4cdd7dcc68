!> Points A to E of the path of contact: radii of curvature, geometric load share, specific sliding, tooth loss factor.
!>
!> A is the start and E the end of contact, C the pitch point. B = E - p_b and D = A + p_b, one base pitch from the other end:
!> between them there is one tooth pair less than outside; with a contact ratio from 1 to 2 this is the single contact, B its lowest
!> point on the driving gear. With u = z_2/z_1 and the radii of curvature rho_1, rho_2 = T1T2 - rho_1
!>
!>    zeta_1 = 1 - rho_2/(u rho_1)    zeta_2 = 1 - u rho_1/rho_2
!>
!> The geometric share of a pair is 1 over the number of pairs on the path.
!>
!> Source: ISO 21771:2007, specific sliding; H. Ohlendorf, Verlustleistung und Erwaermung von Stirnraedern, TH Muenchen 1958, tooth
!> loss factor.
module evl_path_points
   use evl_kinds, only: nan, pi, wp
   use evl_mesh_geometry, only: spur_pair_t
   implicit none (type, external)
   private

   public :: nominal_pressures, path_points_of, path_points_t, tooth_loss_factor
   public :: point_a, point_b, point_c, point_d, point_e

   integer, parameter :: point_a = 1, point_b = 2, point_c = 3, point_d = 4, point_e = 5
   real(wp), parameter :: beside = 1.0e-9_wp !! distance from a border of zones, in base pitches: more than rounding

   !> Quantities at A to E, of the driving and the driven gear; NaN where a point does not exist.
   type :: path_points_t
      real(wp) :: rho(2, 5) = nan     !! radius of curvature [m]
      real(wp) :: radius(2, 5) = nan  !! distance from the axle [m]
      real(wp) :: sliding(2, 5) = nan !! specific sliding zeta; NaN also where a flank rolls on its base circle
      real(wp) :: share(5) = nan      !! geometric load share, on the side of the smaller number of pairs
   end type path_points_t

contains

   !> Compute the points of a pair. Equations DS6, DS7.
   pure type(path_points_t) function path_points_of(pair) result(points)
      type(spur_pair_t), intent(in) :: pair
      real(wp) :: rho(5)
      integer :: i, side

      associate (first => pair%rho_start_a, last => pair%rho_tip_a, p_b => pair%base_pitch)
         rho = [first, last - p_b, pair%base_radius_a*tan(pair%alpha_w), first + p_b, last]
         ! the path of a pair with handover is one base pitch long up to rounding
         if (last - first < p_b*(1 - beside)) rho([point_b, point_d]) = nan
         if (.not. pair%contains_pitch_point) rho(point_c) = nan
      end associate
      points%rho(1, :) = rho
      points%rho(2, :) = pair%rho - rho
      points%radius(1, :) = sign(sqrt(pair%base_radius_a**2 + points%rho(1, :)**2), pair%base_radius_a)
      points%radius(2, :) = sign(sqrt(pair%base_radius_b**2 + points%rho(2, :)**2), pair%base_radius_b)
      do i = 1, 5
         do side = 1, 2
            if (abs(points%rho(side, i)) > beside*pair%base_pitch) points%sliding(side, i) = &
               1 - points%rho(3 - side, i)/points%rho(side, i)*merge(1/pair%ratio, pair%ratio, side == 1)
         end do
         if (rho(i) <= pair%rho_tip_a*(1 + beside)) points%share(i) = share_at(pair, rho(i), towards(i))
      end do
      if (pair%contains_pitch_point) points%sliding(:, point_c) = 0 ! exactly
   end function path_points_of

   !> Hertz pressure at A to E under the geometric share of a line load; NaN at the end on a base circle [Pa]. Equation DS9.
   pure function nominal_pressures(points, pair, line_load, e_star) result(pressures)
      type(path_points_t), intent(in) :: points
      type(spur_pair_t), intent(in) :: pair
      real(wp), intent(in) :: line_load !! [N/m]
      real(wp), intent(in) :: e_star    !! effective modulus [Pa]
      real(wp) :: pressures(5)
      integer :: i

      pressures = nan
      do i = 1, 5
         if (minval(points%rho(:, i)*[pair%base_radius_a, pair%base_radius_b]) > 0) &
            pressures(i) = sqrt(line_load*points%share(i)*e_star*pair%rho/(pi*product(points%rho(:, i))))
      end do
   end function nominal_pressures

   !> Direction from a point to the zone with fewer pairs, or into the path.
   pure integer function towards(point)
      integer, intent(in) :: point

      towards = merge(1, -1, point == point_a .or. point == point_b)
   end function towards

   !> 1 over the number of tooth pairs on the path beside a position. Equation DS8.
   pure real(wp) function share_at(pair, rho, direction) result(share)
      type(spur_pair_t), intent(in) :: pair
      real(wp), intent(in) :: rho      !! of the driving gear [m]
      integer, intent(in) :: direction !! +1 or -1
      real(wp) :: at

      associate (p_b => pair%base_pitch)
         at = rho + direction*beside*p_b
         share = 1.0_wp/(1 + max(0, floor((pair%rho_tip_a - at)/p_b)) + max(0, floor((at - pair%rho_start_a)/p_b)))
      end associate
   end function share_at

   !> Tooth loss factor of Ohlendorf, for equal shares in double contact. Equation G16.
   !> Valid: contact ratio from 1 to 2, pitch point on the path; NaN otherwise
   pure real(wp) function tooth_loss_factor(pair) result(factor)
      type(spur_pair_t), intent(in) :: pair
      real(wp) :: pitch_point, e1, e2

      factor = nan
      if (.not. pair%contains_pitch_point .or. pair%contact_ratio < 1 .or. pair%contact_ratio > 2) return
      pitch_point = pair%base_radius_a*tan(pair%alpha_w)
      e1 = (pair%rho_tip_a - pitch_point)/pair%base_pitch
      e2 = (pitch_point - pair%rho_start_a)/pair%base_pitch
      factor = pi*abs(1.0_wp/pair%teeth_a + sign(1.0_wp, pair%ratio)/pair%teeth_b)*(1 - (e1 + e2) + e1**2 + e2**2)
   end function tooth_loss_factor

end module evl_path_points
