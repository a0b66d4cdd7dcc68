!> Drawing of a mesh: circles, line of action and outlines of teeth, with a tooth pair in contact at the pitch point.
!>
!> The pitch point is the origin, the driving gear below it, the driven gear above it; both centres are on one side of an internal
!> pair. sigma = +1: the driving gear turns clockwise, an internal one counterclockwise.
module evl_mesh_picture
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use evl_cutter_generation, only: cutter_fillet
   use evl_gear, only: gear_cutter, gear_cutter_fit, gear_t, gear_tip_angle, gear_tip_curvature
   use evl_gearbox, only: gearbox_t
   use evl_involute_angle, only: involute_of_tangent
   use evl_kinds, only: pi, wp
   use evl_path_points, only: path_points_of, path_points_t
   use evl_rack_generation, only: fillet_at_radius
   use evl_ring_root, only: ring_root_arc
   use evl_tooth_outline, only: fillet_point, involute_point, outline_of_gear, rounding_point, tooth_outline_t
   implicit none (type, external)
   private

   public :: mesh_outline, mesh_picture, mesh_picture_t

   integer, parameter :: n_involute = 16, n_fillet = 12, n_rounding = 5 !! intervals of the curves of half a tooth

   ! Circles and points; index 1 is the driving gear.
   !> evl_mesh_picture
   type, bind(c) :: mesh_picture_t
      integer(c_int) :: sigma
      integer(c_int) :: wheel(2)        !! indices, from 0
      integer(c_int) :: teeth(2)
      real(c_double) :: centre(2)       !! y of the axles [m]
      real(c_double) :: base_radius(2), pitch_radius(2), tip_radius(2), root_radius(2) !! [m]; root 0: unknown
      real(c_double) :: points(2, 7)    !! T1, A, B, C, D, E, T2; NaN: does not exist
   end type mesh_picture_t

