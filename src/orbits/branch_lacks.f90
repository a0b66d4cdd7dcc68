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
   use evl_shooting, only: move_orbit, orbit_options, orbit_t
   implicit none (type, external)
   private

   public :: lacks_t, learn_lack, orbit_beside_curve

   integer, parameter :: most_used = 6 !! of the known ones

   type :: lacks_t
      integer :: n = 0
      real(wp), allocatable :: w(:)    !! [.. n]
      real(wp), allocatable :: q(:, :) !! [n_states + 2, .. n]
      real(wp), allocatable :: derivative(:, :) !! [n_states, n_states] of the flow: what it lacks over w (1 - w), at the last one
   end type lacks_t

contains

   !> What is to be the orbit at a value of the parameter between the two of a curve: on it, with what that lacks.
   pure subroutine orbit_beside_curve(model, options, curve, lacks, first, value, orbit)
      class(orbit_model), intent(in) :: model
      type(orbit_options), intent(in) :: options
      type(curve_t), intent(in) :: curve       !! not straight
      type(lacks_t), intent(in) :: lacks
      type(orbit_t), intent(in) :: first
      real(wp), intent(in) :: value
      type(orbit_t), intent(out) :: orbit
      real(wp) :: share ! of the way to the second one
      integer :: near(min(lacks%n, most_used)), i

      share = share_at([integer ::])
      near = nearest(lacks, share, size(near))
      share = share_at(near)
      call orbit_on_curve(model, options, curve, first, share*curve%way, orbit)
      call move_orbit(model, options, orbit, [(lack_at(lacks, near, share, i), i=1, model%n + 2)])
      if (lacks%n > 0) orbit%flow%derivative = orbit%flow%derivative + share*(1 - share)*lacks%derivative

   contains

      !> Where the parameter has that value: halving, since it rises or falls between the two.
      pure real(wp) function share_at(known) result(middle)
         integer, intent(in) :: known(:)
         integer, parameter :: halvings = 50
         real(wp) :: below, above, change, there
         integer :: k

         change = (value - first%parameter)/options%parameter_scale
         below = 0
         above = 1
         do k = 1, halvings
            middle = (below + above)/2
            there = change_on_curve(curve, middle*curve%way, model%n + 2) + lack_at(lacks, known, middle, model%n + 2)
            if (sign(there, there*change) < abs(change)) then
               below = middle
            else
               above = middle
            end if
         end do
      end function share_at

   end subroutine orbit_beside_curve

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
      real(wp), allocatable :: w(:), q(:, :)
      real(wp) :: lack(model%n + 2), share, way

      way = dot_product(curve%tangent, way_to(model, options, first, found))
      call orbit_on_curve(model, options, curve, first, way, foreseen)
      share = way/curve%way
      lack = way_to(model, options, foreseen, found)
      size_of = norm2(lack)
      if (.not. allocated(lacks%w)) allocate (lacks%w(most_used), lacks%q(model%n + 2, most_used))
      if (error > merge(worth, too_much, lacks%n > few)*size_of) lacks%n = 0
      if (lacks%n == size(lacks%w)) then
         allocate (w(2*lacks%n), q(model%n + 2, 2*lacks%n))
         w(:lacks%n) = lacks%w
         q(:, :lacks%n) = lacks%q
         call move_alloc(w, lacks%w)
         call move_alloc(q, lacks%q)
      end if
      lacks%n = lacks%n + 1
      lacks%w(lacks%n) = share
      lacks%q(:, lacks%n) = lack/(share*(1 - share))
      lacks%derivative = (found%flow%derivative - foreseen%flow%derivative)/(share*(1 - share))
   end subroutine learn_lack

   !> The known ones that are nearest.
   pure function nearest(lacks, share, n) result(near)
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
   end function nearest

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
