!> What the cubic between two orbits of a branch lacks: orbits that are found tell it, and the next ones are foreseen the better.
!>
!> The cubic has both orbits, so it lacks w (1 - w) q(w), w from 0 to 1 between them, with a smooth q. It has their tangents,
!> too, but these are differences, and a lack like w**2 (1 - w)**2 q(w) would give q their errors over w near the ends. Each orbit
!> that is found tells a value of q, also one before the first, as long as the branch is smooth there; q is the polynomial through
!> the nearest. The derivative of the flow lacks something as well, in the same way; the last one that is known tells it.
module evl_branch_lacks
   use evl_branch_curve, only: change_on_curve, curve_t, orbit_on_curve, way_to
   use evl_kinds, only: wp
   use evl_orbit_model, only: orbit_model
   use evl_periodic_orbit, only: move_orbit, orbit_options, orbit_t
   implicit none (type, external)
   private

   public :: lacks_t, learn_from_before, learn_lack, orbit_beside_curve, way_of_value

   integer, parameter :: most_used = 6 !! of the known ones

   type :: lacks_t
      integer :: n = 0
      real(wp), allocatable :: w(:)    !! [.. n]
      real(wp), allocatable :: q(:, :) !! [n_states + 2, .. n]
      real(wp), allocatable :: derivative(:, :) !! [n_states, n_states] of the flow: what it lacks over w (1 - w), at the last one
   end type lacks_t

