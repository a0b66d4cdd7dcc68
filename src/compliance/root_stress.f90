!> Tangential stress in the fillets of a tooth by unit line loads on the flanks of the wheel, as polynomials of the position of the
!> load at several arcs of the fillet. Stress over line load: 1/m.
!>
!> The right fillet of a tooth is on the side of its right flank, the left one on the other side. A load on a left flank is the
!> mirror image of one on a right flank. Tension is positive. The stress of a tooth is the sum over all pairs of line load times
!> these values; its extremes over the arc follow from `fillet_extremes`.
!>
!> Between `low` and `high` the functions are Chebyshev polynomials in rho, two for the own tooth. They continue linearly to both
!> ends of the involute, and are constant beyond it.
module evl_root_stress
   use evl_chebyshev, only: chebyshev_coefficients
   use evl_kinds, only: pi, wp
   use evl_stress_samples, only: n_arcs, n_loads_far, n_loads_high, n_loads_low, n_loads_near, n_near, &
                                 stress_samples_t
   use evl_tooth_outline, only: tooth_outline_t
   implicit none (type, external)
   private

   public :: fillet_extremes, root_stress, root_stress_from_samples, root_stress_t, stress_at_arc, stress_at_points

   integer, parameter, public :: right_flank = 1, left_flank = 2
   integer, parameter :: n_search = 64 !! intervals in which extremes are located
   integer, parameter, public :: n_root_points = 33 !! equidistant points of a fillet, from the first to the last arc
   integer, parameter :: most_loads = max(n_loads_low, n_loads_high, n_loads_near, n_loads_far)
   integer :: i_point, i_term
   !> T_k (first index) at the equidistant positions of the search.
   real(wp), parameter :: at_search(0:n_arcs, 0:n_search) = &
                          reshape([((cos(i_term*acos(2*real(i_point, wp)/n_search - 1)), i_term=0, n_arcs), i_point=0, n_search)], &
                                  [n_arcs + 1, n_search + 1])
   !> Weights of the values at the arcs (first index) in the coefficients, as in `chebyshev_coefficients`.
   real(wp), parameter :: to_coefficients(0:n_arcs, 0:n_arcs) = &
                          reshape([((merge(0.5_wp, 1.0_wp, i_point == 0 .or. i_point == n_arcs) &
                                     *merge(1.0_wp, 2.0_wp, i_term == 0 .or. i_term == n_arcs) &
                                     *cos(pi*i_term*(n_arcs - i_point)/n_arcs)/n_arcs, i_point=0, n_arcs), i_term=0, n_arcs)], &
                                  [n_arcs + 1, n_arcs + 1])

   !> Influence functions of a wheel.
   type :: root_stress_t
      logical :: exists = .false.
      integer :: teeth = 0
      real(wp) :: low = 0, border = 0, high = 0 !! limits of the polynomials; border of both parts of the own tooth [m]
      real(wp) :: form = 0, tip = 0          !! radii of curvature at both ends of the involute [m]
      real(wp) :: arcs(0:n_arcs) = 0         !! from the form circle [m]
      real(wp) :: normal_module = 0          !! [m]
      type(tooth_outline_t) :: outline       !! in modules
      real(wp), allocatable :: own_low(:, :, :), own_high(:, :, :) !! coefficients (degree, arc, fillet) [1/m]
      real(wp), allocatable :: near(:, :, :, :), far(:, :, :, :)   !! likewise (degree, arc, fillet, loaded tooth)
   end type root_stress_t

   !> Extremes of the stress over the arc of a fillet.
   type, public :: fillet_extremes_t
      real(wp) :: largest = 0, least = 0       !! unit of the values
      real(wp) :: at_largest = 0, at_least = 0 !! arcs [m]
   end type fillet_extremes_t

