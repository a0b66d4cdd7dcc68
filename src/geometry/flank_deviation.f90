!> Flank deviations of one wheel: tip and root relief, profile crowning, pitch errors and runout.
!>
!> The actual flank is the involute displaced into the material by e(rho) along its normal; e < 0 is excess material. With e_1
!> and e_2 of both flanks the gap of a tooth pair is kappa + e_1(rho_1) + e_2(rho_2). Over the radius of curvature
!> rho = r_b xi, xi the roll angle, for tooth k (counted counterclockwise) and side s (+1: the flank that faces clockwise, which
!> pushes when the wheel drives clockwise; -1: the other one):
!>
!>    e = C_a u_a**p_a [tip]  or  C_f u_f**p_f [root]  or  0     u = (rho - rho_s)/(rho_end - rho_s), p = 1 linear, 2 parabolic
!>      + C_alpha ((rho - rho_m)/((rho_tip - rho_start)/2))**2
!>      + s p_k - s e_c sin(k gamma - s psi_b/2 + s rho/r_b - psi_c)
!>
!> docs/theory/deviations.md derives the last line, and the effect of second order: a flank with a slope touches beside the line of
!> action. If `line` is set, the profile's part of e is the minimum over displacements along the common tangent,
!>
!>    min over d of  e(rho + d) + d**2/(2 q),  q = r_b**2 (1/rho - 1/line)
!>
!> on a flank e - F e'**2/2 with F = q/(1 + q e''), and at the corner of a linear relief, where d = rho_s - rho,
!> e(rho_s) + d**2/(2 q). The zones are then those of the point of contact. Both flanks of a pair turn by the slopes s there:
!> this adds r_bA r_bB s_A s_B/line to their common deviation.
module evl_flank_deviation
   use evl_elementary, only: sine_cosine
   use evl_kinds, only: pi, wp
   implicit none (type, external)
   private

   public :: flank_branch, flank_deviation_t, flank_slope, relief_t
   public :: deviation_borders, deviation_branch, deviation_on, deviation_zone, has_corner, profile_zone
   public :: corner_in, find_slope, slope_on, take_line, teeth_differ
   public :: zone_edge, zone_end, zone_none, zone_root, zone_root_corner, zone_tip, zone_tip_corner

   integer, parameter :: zone_tip_corner = -3  !! on the corner where a linear tip relief begins
   integer, parameter :: zone_root_corner = -2 !! on that of a root relief
   integer, parameter :: most_turns = 40 !! iterations for the contact of a corner: each reduces the error at least tenfold
   integer, parameter :: zone_root = -1 !! below the border of the root relief
   integer, parameter :: zone_none = 0  !! between the borders
   integer, parameter :: zone_tip = 1   !! beyond the border of the tip relief
   integer, parameter :: zone_end = 2   !! past the end of the flank, which is extended straight: of wheels with tip-edge contact
   integer, parameter :: zone_edge = 3  !! its edge beyond that; in both the tip has the profile, and only pitch and runout remain

   !> Relief beyond its border.
   type :: relief_t
      real(wp) :: amount = 0.0_wp        !! C_a or C_f at the end of the profile [m]; 0: no relief
      real(wp) :: border = 0.0_wp        !! rho_s, radius of curvature at which it begins [m]
      real(wp) :: taken(2) = 0.0_wp      !! rho at which an approaching contact reaches its corner, and leaves it for the relief [m]
      real(wp) :: slopes(0:3) = 0.0_wp   !! of the slope between both: cubic in the fraction of this range
      real(wp) :: length = 1.0_wp        !! from the border to the end of the profile [m], negative for root relief
      logical :: parabolic = .false.     !! its slope is 0 at its border
   end type relief_t

   !> Deviations of all flanks of one wheel; the initial values are those of a perfect wheel.
   type :: flank_deviation_t
      logical :: exists = .false.        !! whether there is any deviation
      type(relief_t) :: tip, root
      real(wp) :: crowning = 0.0_wp      !! C_alpha at both ends of the profile [m]
      real(wp) :: middle = 0.0_wp        !! rho_m, radius of curvature in the middle of the profile [m]
      real(wp) :: half_length = 1.0_wp   !! from there to its ends [m]
      integer :: teeth = 1               !! z
      real(wp), allocatable :: pitch(:)  !! p_k of teeth 0 to z-1 along the normal [m], (0:teeth-1); not allocated: no errors
      real(wp) :: eccentricity = 0.0_wp  !! e_c of the centre of the teeth from the axle [m]
      real(wp) :: phase = 0.0_wp         !! psi_c, direction of the eccentricity from the middle of tooth 0 [rad]
      real(wp) :: base_radius = 1.0_wp   !! r_b [m]
      real(wp) :: half_tooth = 0.0_wp    !! psi_b/2, half of the tooth angle on the base circle [rad]
      real(wp) :: line = 0.0_wp          !! length of the line of action, for the gap of second order; 0: first order [m]
      real(wp) :: least = 0.0_wp         !! lower limit of rho in q: far off the path [m]
   end type flank_deviation_t

   !> Flank of one tooth in one zone: all quantities independent of rho. The initial values are those of a perfect flank.
   type :: flank_branch
      real(wp) :: border = 0.0_wp          !! rho_s of the relief [m]
      real(wp) :: per_length = 0.0_wp      !! 1/(rho_end - rho_s) [1/m]
      real(wp) :: linear = 0.0_wp          !! C of linear relief, else 0 [m]
      real(wp) :: parabolic = 0.0_wp       !! C of parabolic relief, else 0 [m]
      real(wp) :: crowning = 0.0_wp        !! C_alpha [m]
      real(wp) :: middle = 0.0_wp          !! rho_m [m]
      real(wp) :: per_half_length = 0.0_wp !! 2/(rho_tip - rho_start) [1/m]
      real(wp) :: offset = 0.0_wp          !! s p_k [m]
      real(wp) :: runout = 0.0_wp          !! s e_c [m]
      real(wp) :: angle = 0.0_wp           !! k gamma - s psi_b/2 - psi_c [rad]
      real(wp) :: turn = 0.0_wp            !! s/r_b [rad/m]
      logical :: is_second = .false.       !! of second order
      logical :: is_corner = .false.       !! and on a corner at `border`; the offset contains e there
      logical :: slopes = .false.          !! and its profile has a slope somewhere
      real(wp) :: r_b2 = 0.0_wp            !! r_b**2 [m2]
      real(wp) :: per_line = 0.0_wp        !! 1/line [1/m]
      real(wp) :: least = 0.0_wp           !! [m]
   end type flank_branch

   !> Slope of a flank of second order at its point of contact.
   type :: flank_slope
      real(wp) :: s = 0.0_wp   !! [1]
      real(wp) :: ds = 0.0_wp  !! by rho [1/m]
      real(wp) :: d2s = 0.0_wp !! [1/m2]
   end type flank_slope