contains

   !> What is to be the orbit some way along a curve: on it, with what that lacks.
   pure subroutine orbit_beside_curve(model, options, curve, lacks, first, way, orbit)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve
      type(lacks_t), intent(in) :: lacks
      type(orbit_t), intent(in) :: first
      real(wp), intent(in) :: way
      type(orbit_t), intent(out) :: orbit
      real(wp) :: share
      integer :: near(min(lacks%n, most_used)), i

      call orbit_on_curve(model, options, curve, first, way, orbit)
      if (lacks%n == 0) return
      share = way/curve%way
      near = those_near(lacks, share, size(near))
      call move_orbit(model, options, orbit, [(lack_at(lacks, near, share, i), i=1, model%n + 2)])
      orbit%flow%derivative = orbit%flow%derivative + share*(1 - share)*lacks%derivative
   end subroutine orbit_beside_curve

   !> The way along a curve to where the parameter has a value between those of its two orbits.
   pure real(wp) function way_of_value(options, curve, lacks, first, value) result(way)
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve       !! not straight
      type(lacks_t), intent(in) :: lacks
      type(orbit_t), intent(in) :: first
      real(wp), intent(in) :: value

      way = curve%way*share_with(those_near(lacks, share_with([integer ::]), min(lacks%n, most_used)))

   contains

      !> Halving, since the parameter rises or falls between the two.
      pure real(wp) function share_with(near) result(middle)
         integer, intent(in) :: near(:)
         integer, parameter :: halvings = 50
         real(wp) :: below, above, change, there
         integer :: k, p

         p = size(curve%tangent)
         change = (value - first%parameter)/options%parameter_scale
         below = 0
         above = 1
         do k = 1, halvings
            middle = (below + above)/2
            there = change_on_curve(curve, middle*curve%way, p) + lack_at(lacks, near, middle, p)
            if (sign(there, there*change) < abs(change)) then
               below = middle
            else
               above = middle
            end if
         end do
      end function share_with

   end function way_of_value

   !> Remember what a curve lacks at an orbit that was found. If what was known has foreseen it no better than the curve alone, as
   !> behind a corner, that is forgotten.
   pure subroutine learn_lack(model, options, curve, first, found, error, lacks, size_of)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve      !! not straight
      type(orbit_t), intent(in) :: first, found
      real(wp), intent(in) :: error           !! how far it is from where it was foreseen, in units of the scales
      type(lacks_t), intent(inout) :: lacks
      real(wp), intent(out) :: size_of        !! how far it is from the curve
      real(wp), parameter :: worth = 0.1_wp, too_much = 10 !! error over that, of what is known, and of a few
      integer, parameter :: few = 2
      type(orbit_t) :: foreseen
      real(wp) :: lack(model%n + 2), share

      call compare(model, options, curve, first, found, foreseen, share, lack)
      size_of = norm2(lack)
      if (error > merge(worth, too_much, lacks%n > few)*size_of) lacks%n = 0
      call keep(lacks, share, lack/(share*(1 - share)))
      lacks%derivative = (found%flow%derivative - foreseen%flow%derivative)/(share*(1 - share))
   end subroutine learn_lack

   !> Remember what a curve lacks behind its first orbit, as far as the branch is smooth there.
   pure subroutine learn_from_before(model, options, curve, before, told, first, lacks)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve      !! not straight
      type(orbit_t), intent(in) :: before     !! the point before the first, with its derivative
      type(orbit_t), intent(in) :: told(:)    !! between these two; no more than their states are used
      type(orbit_t), intent(in) :: first
      type(lacks_t), intent(inout) :: lacks
      real(wp), parameter :: near = 0.05_wp   !! of the way: what is lacking so near to the first one is rounding
      type(orbit_t) :: foreseen
      real(wp) :: lack(model%n + 2), share
      integer :: i

      call compare(model, options, curve, first, before, foreseen, share, lack)
      call keep(lacks, share, lack/(share*(1 - share)))
      lacks%derivative = (before%flow%derivative - foreseen%flow%derivative)/(share*(1 - share))
      do i = 1, size(told)
         call compare(model, options, curve, first, told(i), foreseen, share, lack)
         if (share < -near) call keep(lacks, share, lack/(share*(1 - share)))
      end do
   end subroutine learn_from_before

   !> What a curve lacks at an orbit.
   pure subroutine compare(model, options, curve, first, found, foreseen, share, lack)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve
      type(orbit_t), intent(in) :: first, found
      type(orbit_t), intent(out) :: foreseen  !! on the curve
      real(wp), intent(out) :: share, lack(:) !! of the way to its second orbit; [n + 2]
      real(wp) :: way

      way = dot_product(curve%tangent, way_to(model, options, first, found))
      share = way/curve%way
      call orbit_on_curve(model, options, curve, first, way, foreseen)
      lack = way_to(model, options, foreseen, found)
   end subroutine compare

   !> Put a value of q at the end of those that are known.
   pure subroutine keep(lacks, share, value)
      type(lacks_t), intent(inout) :: lacks
      real(wp), intent(in) :: share, value(:)
      real(wp), allocatable :: w(:), q(:, :)

      if (.not. allocated(lacks%w)) allocate (lacks%w(most_used), lacks%q(size(value), most_used))
      if (lacks%n == size(lacks%w)) then
         allocate (w(2*lacks%n), q(size(value), 2*lacks%n))
         w(:lacks%n) = lacks%w
         q(:, :lacks%n) = lacks%q
         call move_alloc(w, lacks%w)
         call move_alloc(q, lacks%q)
      end if
      lacks%n = lacks%n + 1
      lacks%w(lacks%n) = share
      lacks%q(:, lacks%n) = value
   end subroutine keep

   !> The known ones that are nearest.
   pure function those_near(lacks, share, n) result(near)
      type(lacks_t), intent(in) :: lacks
      real(wp), intent(in) :: share
      integer, intent(in) :: n
      integer :: near(n), k
      real(wp) :: distance(lacks%n)

      if (n > 0) distance = abs(lacks%w(:lacks%n) - share)
      do k = 1, n
         near(k) = minloc(distance, 1)
         distance(near(k)) = huge(distance)
      end do
   end function those_near

   !> What is lacking of one of the unknowns, by the polynomial through some of those that are known.
   pure real(wp) function lack_at(lacks, near, share, row) result(lack)
      type(lacks_t), intent(in) :: lacks
      integer, intent(in) :: near(:), row
      real(wp), intent(in) :: share
      real(wp) :: basis
      integer :: i, k

      lack = 0
      do k = 1, size(near)
         basis = 1
         do i = 1, size(near)
            if (i /= k) basis = basis*(share - lacks%w(near(i)))/(lacks%w(near(k)) - lacks%w(near(i)))
         end do
         lack = lack + basis*lacks%q(row, near(k))
      end do
      lack = share*(1 - share)*lack
   end function lack_at

end module evl_branch_lacks