contains

   !> Influence functions from samples in modules.
   subroutine root_stress_from_samples(samples, outline, normal_module, wheel)
      type(stress_samples_t), intent(in) :: samples
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: normal_module !! [m]
      type(root_stress_t), intent(out) :: wheel
      integer :: i, side, j

      wheel%exists = .true.
      wheel%teeth = outline%teeth
      wheel%normal_module = normal_module
      wheel%outline = outline
      wheel%low = normal_module*samples%low
      wheel%border = normal_module*samples%border
      wheel%high = normal_module*samples%high
      wheel%form = normal_module*outline%rho_form
      wheel%tip = normal_module*outline%rho_tip
      wheel%arcs = normal_module*samples%arcs
      allocate (wheel%own_low(0:n_loads_low, 0:n_arcs, 2), wheel%own_high(0:n_loads_high, 0:n_arcs, 2), &
                wheel%near(0:n_loads_near, 0:n_arcs, 2, -n_near:n_near), &
                wheel%far(0:n_loads_far, 0:n_arcs, 2, wheel%teeth - 1))
      do side = 1, 2
         do i = 0, n_arcs
            wheel%own_low(:, i, side) = chebyshev_coefficients(samples%own_low(i, :, side)/normal_module)
            wheel%own_high(:, i, side) = chebyshev_coefficients(samples%own_high(i, :, side)/normal_module)
            do j = -n_near, n_near
               wheel%near(:, i, side, j) = chebyshev_coefficients(samples%near(i, :, side, j)/normal_module)
            end do
            do j = 1, wheel%teeth - 1
               wheel%far(:, i, side, j) = chebyshev_coefficients(samples%far(i, :, side, j)/normal_module)
            end do
         end do
      end do
   end subroutine root_stress_from_samples

   !> Stresses at all arcs of both fillets of tooth 0 by a unit line load on a flank of tooth j. Equations RS1, RS3.
   !>
   !> Valid: any rho and j; j counts toward the side that the right flank faces, also for loads on left flanks
   pure subroutine root_stress(wheel, flank, rho, j, right, left)
      type(root_stress_t), intent(in) :: wheel
      integer, intent(in) :: flank  !! right_flank, left_flank
      real(wp), intent(in) :: rho   !! radius of curvature at the load [m]
      integer, intent(in) :: j
      real(wp), intent(out), dimension(0:n_arcs) :: right, left !! [1/m]
      real(wp) :: stress(0:n_arcs, 2), terms(0:most_loads), inside, from, to
      integer :: tooth, turned, i, side

      right = 0
      left = 0
      if (.not. wheel%exists) return
      ! the mirror image of a load on a left flank
      tooth = merge(j, -j, flank == right_flank)
      turned = modulo(tooth, wheel%teeth)
      if (wheel%teeth - turned < turned) turned = turned - wheel%teeth
      inside = min(max(rho, wheel%low), wheel%high)
      from = merge(wheel%border, wheel%low, turned == 0 .and. rho > wheel%border)
      to = merge(wheel%border, wheel%high, turned == 0 .and. .not. rho > wheel%border)
      terms = chebyshev_terms((2*inside - from - to)/(to - from), 2*(min(max(rho, wheel%form), wheel%tip) - inside)/(to - from))
      do side = 1, 2
         do i = 0, n_arcs
            if (turned == 0 .and. rho > wheel%border) then
               stress(i, side) = dot_product(wheel%own_high(:, i, side), terms(:n_loads_high))
            else if (turned == 0) then
               stress(i, side) = dot_product(wheel%own_low(:, i, side), terms(:n_loads_low))
            else if (abs(turned) <= n_near) then
               stress(i, side) = dot_product(wheel%near(:, i, side, turned), terms(:n_loads_near))
            else
               stress(i, side) = dot_product(wheel%far(:, i, side, modulo(tooth, wheel%teeth)), terms(:n_loads_far))
            end if
         end do
      end do
      right = stress(:, merge(1, 2, flank == right_flank))
      left = stress(:, merge(2, 1, flank == right_flank))
   end subroutine root_stress

   !> Largest and least stress over the arc, from the values at all arcs.
   pure type(fillet_extremes_t) function fillet_extremes(wheel, stress) result(extremes)
      type(root_stress_t), intent(in) :: wheel
      real(wp), intent(in) :: stress(0:n_arcs)
      real(wp) :: a(0:n_arcs), values(0:n_search), x
      integer :: k

      do k = 0, n_arcs
         a(k) = dot_product(to_coefficients(:, k), stress)
      end do
      do k = 0, n_search
         values(k) = dot_product(at_search(:, k), a)
      end do
      x = vertex(values)
      extremes%largest = chebyshev_at(a, x)
      extremes%at_largest = arc_of(wheel, x)
      x = vertex(-values)
      extremes%least = chebyshev_at(a, x)
      extremes%at_least = arc_of(wheel, x)
   end function fillet_extremes

   !> Stress at the equidistant points of a fillet, from the values at all arcs.
   pure function stress_at_points(stress) result(values)
      real(wp), intent(in) :: stress(0:n_arcs)
      real(wp) :: values(n_root_points)
      integer, parameter :: every = n_search/(n_root_points - 1)
      real(wp) :: a(0:n_arcs)
      integer :: k

      do k = 0, n_arcs
         a(k) = dot_product(to_coefficients(:, k), stress)
      end do
      do k = 1, n_root_points
         values(k) = dot_product(at_search(:, every*(k - 1)), a)
      end do
   end function stress_at_points

   !> Stress at an arc between the first and the last one, from the values at all arcs.
   pure real(wp) function stress_at_arc(wheel, stress, arc) result(value)
      type(root_stress_t), intent(in) :: wheel
      real(wp), intent(in) :: stress(0:n_arcs)
      real(wp), intent(in) :: arc !! [m]
      real(wp) :: x

      x = (2*arc - wheel%arcs(0) - wheel%arcs(n_arcs))/(wheel%arcs(n_arcs) - wheel%arcs(0))
      value = chebyshev_at(chebyshev_coefficients(stress), x)
   end function stress_at_arc

   !> Arc at a position from -1 to 1.
   pure real(wp) function arc_of(wheel, x) result(arc)
      type(root_stress_t), intent(in) :: wheel
      real(wp), intent(in) :: x

      arc = wheel%arcs(0) + (wheel%arcs(n_arcs) - wheel%arcs(0))*(1 + x)/2
   end function arc_of

   !> Position of the maximum of equidistant values from -1 to 1: vertex of the parabola at the largest one.
   pure real(wp) function vertex(values) result(x)
      real(wp), intent(in) :: values(0:n_search)
      real(wp) :: bend, shift
      integer :: k

      k = maxloc(values, dim=1) - 1
      shift = 0
      if (k > 0 .and. k < n_search) then
         bend = values(k - 1) - 2*values(k) + values(k + 1)
         if (bend < 0) shift = (values(k - 1) - values(k + 1))/(2*bend)
      end if
      x = 2*(k + shift)/n_search - 1
   end function vertex

   !> Sum of a_k T_k(x).
   pure real(wp) function chebyshev_at(a, x) result(value)
      real(wp), intent(in) :: a(0:n_arcs), x
      real(wp) :: terms(0:most_loads)

      terms = chebyshev_terms(x, 0.0_wp)
      value = dot_product(a, terms(:n_arcs))
   end function chebyshev_at

   !> T_k(x), plus its slope times a distance, by T_k+1 = 2 x T_k - T_k-1.
   pure function chebyshev_terms(x, distance) result(terms)
      real(wp), intent(in) :: x, distance
      real(wp) :: terms(0:most_loads), slopes(0:most_loads)
      integer :: k

      terms(:1) = [1.0_wp, x]
      slopes(:1) = [0.0_wp, 1.0_wp]
      do k = 1, most_loads - 1
         terms(k + 1) = 2*x*terms(k) - terms(k - 1)
         slopes(k + 1) = 2*terms(k) + 2*x*slopes(k) - slopes(k - 1)
      end do
      terms = terms + distance*slopes
   end function chebyshev_terms

end module evl_root_stress
