!> Tangential stress in the fillets of a tooth under unit loads on flanks of the wheel, by finite elements.
!>
!> Lengths are in modules. Stresses are Sigma, module times stress over line load: independent of the modulus of elasticity.
!> The right fillet is on the side of the loaded flank, the left one on the other side. The arc s along a fillet begins at the form
!> circle and ends on the root circle. Tension is positive.
module evl_fillet_stress
   use evl_cyclic_stress, only: stress_response
   use evl_influence_functions, only: add_flank_load, both_halves, refuse_fold, refuse_stiffness, sampled_range, widest
   use evl_kinds, only: wp
   use evl_lobatto, only: lagrange, lobatto_rule
   use evl_plane_element, only: elasticity_t
   use evl_sector_mesh, only: sector_mesh, sector_mesh_t
   use evl_status, only: status_t
   use evl_tooth_outline, only: involute_arc, involute_curvature, tooth_outline_t
   implicit none (type, external)
   private

   public :: edge_stress, fillet_angle, fillet_arc, flank_range, stress_of_elements, widest_from

   real(wp), parameter :: within_end = 0.98_wp !! half width of a load relative to its distance to the end of the involute
   integer, parameter :: newton_steps = 50

contains

   !> Arc of the fillet from the form circle to beta. Equation RS5.
   !>
   !> Valid: outline with a root arc; otherwise the fillet is longer by less than 0.001 modules
   elemental real(wp) function fillet_arc(outline, beta) result(s)
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: beta !! as of evl_tooth_outline [rad]

      s = from_root(outline, outline%fillet_start) - from_root(outline, beta)
   end function fillet_arc

   !> Arc of the fillet from the root circle.
   elemental real(wp) function from_root(outline, beta) result(s)
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: beta

      associate (t => tan(beta), r => outline%reference_radius)
         s = outline%rounding*(beta + outline%depth*t/r) + outline%depth**2/(2*r)*(t/cos(beta) + asinh(t))
      end associate
   end function from_root

   !> beta at an arc of the fillet.
   elemental real(wp) function fillet_angle(outline, s) result(beta)
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: s !! from 0 to the arc of the whole fillet
      real(wp) :: low, high
      integer :: step

      ! monotonic: bisection in the range, to the last bits
      low = 0
      high = outline%fillet_start
      do step = 1, newton_steps
         beta = (low + high)/2
         if (fillet_arc(outline, beta) > s) then
            low = beta
         else
            high = beta
         end if
      end do
   end function fillet_angle

   !> Tangential stress on a free side of an element as a functional of the displacements of its nodes. Equation RS2.
   pure function edge_stress(x, derivative, points, local, law) result(weights)
      real(wp), intent(in) :: x(0:)                 !! Gauss-Lobatto points
      real(wp), intent(in) :: derivative(0:, 0:)    !! at the points (derivative at, value at)
      real(wp), intent(in) :: points(:, 0:)         !! of the side (xy, point)
      real(wp), intent(in) :: local                 !! position from -1 to 1
      type(elasticity_t), intent(in) :: law
      real(wp) :: weights(2, 0:size(x) - 1), values(0:size(x) - 1), slopes(0:size(x) - 1), along(2)
      integer :: k

      values = lagrange(x, local)
      slopes = matmul(values, derivative)
      along = matmul(points, slopes)
      do k = 0, size(x) - 1
         weights(:, k) = law%plane_modulus*slopes(k)*along/sum(along**2)
      end do
   end function edge_stress

   !> Radii of curvature between which the elements support loads.
   subroutine flank_range(outline, hub_radius, p, low, high)
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: hub_radius
      integer, intent(in) :: p
      real(wp), intent(out) :: low, high
      type(sector_mesh_t) :: sector
      real(wp) :: ends(2)

      call sector_mesh(outline, hub_radius, p, sector)
      ends = sampled_range(outline, sector)
      low = ends(1)
      high = ends(2)
   end subroutine flank_range

   !> Stresses of tooth 0 at arcs of both fillets, under unit loads on tooth j. Equation RS1.
   !>
   !> Errors: code_invalid_input with subject_wheel if the outline cannot be meshed.
   subroutine stress_of_elements(outline, hub_radius, p, law, arcs, rho, last, right, left, status)
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: hub_radius            !! in modules
      integer, intent(in) :: p                      !! order of the elements
      type(elasticity_t), intent(in) :: law
      real(wp), intent(in) :: arcs(:)               !! of the fillet
      real(wp), intent(in) :: rho(:)                !! radii of curvature at the loads, inside the involute
      integer, intent(in) :: last                   !! largest |j|
      real(wp), intent(out), dimension(:, :, -last:) :: right, left !! Sigma (arc, load, j)
      type(status_t), intent(inout) :: status
      type(sector_mesh_t) :: sector
      real(wp), allocatable :: loads(:, :), halves(:, :, :)
      real(wp) :: s
      integer :: failed, k
      logical :: is_definite

      right = 0
      left = 0
      call sector_mesh(outline, hub_radius, p, sector)
      allocate (loads(2*sector%mesh%n_nodes, size(rho) + size(arcs)), source=0.0_wp)
      do k = 1, size(rho)
         s = involute_arc(outline, rho(k))
         call add_flank_load(outline, sector, s, load_width(outline, s), loads(:, k))
      end do
      do k = 1, size(arcs)
         call add_functional(outline, sector, arcs(k), law, loads(:, size(rho) + k))
      end do
      call both_halves(outline, sector, law, loads, halves, failed)
      if (failed > 0) then
         call refuse_fold(sector, failed, status)
         return
      end if
      is_definite = failed == 0
      if (is_definite) call stress_response(outline%teeth, 2*size(sector%cut) - 2, size(rho), halves(:, :, 1), halves(:, :, 2), &
                                            last, right, left, is_definite)
      if (.not. is_definite) call refuse_stiffness(status)
   end subroutine stress_of_elements

   !> Half width of a load at an arc of the involute from the base circle.
   elemental real(wp) function load_width(outline, s) result(width)
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: s

      width = min(widest, within_end*min(s - outline%s_form, outline%s_tip - s))
   end function load_width

   !> Radius of curvature where the half width of a load ceases to increase from the form circle on.
   pure real(wp) function widest_from(outline) result(rho)
      type(tooth_outline_t), intent(in) :: outline

      rho = involute_curvature(outline, outline%s_form + min(widest/within_end, (outline%s_tip - outline%s_form)/2))
   end function widest_from

   !> Stress at an arc of the fillet, as loads of the unknowns.
   pure subroutine add_functional(outline, sector, arc, law, functional)
      type(tooth_outline_t), intent(in) :: outline
      type(sector_mesh_t), intent(in) :: sector
      real(wp), intent(in) :: arc
      type(elasticity_t), intent(in) :: law
      real(wp), intent(inout) :: functional(:) !! of each unknown
      real(wp) :: x(0:sector%mesh%order), w(0:sector%mesh%order), d(0:sector%mesh%order, 0:sector%mesh%order), &
                  weights(2, 0:sector%mesh%order), beta
      integer :: side

      call lobatto_rule(x, w, d)
      beta = fillet_angle(outline, arc)
      side = 1
      do while (side < size(sector%fillet, 2) .and. sector%fillet_beta(side) > beta)
         side = side + 1
      end do
      associate (from => sector%fillet_beta(side - 1), to => sector%fillet_beta(side), nodes => sector%fillet(:, side))
         weights = edge_stress(x, d, sector%fillet_points(:, :, side), 2*(beta - from)/(to - from) - 1, law)
         functional(2*nodes - 1) = functional(2*nodes - 1) + weights(1, :)
         functional(2*nodes) = functional(2*nodes) + weights(2, :)
      end associate
   end subroutine add_functional

end module evl_fillet_stress
