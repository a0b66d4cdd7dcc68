!> Mesh position of a steady start.
!>
!> The position counts pitches of the first mesh in the power flow (see `first_mesh`), by the angle of its driving wheel. It does
!> not depend on the order of wheels and meshes in the case, nor on the reference wheel.
!>
!> Source: docs/theory/theory.md, section 9.
module evl_steady_position
   use evl_common_period, only: whole_pitches
   use evl_gearbox, only: gearbox_t
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: default_position, first_mesh, constraint_at, angle_constraint

   real(wp), parameter :: same = 1.0e-9_wp       !! relative tolerance for equal properties of meshes
   real(wp), parameter :: wide = 0.25_wp         !! minimum fraction of a pitch with one more pair for the default position
   real(wp), parameter :: margin = 0.05_wp       !! sufficient distance from every border [pitches]
   integer, parameter :: most_pitches = 64       !! limit of the search for a position, in pitches of the first mesh
   real(wp), parameter :: shares(5) = [1/2.0_wp, 3/8.0_wp, 5/8.0_wp, 1/4.0_wp, 3/4.0_wp] !! positions in the zone, in search order

   !> A wheel with a given angle.
   type :: angle_constraint
      integer :: wheel = 0              !! 0: theta is given
      real(wp) :: angle = 0.0_wp        !! angle of the wheel since the start of contact over its ratio [rad]
   end type angle_constraint