contains

   !> Whether the flanks of a wheel differ.
   pure logical function teeth_differ(deviation)
      type(flank_deviation_t), intent(in) :: deviation

      teeth_differ = allocated(deviation%pitch) .or. deviation%eccentricity > 0
   end function teeth_differ

   include "geometry/flank_branch.inc"

   !> Deviation e of a flank with its derivatives by rho. Every formula is defined for all rho: a zone that is held extends
   !> its branch beyond the border.   Valid: rho near the profile of the wheel
   pure subroutine deviation_on(branch, rho, e, de, d2e)
      type(flank_branch), intent(in) :: branch
      real(wp), intent(in) :: rho     !! radius of curvature [m]
      real(wp), intent(out) :: e      !! [m]
      real(wp), intent(out) :: de     !! de/drho
      real(wp), intent(out) :: d2e    !! d2e/drho2 [1/m]

      call profile_deviation(branch, rho, e, de, d2e)
      if (branch%is_second .and. branch%is_corner) then
         call touch_at_corner(branch, rho, e, de, d2e)
      else if (branch%is_second) then
         call touch_beside(branch, rho, e, de, d2e)
      end if
      if (abs(branch%runout) > 0) call add_runout(branch, rho, e, de, d2e)
   end subroutine deviation_on

   !> Slope of a profile of second order at its point of contact, with its derivatives by rho.
   pure subroutine slope_on(deviation, zone, branch, rho, value)
      type(flank_deviation_t), intent(in) :: deviation
      integer, intent(in) :: zone
      type(flank_branch), intent(in) :: branch !! of the zone
      real(wp), intent(in) :: rho              !! radius of curvature [m]
      type(flank_slope), intent(out) :: value

      if (branch%is_corner) then
         call slope_at_corner(corner_in(deviation, zone), rho, value%s, value%ds, value%d2s)
      else
         call find_slope(branch, rho, value)
      end if
   end subroutine slope_on

   !> `slope_on` away from corners.
   pure subroutine find_slope(branch, rho, value)
      type(flank_branch), intent(in) :: branch
      real(wp), intent(in) :: rho
      type(flank_slope), intent(out) :: value

      call touching_slope(branch, rho, value%s, value%ds, value%d2s)
   end subroutine find_slope

   !> Relief whose corner is in contact.
   pure type(relief_t) function corner_in(deviation, zone) result(relief)
      type(flank_deviation_t), intent(in) :: deviation
      integer, intent(in) :: zone !! zone_tip_corner or zone_root_corner

      relief = deviation%root
      if (zone == zone_tip_corner) relief = deviation%tip
   end function corner_in

   !> Branch of one tooth's flank in a zone. Equations D10, D14.
   pure type(flank_branch) function deviation_branch(deviation, tooth, side, zone) result(branch)
      type(flank_deviation_t), intent(in) :: deviation
      integer, intent(in) :: tooth    !! k, any integer; taken modulo z
      integer, intent(in) :: side     !! s, +1 or -1
      integer, intent(in) :: zone     !! zone_tip_corner to zone_edge
      integer :: k

      if (.not. deviation%exists) return
      if (zone <= zone_tip) call shape_profile(deviation, zone, branch)
      k = modulo(tooth, deviation%teeth)
      if (allocated(deviation%pitch)) branch%offset = branch%offset + side*deviation%pitch(k)
      if (deviation%eccentricity > 0) then
         branch%runout = side*deviation%eccentricity
         branch%angle = 2*pi*k/deviation%teeth - deviation%phase - side*deviation%half_tooth
         branch%turn = side/deviation%base_radius
      end if
   end function deviation_branch

   !> Relief and crowning of a branch.
   pure subroutine shape_profile(deviation, zone, branch)
      type(flank_deviation_t), intent(in) :: deviation
      integer, intent(in) :: zone
      type(flank_branch), intent(inout) :: branch

      select case (zone)
      case (zone_tip)
         call relieve(deviation%tip, branch)
      case (zone_root)
         call relieve(deviation%root, branch)
      end select
      if (deviation%crowning > 0) then
         branch%crowning = deviation%crowning
         branch%middle = deviation%middle
         branch%per_half_length = 1/deviation%half_length
      end if
      branch%is_second = deviation%line > 0
      if (.not. branch%is_second) return
      branch%r_b2 = deviation%base_radius**2
      branch%per_line = 1/deviation%line
      branch%least = deviation%least
      branch%is_corner = zone == zone_tip_corner .or. zone == zone_root_corner
      branch%slopes = branch%is_corner .or. max(branch%linear, branch%parabolic, branch%crowning) > 0
      if (.not. branch%is_corner) return
      branch%border = merge(deviation%tip%border, deviation%root%border, zone == zone_tip_corner)
      branch%offset = branch%crowning*((branch%border - branch%middle)*branch%per_half_length)**2
      branch%crowning = 0
   end subroutine shape_profile

   !> Relief of a branch. Equations D16, D17.
   pure subroutine relieve(relief, branch)
      type(relief_t), intent(in) :: relief
      type(flank_branch), intent(inout) :: branch

      branch%border = relief%border
      branch%per_length = 1/relief%length
      if (relief%parabolic) then
         branch%parabolic = relief%amount
      else
         branch%linear = relief%amount
      end if
   end subroutine relieve

   !> Radii of curvature at which root relief ends and tip relief begins [m]; -huge and huge if there is none.
   pure subroutine deviation_borders(deviation, rho_root, rho_tip)
      type(flank_deviation_t), intent(in) :: deviation
      real(wp), intent(out) :: rho_root, rho_tip

      rho_root = -huge(rho_root)
      rho_tip = huge(rho_tip)
      if (deviation%root%amount > 0) rho_root = deviation%root%border
      if (deviation%tip%amount > 0) rho_tip = deviation%tip%border
   end subroutine deviation_borders

   !> Set up the gap of second order with a mate: where contacts reach and leave the corners of reliefs.
   subroutine take_line(deviation, line, rho_start)
      type(flank_deviation_t), intent(inout) :: deviation
      real(wp), intent(in) :: line      !! length of the line of action [m]
      real(wp), intent(in) :: rho_start !! start of the active profile [m]

      deviation%line = line
      deviation%least = max(rho_start/2, line/1000)
      call take_corner(deviation, zone_tip, deviation%tip)
      call take_corner(deviation, zone_root, deviation%root)
   end subroutine take_line

   !> Contact range of the corner of a relief: rho = rho_s + q(rho) e'(rho_s), with the slopes before and behind it.
   pure subroutine take_corner(deviation, zone, relief)
      type(flank_deviation_t), intent(in) :: deviation
      integer, intent(in) :: zone !! of the relief
      type(relief_t), intent(inout) :: relief
      type(flank_branch) :: branch
      type(flank_slope) :: there(2)
      real(wp) :: e, slope, d2e
      integer :: side, turn

      relief%taken = relief%border
      if (.not. relief%amount > 0) return
      do side = 1, 2
         branch = flank_branch()
         call shape_profile(deviation, merge(zone_none, zone, side == 1), branch)
         call profile_deviation(branch, relief%border, e, slope, d2e)
         do turn = 1, most_turns
            relief%taken(side) = relief%border + branch%r_b2*(1/max(relief%taken(side), branch%least) - branch%per_line)*slope
         end do
         call find_slope(branch, relief%taken(side), there(side))
      end do
      ! without a corner both positions are equal, except for the last digits
      if (relief%parabolic) relief%taken(2) = relief%taken(1)
      associate (range => relief%taken(2) - relief%taken(1), rise => there(2)%s - there(1)%s)
         relief%slopes = [there(1)%s, range*there(1)%ds, 3*rise - range*(2*there(1)%ds + there(2)%ds), &
                          range*(there(1)%ds + there(2)%ds) - 2*rise]
      end associate
   end subroutine take_corner

   !> Zone to which the material at rho belongs; none belongs to a corner.
   pure integer function profile_zone(deviation, rho) result(zone)
      type(flank_deviation_t), intent(in) :: deviation
      real(wp), intent(in) :: rho !! radius of curvature [m]
      real(wp) :: rho_root, rho_tip

      call deviation_borders(deviation, rho_root, rho_tip)
      zone = zone_none
      if (rho < rho_root) zone = zone_root
      if (rho > rho_tip) zone = zone_tip
   end function profile_zone

   !> Whether the corner of a relief can be in contact.
   elemental logical function has_corner(relief)
      type(relief_t), intent(in) :: relief

      has_corner = abs(relief%taken(2) - relief%taken(1)) > 0
   end function has_corner

   !> Zone of a contact at rho; the borders themselves belong to zone_none.
   pure integer function deviation_zone(deviation, rho) result(zone)
      type(flank_deviation_t), intent(in) :: deviation
      real(wp), intent(in) :: rho !! radius of curvature [m]

      zone = zone_none
      associate (tip => deviation%tip, root => deviation%root)
         if (root%amount > 0 .and. rho < root%taken(1)) zone = merge(zone_root_corner, zone_root, rho > root%taken(2))
         if (tip%amount > 0 .and. rho > tip%taken(1)) zone = merge(zone_tip_corner, zone_tip, rho < tip%taken(2))
      end associate
   end function deviation_zone

end module evl_flank_deviation
