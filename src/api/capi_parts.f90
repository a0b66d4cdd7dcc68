!> C interface of flank, pair geometry and Johnson's force: the formulas one by one, for tests and for other programs.
!>
!> The header's section "parts" documents each procedure; here is only the passage from C to Fortran.
module evl_capi_parts
   use, intrinsic :: iso_c_binding, only: c_bool, c_double, c_int
   use evl_capi_types, only: c_status, first_error, status_to_c
   use evl_involute, only: involute_flank, involute_flank_housing, involute_flank_polar, involute_point
   use evl_johnson, only: johnson_force, johnson_force_limit, johnson_iteration, johnson_iteration_force, johnson_penetration, &
                          johnson_penetration_limit
   use evl_mesh_geometry, only: spur_pair_derive, spur_pair_t
   use evl_status, only: status_t
   implicit none (type, external)
   private

   public :: evl_involute_flank, evl_involute_flank_housing, evl_involute_flank_polar, evl_involute_points
   public :: evl_johnson_force, evl_johnson_iteration, evl_johnson_iteration_force, evl_johnson_limits
   public :: evl_johnson_penetration, evl_spur_pair_derive

   !> evl_spur_pair
   type, bind(c) :: c_spur_pair
      real(c_double) :: ratio, pitch_radius_a, pitch_radius_b, centre_distance, gamma_a, gamma_b, alpha_inf, alpha_w
      real(c_double) :: base_radius_a, base_radius_b, base_radius_sum, rho, base_pitch, tip_radius_a, tip_radius_b
      real(c_double) :: rho_start_a, rho_start_b, phi_a, phi_b
      real(c_double), dimension(2) :: centre_a, centre_b, t, e, point_k_a, point_k_b, point_a, point_b, pitch_point
      logical(c_bool) :: contains_pitch_point
   end type c_spur_pair