contains

   !> The mesh with the highest mesh frequency; if equal, the first in the power flow, then by geometry.
   pure integer function first_mesh(gearbox) result(first)
      type(gearbox_t), intent(in) :: gearbox
      integer :: depth(size(gearbox%pairs)), m

      depth = depths(gearbox)
      first = 1
      do m = 2, size(gearbox%pairs)
         if (precedes(properties(gearbox, m, depth(m)), properties(gearbox, first, depth(first)))) first = m
      end do
   end function first_mesh

   !> Number of meshes upstream of each mesh in the power flow; in a loop at most the number of meshes.
   pure function depths(gearbox) result(depth)
      type(gearbox_t), intent(in) :: gearbox
      integer :: depth(size(gearbox%pairs)), i, m, turn

      depth = 0
      do turn = 1, size(depth)
         do m = 1, size(depth)
            do i = 1, size(depth)
               if (gearbox%contacts(gearbox%first(i))%wheel_b /= gearbox%contacts(gearbox%first(m))%wheel_a) cycle
               depth(m) = min(max(depth(m), depth(i) + 1), size(depth))
            end do
         end do
      end do
   end function depths

   !> Properties by which meshes are sorted.
   pure function properties(gearbox, mesh, depth) result(list)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh, depth
      real(wp) :: list(12)

      associate (contact => gearbox%contacts(gearbox%first(mesh)))
         associate (a => gearbox%wheels(contact%wheel_a), b => gearbox%wheels(contact%wheel_b))
            list = [-abs(pitches_per_radian(gearbox, mesh)), real(depth, wp), abs(a%base_radius), abs(b%base_radius), &
                    contact%width, a%axial_position, a%centre, b%centre, a%inertia, b%inertia]
         end associate
      end associate
   end function properties

   !> Whether one list sorts before another; numbers equal within the tolerance are skipped.
   pure logical function precedes(a, b)
      real(wp), intent(in) :: a(:), b(:)
      integer :: i

      precedes = .false.
      do i = 1, size(a)
         if (abs(a(i) - b(i)) <= same*max(abs(a(i)), abs(b(i)))) cycle
         precedes = a(i) < b(i)
         return
      end do
   end function precedes

   !> Pitches of a mesh per radian of the reference wheel.
   pure real(wp) function pitches_per_radian(gearbox, mesh)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh

      associate (contact => gearbox%contacts(gearbox%first(mesh)))
         pitches_per_radian = contact%pair%advance/contact%base_pitch
      end associate
   end function pitches_per_radian

   !> Wheel angle for a position: pitches of pair 0 of the first mesh from the start of contact, by the angle of the driving wheel.
   pure type(angle_constraint) function constraint_at(gearbox, position) result(constraint)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in) :: position !! [pitches]
      integer :: m

      m = first_mesh(gearbox)
      associate (contact => gearbox%contacts(gearbox%first(m)))
         constraint%wheel = contact%wheel_a
         constraint%angle = (position - (contact%rho_start - contact%rho_entry)/contact%base_pitch)/pitches_per_radian(gearbox, m)
      end associate
   end function constraint_at

   !> A position within a zone of the first mesh, with no other mesh at a border: the middle of the zone with one additional pair if
   !> that zone is at least a quarter of a pitch, else of the zone with fewer pairs. Other meshes have the positions of a given
   !> state; whole pitches of the first mesh are added and, if these do not suffice, other positions in the zone are tried.
   pure real(wp) function default_position(gearbox, y) result(position)
      type(gearbox_t), intent(in) :: gearbox
      real(wp), intent(in), optional :: y(:) !! state whose deviations are used; absent: those of the unloaded gearbox
      real(wp) :: zone(2), best, least, x
      integer :: first, i, m, n, whole

      first = first_mesh(gearbox)
      zone = best_zone(gearbox, first)
      position = sum(zone)/2
      if (size(gearbox%pairs) == 1 .or. .not. present(y)) return
      n = int(min(whole_pitches(gearbox, first), int(most_pitches, kind(whole_pitches(gearbox, first)))))
      best = 0
      do i = 1, size(shares)
         do whole = 0, n - 1
            x = zone(1) + shares(i)*(zone(2) - zone(1)) + whole
            least = 1
            do m = 1, size(gearbox%pairs)
               least = min(least, distance_to_border(gearbox, m, position_there(gearbox, first, m, x, y)))
            end do
            if (least <= best + same) cycle
            best = least
            position = x
            if (best >= margin) return
         end do
      end do
   end function default_position

   !> Fractional part of the contact ratio: the fraction of a pitch with one additional pair.
   pure real(wp) function more_pairs_share(gearbox, mesh) result(share)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh

      associate (ratio => gearbox%pairs(mesh)%contact_ratio)
         share = max(ratio - floor(ratio + same), 0.0_wp)
      end associate
   end function more_pairs_share

   !> Zone of the default position, in pitches after the entry of a pair.
   pure function best_zone(gearbox, mesh) result(zone)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      real(wp) :: zone(2)

      associate (more => more_pairs_share(gearbox, mesh))
         zone = [more, 1.0_wp]
         if (more >= wide .or. gearbox%pairs(mesh)%contact_ratio < 1 - same) zone = [0.0_wp, more]
      end associate
   end function best_zone

   !> Position of a mesh when the first mesh has the position x.
   pure real(wp) function position_there(gearbox, first, mesh, x, y) result(position)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: first, mesh
      real(wp), intent(in) :: x, y(:)
      type(angle_constraint) :: constraint

      constraint = constraint_at(gearbox, x)
      associate (contact => gearbox%contacts(gearbox%first(mesh)), wheel => gearbox%contacts(gearbox%first(first))%wheel_a)
         position = (contact%rho_start - contact%rho_entry)/contact%base_pitch + pitches_per_radian(gearbox, mesh) &
                    *(constraint%angle + turned(gearbox, contact%wheel_a, y) - turned(gearbox, wheel, y))
      end associate
   end function position_there

   !> Deviation of a wheel's angle, over its ratio [rad].
   pure real(wp) function turned(gearbox, wheel, y)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: wheel
      real(wp), intent(in) :: y(:)

      turned = 0
      associate (w => gearbox%wheels(wheel))
         if (w%i_psi > 0) turned = y(w%i_psi)/w%ratio
      end associate
   end function turned

   !> Distance of a position from the nearest entry or exit of a pair [pitches].
   pure real(wp) function distance_to_border(gearbox, mesh, position) result(distance)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh
      real(wp), intent(in) :: position

      distance = min(abs(position - anint(position)), &
                     abs(position - more_pairs_share(gearbox, mesh) - anint(position - more_pairs_share(gearbox, mesh))))
   end function distance_to_border

end module evl_steady_position