contains

   !> Circles and points of a mesh. Equation DS6.
   pure type(mesh_picture_t) function mesh_picture(gearbox, mesh) result(picture)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      type(path_points_t) :: at
      integer :: i

      associate (contact => gearbox%contacts(gearbox%first(mesh)), pair => gearbox%pairs(mesh))
         at = path_points_of(pair)
         picture%sigma = pair%sigma
         picture%wheel = [contact%wheel_a, contact%wheel_b] - 1
         picture%teeth = [pair%teeth_a, pair%teeth_b]
         picture%centre = [-pair%pitch_radius_a, pair%pitch_radius_b]
         picture%base_radius = abs([pair%base_radius_a, pair%base_radius_b])
         picture%pitch_radius = abs([pair%pitch_radius_a, pair%pitch_radius_b])
         picture%tip_radius = abs([pair%tip_radius_a, pair%tip_radius_b])
         picture%root_radius = abs(gearbox%gears([contact%wheel_a, contact%wheel_b])%root_radius)
         picture%points(:, 1) = on_line(0.0_wp)
         do i = 1, 5
            picture%points(:, i + 1) = on_line(at%rho(1, i))
         end do
         picture%points(:, 7) = on_line(pair%rho)
      end associate

   contains

      !> Point of the line of action, at a radius of curvature of the driving gear.
      pure function on_line(rho) result(point)
         real(wp), intent(in) :: rho
         real(wp) :: point(2)

         associate (pair => gearbox%pairs(mesh))
            point = (rho - pair%base_radius_a*tan(pair%alpha_w))*[pair%sigma*cos(pair%alpha_w), sin(pair%alpha_w)]
         end associate
      end function on_line

   end function mesh_picture

   !> Outline of neighbouring teeth of a gear, from a space to a space, counterclockwise; no points without a basic rack.
   pure subroutine mesh_outline(gearbox, mesh, side, teeth, points)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      integer, intent(in) :: side                          !! 1: driving gear, 2: driven gear
      integer, intent(in) :: teeth                         !! number of teeth, odd; the middle one is in contact
      real(wp), allocatable, intent(out) :: points(:, :)   !! (2, n) [m]
      real(wp), allocatable :: half(:, :), tooth(:, :)
      real(wp) :: middle, angle, centre
      integer :: i, n

      associate (contact => gearbox%contacts(gearbox%first(mesh)), pair => gearbox%pairs(mesh))
         associate (gear => gearbox%gears(merge(contact%wheel_a, contact%wheel_b, side == 1)))
            if (gear%teeth == 0) then
               allocate (points(2, 0))
               return
            end if
            if (gear%is_internal) then
               call half_internal_tooth(gear, half)
            else
               call half_tooth(gear, half)
            end if
            n = size(half, 2)
            ! from the clockwise side of the tooth, the mirror image, to its counterclockwise side
            allocate (tooth(2, 2*n), points(2, 2*n*teeth))
            tooth(:, n + 1:) = half(:, n:1:-1)
            tooth(1, :n) = half(1, :)
            tooth(2, :n) = -half(2, :)
            ! the flank in contact passes through the pitch point; its tooth is behind it on gear 1, before it on gear 2
            middle = gear%tooth_angle/2 - involute_of_tangent(tan(pair%alpha_w))
            angle = merge(pi/2, -pi/2, side == 1) + pair%sigma*middle
            centre = merge(-pair%pitch_radius_a, pair%pitch_radius_b, side == 1)
            do i = 1, teeth
               points(:, 2*n*(i - 1) + 1:2*n*i) = turned(tooth, angle + (i - 1 - teeth/2)*2*pi/gear%teeth)
            end do
            points(2, :) = points(2, :) + centre
         end associate
      end associate
   end subroutine mesh_outline

   !> Points turned about the origin.
   pure function turned(points, angle) result(there)
      real(wp), intent(in) :: points(:, :), angle
      real(wp) :: there(size(points, 1), size(points, 2))

      there(1, :) = cos(angle)*points(1, :) - sin(angle)*points(2, :)
      there(2, :) = sin(angle)*points(1, :) + cos(angle)*points(2, :)
   end function turned

   !> Half a tooth on the x axis, y > 0: from the middle of the space to that of the tip [m].
   pure subroutine half_tooth(gear, points)
      type(gear_t), intent(in) :: gear
      real(wp), allocatable, intent(out) :: points(:, :)
      real(wp) :: angle, radius
      type(tooth_outline_t) :: outline
      integer :: i, n

      outline = outline_of_gear(gear, real(gear%rack_root_radius, wp))
      n = n_fillet + n_involute + 4
      if (gear%tip_rounding > 0) n = n + n_rounding + 1
      allocate (points(2, n))
      points(:, 1) = outline%root_radius*[cos(outline%half_pitch), sin(outline%half_pitch)]
      do i = 0, n_fillet
         if (gear%is_undercut) then
            radius = gear%root_radius + (gear%form_radius - gear%root_radius)*i/n_fillet
            angle = outline%half_tooth - fillet_at_radius(gear%reference_radius, gear%pressure_angle, gear%tool_depth, &
                                                          gear%tool_rounding, radius)
            points(:, i + 2) = radius/gear%normal_module*[cos(angle), sin(angle)]
         else
            points(:, i + 2) = fillet_point(outline, outline%fillet_start*i/n_fillet)
         end if
      end do
      n = n_fillet + 2
      do i = 1, n_involute
         points(:, n + i) = involute_point(outline, outline%rho_form + (outline%rho_tip - outline%rho_form)*i/n_involute)
      end do
      n = n + n_involute
      if (gear%tip_rounding > 0) then
         do i = 0, n_rounding
            points(:, n + i + 1) = rounding_point(outline, 1 - real(i, wp)/n_rounding)
         end do
         n = n + n_rounding + 1
      end if
      points(:, n + 1) = outline%tip_radius*[cos(outline%tip_angle/2), sin(outline%tip_angle/2)]
      points(:, n + 2) = outline%tip_radius*[1.0_wp, 0.0_wp]
      points = points*gear%normal_module
   end subroutine half_tooth

   !> The same of an internal gear, on the negative x axis like all its radii: y < 0.
   pure subroutine half_internal_tooth(gear, points)
      type(gear_t), intent(in) :: gear
      real(wp), allocatable, intent(out) :: points(:, :)
      real(wp) :: base, root, tip, form, last, middle, centre(2), from(2)
      integer :: i, n

      base = -gear%base_radius
      root = -gear%root_radius
      tip = -gear%tip_radius
      form = sqrt((gear%form_radius - gear%base_radius)*(gear%form_radius + gear%base_radius))
      last = -gear_tip_curvature(gear)
      n = n_fillet + n_involute + 4
      if (gear%tip_rounding > 0) n = n + n_rounding + 1
      allocate (points(2, n))
      points(:, 1) = at(root, pi/gear%teeth)
      if (gear%cutter_teeth > 0) then
         do i = 0, n_fillet
            from = cutter_fillet(gear_cutter(gear), gear_cutter_fit(gear), int(gear%teeth), real(i, wp)/n_fillet)
            points(:, i + 2) = at(norm2(from), pi/gear%teeth - atan2(from(2), from(1)))
         end do
      else
         middle = pi/gear%teeth - ring_root_arc(int(gear%teeth), base, root, real(gear%tooth_angle, wp), &
                                                real(gear%fillet_radius, wp))
         centre = at(root - gear%fillet_radius, middle)
         from = at(root, middle) - centre
         do i = 0, n_fillet
            points(:, i + 2) = centre + turned_by(from, flank(form) - centre, real(i, wp)/n_fillet)
         end do
      end if
      n = n_fillet + 2
      do i = 1, n_involute
         points(:, n + i) = flank(form + (last - form)*i/n_involute)
      end do
      n = n + n_involute
      if (gear%tip_rounding > 0) then
         centre = at(tip + gear%tip_rounding, gear_tip_angle(gear))
         do i = 0, n_rounding
            points(:, n + i + 1) = centre + turned_by(flank(last) - centre, at(tip, gear_tip_angle(gear)) - centre, &
                                                      real(i, wp)/n_rounding)
         end do
         n = n + n_rounding + 1
      end if
      points(:, n + 1) = at(tip, gear_tip_angle(gear)/2)
      points(:, n + 2) = at(tip, 0.0_wp)
      points = -points

   contains

      !> Point of the involute at a radius of curvature.
      pure function flank(rho)
         real(wp), intent(in) :: rho !! > 0 [m]
         real(wp) :: flank(2)

         flank = at(hypot(base, rho), involute_of_tangent(rho/base) - gear%tooth_angle/2)
      end function flank

      pure function at(radius, angle)
         real(wp), intent(in) :: radius, angle
         real(wp) :: at(2)

         at = radius*[cos(angle), sin(angle)]
      end function at

      !> A vector turned by a share of the angle to another.
      pure function turned_by(one, other, share) result(vector)
         real(wp), intent(in) :: one(2), other(2), share
         real(wp) :: vector(2), angle

         angle = share*atan2(one(1)*other(2) - one(2)*other(1), dot_product(one, other))
         vector = [cos(angle)*one(1) - sin(angle)*one(2), sin(angle)*one(1) + cos(angle)*one(2)]
      end function turned_by

   end subroutine half_internal_tooth

end module evl_mesh_picture