contains

   ! ---- involute ----

   integer(c_int) function evl_involute_flank(n, points, base_radius, hand, values, gradients, hessians, codes) bind(c)
      integer(c_int), intent(in), value :: n, hand
      real(c_double), intent(in), value :: base_radius
      real(c_double), intent(in) :: points(2, n)
      real(c_double), intent(out) :: values(n), gradients(2, n), hessians(2, 2, n)
      integer(c_int), intent(out) :: codes(n)
      integer :: i

      do i = 1, n
         call involute_flank(points(:, i), base_radius, hand, values(i), gradients(:, i), hessians(:, :, i), codes(i))
      end do
      evl_involute_flank = first_error(codes)
   end function evl_involute_flank

   integer(c_int) function evl_involute_flank_polar(n, points, base_radius, hand, values, gradients, hessians, &
                                                    codes) bind(c)
      integer(c_int), intent(in), value :: n, hand
      real(c_double), intent(in), value :: base_radius
      real(c_double), intent(in) :: points(2, n)
      real(c_double), intent(out) :: values(n), gradients(2, n), hessians(2, 2, n)
      integer(c_int), intent(out) :: codes(n)
      integer :: i

      do i = 1, n
         call involute_flank_polar(points(:, i), base_radius, hand, values(i), gradients(:, i), hessians(:, :, i), &
                                   codes(i))
      end do
      evl_involute_flank_polar = first_error(codes)
   end function evl_involute_flank_polar

   integer(c_int) function evl_involute_flank_housing(n, points, centre, angle, base_radius, hand, values, gradients, &
                                                      hessians, codes) bind(c)
      integer(c_int), intent(in), value :: n, hand
      real(c_double), intent(in), value :: angle, base_radius
      real(c_double), intent(in) :: points(2, n), centre(2)
      real(c_double), intent(out) :: values(n), gradients(2, n), hessians(2, 2, n)
      integer(c_int), intent(out) :: codes(n)
      integer :: i

      do i = 1, n
         call involute_flank_housing(points(:, i), centre, angle, base_radius, hand, values(i), gradients(:, i), &
                                     hessians(:, :, i), codes(i))
      end do
      evl_involute_flank_housing = first_error(codes)
   end function evl_involute_flank_housing

   subroutine evl_involute_points(n, roll_angles, base_radius, hand, points) bind(c)
      integer(c_int), intent(in), value :: n, hand
      real(c_double), intent(in), value :: base_radius
      real(c_double), intent(in) :: roll_angles(n)
      real(c_double), intent(out) :: points(2, n)
      integer :: i

      do i = 1, n
         points(:, i) = involute_point(roll_angles(i), base_radius, hand)
      end do
   end subroutine evl_involute_points

   ! ---- geometry of a pair ----

   integer(c_int) function evl_spur_pair_derive(teeth_a, teeth_b, pitch_radius_a, paper_rule, alpha_w, chi, sigma, &
                                                centre_a, pair, status) bind(c)
      integer(c_int), intent(in), value :: teeth_a, teeth_b, sigma
      real(c_double), intent(in), value :: pitch_radius_a, alpha_w, chi
      logical(c_bool), intent(in), value :: paper_rule
      real(c_double), intent(in) :: centre_a(2)
      type(c_spur_pair), intent(out) :: pair
      type(c_status), intent(out), optional :: status
      type(spur_pair_t) :: p
      type(status_t) :: s

      call spur_pair_derive(teeth_a, teeth_b, pitch_radius_a, logical(paper_rule), alpha_w, chi, sigma, centre_a, p, s)
      pair = c_spur_pair( &
             ratio=p%ratio, pitch_radius_a=p%pitch_radius_a, pitch_radius_b=p%pitch_radius_b, &
             centre_distance=p%centre_distance, gamma_a=p%gamma_a, gamma_b=p%gamma_b, alpha_inf=p%alpha_inf, &
             alpha_w=p%alpha_w, base_radius_a=p%base_radius_a, base_radius_b=p%base_radius_b, &
             base_radius_sum=p%base_radius_sum, rho=p%rho, base_pitch=p%base_pitch, tip_radius_a=p%tip_radius_a, &
             tip_radius_b=p%tip_radius_b, rho_start_a=p%rho_start_a, rho_start_b=p%rho_start_b, phi_a=p%phi_a, &
             phi_b=p%phi_b, centre_a=p%centre_a, centre_b=p%centre_b, t=p%t, e=p%e, point_k_a=p%point_k_a, &
             point_k_b=p%point_k_b, point_a=p%point_a, point_b=p%point_b, pitch_point=p%pitch_point, &
             contains_pitch_point=logical(p%contains_pitch_point, c_bool))
      if (present(status)) call status_to_c(s, status)
      evl_spur_pair_derive = s%code
   end function evl_spur_pair_derive

   ! ---- Johnson's force ----

   integer(c_int) function evl_johnson_force(n, h, rho_sum, e_star, force, d_h, d_rho, codes) bind(c)
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: h(n), rho_sum(n), e_star(n)
      real(c_double), intent(out) :: force(n), d_h(n), d_rho(n)
      integer(c_int), intent(out) :: codes(n)

      call johnson_force(h, rho_sum, e_star, force, d_h, d_rho, codes)
      evl_johnson_force = first_error(codes)
   end function evl_johnson_force

   integer(c_int) function evl_johnson_penetration(n, force, rho_sum, e_star, h, codes) bind(c)
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: force(n), rho_sum(n), e_star(n)
      real(c_double), intent(out) :: h(n)
      integer(c_int), intent(out) :: codes(n)

      call johnson_penetration(force, rho_sum, e_star, h, codes)
      evl_johnson_penetration = first_error(codes)
   end function evl_johnson_penetration

   subroutine evl_johnson_limits(n, rho_sum, e_star, penetration, force) bind(c)
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: rho_sum(n), e_star(n)
      real(c_double), intent(out) :: penetration(n), force(n)

      penetration = johnson_penetration_limit(rho_sum)
      force = johnson_force_limit(rho_sum, e_star)
   end subroutine evl_johnson_limits

   subroutine evl_johnson_iteration(n, eta, nu, next) bind(c)
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: eta(n), nu(n)
      real(c_double), intent(out) :: next(n)

      next = johnson_iteration(eta, nu)
   end subroutine evl_johnson_iteration

   integer(c_int) function evl_johnson_iteration_force(n, h, rho_sum, e_star, start, tolerance, max_turns, force, &
                                                       turns, codes) bind(c)
      integer(c_int), intent(in), value :: n, max_turns
      real(c_double), intent(in), value :: tolerance
      real(c_double), intent(in) :: h(n), rho_sum(n), e_star(n), start(n)
      real(c_double), intent(out) :: force(n)
      integer(c_int), intent(out) :: turns(n), codes(n)

      call johnson_iteration_force(h, rho_sum, e_star, start, tolerance, max_turns, force, turns, codes)
      evl_johnson_iteration_force = first_error(codes)
   end function evl_johnson_iteration_force

end module evl_capi_parts
