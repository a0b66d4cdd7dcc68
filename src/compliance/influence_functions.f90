!> Influence functions of a wheel by spectral elements: c at Chebyshev points of the flank, c_j at pairs of them, for E = 1.
!>
!> At each position, the flank of tooth 0 is loaded by the smooth load of half width w, and by one of half width w/sqrt 2. The mean
!> displacement u_w under the load itself, less the contribution of the load's shape, is c except for an error of order w^2. Two
!> widths eliminate that error:
!>
!>    c_w = u_w - K (-ln w + e_1) - q w e_2/rho + K (1 - ln 2 rho),   c = 2 c_{w/sqrt 2} - c_w + (ln 2/18) K (w/rho)^2
!>
!> with K = 2/(pi E'), e_1 and e_2 the moments of -ln|x-y| and |x-y| under the load's shape; q is the tangential part of Flamant's
!> solution on a curved surface. c_j requires no correction, since the load on another tooth is far away.
module evl_influence_functions
   use evl_chebyshev, only: chebyshev_points
   use evl_cyclic_wheel, only: turn_to_polar, wheel_response
   use evl_front, only: condense
   use evl_kinds, only: pi, wp
   use evl_lobatto, only: gauss_rule, lagrange, lobatto_rule
   use evl_number_text, only: number_length
   use evl_plane_element, only: elasticity_t
   use evl_sector_mesh, only: sector_mesh, sector_mesh_t
   use evl_status, only: code_invalid_input, fail, status_t, subject_wheel
   use evl_tooth_outline, only: involute_arc, involute_curvature, involute_normal, tooth_outline_t
   implicit none (type, external)
   private

   public :: add_flank_load, both_halves, compute_influence, finish_own_tooth, influence_t, refuse_fold, refuse_stiffness, &
             sampled_range

   integer, parameter, public :: influence_version = 2 !! of this method: increase it if any bit of its results changes
   integer, parameter, public :: n_own = 16    !! intervals of c's points
   integer, parameter, public :: n_other = 8   !! intervals of c_j's points, which are every second point of c
   integer, parameter, public :: n_neighbours = 3 !! j = 1 .. 3
   integer, parameter :: n_gauss = 14          !! points of the part of a load on one side
   real(wp), parameter, public :: widest = 0.25_wp !! w in modules
   real(wp), parameter :: mean_logarithm = 1.3628052003925655_wp, mean_distance = 0.3807303807_wp !! e_1, e_2

   !> Samples, in modules and for E = 1.
   type :: influence_t
      real(wp) :: rho(0:n_own) = 0                                   !! radii of curvature
      real(wp) :: own(0:n_own) = 0                                   !! E c
      real(wp) :: other(0:n_other, 0:n_other, -n_neighbours:n_neighbours) = 0 !! E c_j (on tooth 0, on tooth j, j)
   end type influence_t

contains

   !> Compute the influence functions of a wheel fixed at its hub. Equation C1.
   !>
   !> Errors: code_invalid_input with subject_wheel if the outline cannot be meshed.
   subroutine compute_influence(outline, hub_radius, p, law, influence, status)
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: hub_radius !! in modules
      integer, intent(in) :: p           !! order of the elements
      type(elasticity_t), intent(in) :: law
      type(influence_t), intent(out) :: influence
      type(status_t), intent(inout) :: status
      type(sector_mesh_t) :: sector
      real(wp), allocatable :: loads(:, :), halves(:, :, :), response(:, :, :)
      real(wp) :: widths(0:n_own)
      integer :: failed, j
      logical :: is_definite

      call sector_mesh(outline, hub_radius, p, sector)
      call set_loads(outline, sector, influence%rho, widths, loads)
      call both_halves(outline, sector, law, loads, halves, failed)
      if (failed > 0) then
         call refuse_fold(sector, failed, status)
         return
      end if
      allocate (response(size(loads, 2), size(loads, 2), 0:n_neighbours))
      is_definite = failed == 0
      if (is_definite) call wheel_response(outline%teeth, 2*size(sector%cut) - 2, halves(:, :, 1), halves(:, :, 2), response, &
                                           is_definite)
      if (.not. is_definite) then
         call refuse_stiffness(status)
         return
      end if
      !GCC$ novector ! of the C library's logarithms, whose bits are others
      do j = 0, n_own
         influence%own(j) = finish_own_tooth(response(j + 1, j + 1, 0), response(n_own + j + 2, n_own + j + 2, 0), widths(j), &
                                             influence%rho(j), law)
      end do
      ! displaced on tooth 0, loaded on tooth j: equivalent to displaced on tooth -j, loaded on tooth 0
      do j = 1, n_neighbours
         influence%other(:, :, -j) = response(1:n_own + 1:2, 1:n_own + 1:2, j)
         influence%other(:, :, j) = transpose(response(1:n_own + 1:2, 1:n_own + 1:2, j))
      end do
   end subroutine compute_influence

   !> E c from the mean displacements under both widths. Equation C3.
   elemental real(wp) function finish_own_tooth(wide, narrow, w, rho, law) result(c)
      real(wp), intent(in) :: wide, narrow !! mean displacement with w, with w/sqrt 2
      real(wp), intent(in) :: w, rho
      type(elasticity_t), intent(in) :: law
      real(wp) :: k

      k = 2/pi/law%plane_modulus
      c = 2*one_width(narrow, w/sqrt(2.0_wp)) - one_width(wide, w) + log(2.0_wp)/18*k*(w/rho)**2

   contains

      !> c_w. Equation C3.
      pure real(wp) function one_width(mean, half)
         real(wp), intent(in) :: mean, half

         one_width = mean - k*(mean_logarithm - log(half)) - law%tangential*half*mean_distance/rho + k*(1 - log(2*rho))
      end function one_width

   end function finish_own_tooth

   !> Fail because the stiffness is not positive definite.
   subroutine refuse_stiffness(status)
      type(status_t), intent(inout) :: status

      call fail(status, code_invalid_input, "the stiffness of a tooth sector is not positive definite, so its compliance" &
                //" is undefined; try another 'order' or hub_diameter", subject_wheel, field="compliance")
   end subroutine refuse_stiffness

   !> Fail because an element is degenerate; name the part of the outline.
   subroutine refuse_fold(sector, e, status)
      type(sector_mesh_t), intent(in) :: sector
      integer, intent(in) :: e
      type(status_t), intent(inout) :: status
      character(len=number_length) :: which

      write (which, "(i0)") e
      call fail(status, code_invalid_input, "no mesh fits the tooth: element "//trim(which)//", "//trim(part_of(sector, e)) &
                //", would fold over; choose a larger root fillet, another profile shift, or compliance.model: analytic", &
                subject_wheel, field="compliance")
   end subroutine refuse_fold

   !> Part of a sector that contains an element.
   pure function part_of(sector, e) result(text)
      type(sector_mesh_t), intent(in) :: sector
      integer, intent(in) :: e
      character(len=30) :: text

      associate (row => sector%row(e))
         if (row == 1) then
            text = "at the tip"
         else if (row <= sector%row_form) then
            text = "at the involute"
         else if (row <= sector%row_fillet) then
            text = "at the fillet's upper half"
         else if (row <= sector%row_deep) then
            text = "under the fillet and the root"
         else
            text = "in the rings of the body"
         end if
      end associate
   end function part_of

   !> Positions of the loads, their widths, and the nodal loads: wide loads first.
   subroutine set_loads(outline, sector, rho, widths, loads)
      type(tooth_outline_t), intent(in) :: outline
      type(sector_mesh_t), intent(in) :: sector
      real(wp), intent(out) :: rho(0:n_own), widths(0:n_own)
      real(wp), allocatable, intent(out) :: loads(:, :)
      real(wp) :: s(0:n_own), ends(2)
      integer :: k

      ends = sampled_range(outline, sector)
      rho = chebyshev_points(n_own, ends(1), ends(2))
      s = involute_arc(outline, rho)
      widths = min(widest, s - outline%s_form, outline%s_tip - s)
      allocate (loads(2*sector%mesh%n_nodes, 2*n_own + 2), source=0.0_wp)
      do k = 0, n_own
         call add_flank_load(outline, sector, s(k), widths(k), loads(:, k + 1))
         call add_flank_load(outline, sector, s(k), widths(k)/sqrt(2.0_wp), loads(:, n_own + k + 2))
      end do
   end subroutine set_loads

   !> Radii of curvature between which the functions are sampled: the elements support narrow loads up to there.
   pure function sampled_range(outline, sector) result(ends)
      type(tooth_outline_t), intent(in) :: outline
      type(sector_mesh_t), intent(in) :: sector
      real(wp) :: ends(2), inset

      inset = 1.5_wp*(outline%s_tip - sector%flank_arc(1))
      ends = involute_curvature(outline, [outline%s_form + inset, outline%s_tip - inset])
   end function sampled_range

   !> Add a unit load on the flank to the loads of the unknowns.
   subroutine add_flank_load(outline, sector, s, half, load)
      type(tooth_outline_t), intent(in) :: outline
      type(sector_mesh_t), intent(in) :: sector
      real(wp), intent(in) :: s, half        !! arc of its middle from the base circle, half width
      real(wp), intent(inout) :: load(:)     !! of each unknown
      real(wp) :: x(0:sector%mesh%order), w(0:sector%mesh%order), d(0:sector%mesh%order, 0:sector%mesh%order), points(n_gauss), &
                  shares(n_gauss), at(n_gauss), weights(n_gauss), force(2, n_gauss)
      integer :: row, i

      call lobatto_rule(x, w, d)
      call gauss_rule(points, shares)
      do row = 1, sector%n_flank
         associate (from => sector%flank_arc(row - 1), to => sector%flank_arc(row))
            if (s - half > from .or. s + half < to) cycle
            call load_part(points, shares, from, to, s, half, at, weights)
            do i = 1, n_gauss
               force(:, i) = weights(i)*involute_normal(outline, involute_curvature(outline, at(i)))
            end do
            call put_load(x, sector%flank(:, row), from, to, at, force, load)
         end associate
      end do
   end subroutine add_flank_load

   !> Condense the half sector onto its cut, with its middle line supported for symmetric and for antisymmetric loads.
   subroutine both_halves(outline, sector, law, loads, halves, failed)
      type(tooth_outline_t), intent(in) :: outline
      type(sector_mesh_t), intent(in) :: sector
      type(elasticity_t), intent(in) :: law
      real(wp), intent(in) :: loads(:, :)
      real(wp), allocatable, intent(out) :: halves(:, :, :)
      integer, intent(out) :: failed !! as from `condense`
      logical :: is_fixed(2*sector%mesh%n_nodes, 2)
      integer :: retained(2*size(sector%cut) - 2), side, n

      ! the last node of the cut is on the hub and fixed
      associate (cut => sector%cut(:size(sector%cut) - 1))
         retained(1::2) = 2*cut - 1
         retained(2::2) = 2*cut
      end associate
      n = size(retained) + size(loads, 2)
      allocate (halves(n, n, 2))
      is_fixed = .false.
      is_fixed(2*sector%hub, :) = .true.
      is_fixed(2*sector%hub - 1, :) = .true.
      is_fixed(2*sector%axis, 1) = .true.
      is_fixed(2*sector%axis - 1, 2) = .true.
      call condense(sector%mesh, law, is_fixed, retained, loads, halves, failed)
      if (failed /= 0) return
      do side = 1, 2
         call turn_to_polar(outline%half_pitch, size(retained), halves(:, :, side))
      end do
   end subroutine both_halves

   ! ---- the load: p(s) = 35/(32 w) (1 - (s/w)^2)^3 on |s| < w, along the normals of the involute, smooth enough for the elements;
   ! the same weights give the mean displacement under it

   !> p(s), with s from the middle of the load. Equation C6.
   elemental real(wp) function load_shape(s, w) result(load)
      real(wp), intent(in) :: s, w

      load = 35/(32*w)*max(0.0_wp, 1 - (s/w)**2)**3
   end function load_shape

   !> Part of a load on one side of an element: Gauss points and the load of each.
   pure subroutine load_part(x, weights, from, to, middle, w, s, weight)
      real(wp), intent(in) :: x(n_gauss), weights(n_gauss) !! Gauss' rule
      real(wp), intent(in) :: from, to    !! arc at the ends of the side
      real(wp), intent(in) :: middle, w   !! position and half width of the load
      real(wp), intent(out) :: s(n_gauss), weight(n_gauss)
      real(wp) :: low, high

      low = max(min(from, to), middle - w)
      high = max(low, min(max(from, to), middle + w))
      s = low + (high - low)*(1 + x)/2
      weight = load_shape(s - middle, w)*weights*(high - low)/2
   end subroutine load_part

   !> Add the part of a load to the loads of the unknowns.
   pure subroutine put_load(x, nodes, from, to, s, force, load)
      real(wp), intent(in) :: x(:)             !! Gauss-Lobatto points
      integer, intent(in) :: nodes(:)          !! of the side; their spacing in arc is that of the points x
      real(wp), intent(in) :: from, to         !! arc at its ends
      real(wp), intent(in) :: s(n_gauss)
      real(wp), intent(in) :: force(2, n_gauss) !! x and y at the points
      real(wp), intent(inout) :: load(:)       !! of each unknown
      real(wp) :: values(size(x))
      integer :: k

      do k = 1, n_gauss
         values = lagrange(x, 2*(s(k) - from)/(to - from) - 1)
         load(2*nodes - 1) = load(2*nodes - 1) + values*force(1, k)
         load(2*nodes) = load(2*nodes) + values*force(2, k)
      end do
   end subroutine put_load

end module evl_influence_functions
