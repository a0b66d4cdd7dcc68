!> The flank of an involute and one pair by the paper's rules for the tests: C calls that the kernel does not export.
module involute_calls
   use, intrinsic :: iso_c_binding, only: c_bool, c_double, c_int
   use evl_capi_types, only: c_status, status_to_c
   use evl_kinds, only: pi
   use evl_mesh_geometry, only: spur_pair_derive, spur_pair_t
   use evl_status, only: status_t
   use involute, only: involute_flank, involute_flank_housing, involute_flank_polar, involute_point
   implicit none (type, external)
   private

   public :: test_involute_flank, test_involute_flank_housing, test_involute_flank_polar, test_involute_points
   public :: test_spur_pair_derive

   !> What the tests ask of a pair: fields of `spur_pair_t`, and the angles of the involutes' roots when the teeth touch at a.
   type, bind(c) :: c_spur_pair
      real(c_double) :: ratio, pitch_radius_a, pitch_radius_b, centre_distance, gamma_a, alpha_inf, alpha_w
      real(c_double) :: base_radius_a, base_radius_b, base_radius_sum, rho, base_pitch, tip_radius_a, tip_radius_b
      real(c_double) :: rho_start_a, rho_start_b, phi_a, phi_b
      real(c_double), dimension(2) :: centre_a, centre_b, t, e, point_k_a, point_k_b, point_a, point_b, pitch_point
      logical(c_bool) :: contains_pitch_point
   end type c_spur_pair

contains

   !> Flank function f of the involute whose root lies on the x axis, its gradient and Hessian, at points of the wheel's frame.
   subroutine test_involute_flank(n, points, base_radius, hand, values, gradients, hessians, codes) bind(c)
      integer(c_int), intent(in), value :: n, hand
      real(c_double), intent(in), value :: base_radius
      real(c_double), intent(in) :: points(2, n)
      real(c_double), intent(out) :: values(n), gradients(2, n), hessians(2, 2, n)
      integer(c_int), intent(out) :: codes(n)
      integer :: i

      do i = 1, n
         call involute_flank(points(:, i), base_radius, hand, values(i), gradients(:, i), hessians(:, :, i), codes(i))
      end do
   end subroutine test_involute_flank

   !> The same by the paper's polar Jacobian.
   subroutine test_involute_flank_polar(n, points, base_radius, hand, values, gradients, hessians, &
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
   end subroutine test_involute_flank_polar

   !> The same at points of the housing frame, for a wheel at `centre` whose involute root is at `angle`.
   subroutine test_involute_flank_housing(n, points, centre, angle, base_radius, hand, values, gradients, &
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
   end subroutine test_involute_flank_housing

   !> Points of the flank at roll angles [rad] >= 0.
   subroutine test_involute_points(n, roll_angles, base_radius, hand, points) bind(c)
      integer(c_int), intent(in), value :: n, hand
      real(c_double), intent(in), value :: base_radius
      real(c_double), intent(in) :: roll_angles(n)
      real(c_double), intent(out) :: points(2, n)
      integer :: i

      do i = 1, n
         points(:, i) = involute_point(roll_angles(i), base_radius, hand)
      end do
   end subroutine test_involute_points

   !> Geometry of a pair; wheel A drives wheel B.
   subroutine test_spur_pair_derive(teeth_a, teeth_b, pitch_radius_a, paper_rule, alpha_w, chi, sigma, &
                                    centre_a, pair, status) bind(c)
      integer(c_int), intent(in), value :: teeth_a, teeth_b, sigma
      real(c_double), intent(in), value :: pitch_radius_a, alpha_w, chi
      logical(c_bool), intent(in), value :: paper_rule
      real(c_double), intent(in) :: centre_a(2)
      type(c_spur_pair), intent(out) :: pair
      type(c_status), intent(out) :: status
      type(spur_pair_t) :: p
      type(status_t) :: s

      call spur_pair_derive(teeth_a, teeth_b, pitch_radius_a, logical(paper_rule), alpha_w, chi, sigma, centre_a, p, s)
      pair = c_spur_pair( &
             ratio=p%ratio, pitch_radius_a=p%pitch_radius_a, pitch_radius_b=p%pitch_radius_b, &
             centre_distance=p%centre_distance, gamma_a=p%gamma_a, alpha_inf=p%alpha_inf, &
             alpha_w=p%alpha_w, base_radius_a=p%base_radius_a, base_radius_b=p%base_radius_b, &
             base_radius_sum=p%base_radius_sum, rho=p%rho, base_pitch=p%base_pitch, tip_radius_a=p%tip_radius_a, &
             tip_radius_b=p%tip_radius_b, rho_start_a=p%rho_start_a, rho_start_b=p%rho_start_b, &
             phi_a=p%chi + p%sigma*(p%alpha_w - p%rho_start_a/p%base_radius_a), &
             phi_b=p%chi + p%sigma*(pi + p%alpha_w - p%rho_start_b/p%base_radius_b), &
             centre_a=p%centre_a, centre_b=p%centre_b, t=p%t, e=p%e, point_k_a=p%point_k_a, &
             point_k_b=p%point_k_b, point_a=p%point_a, point_b=p%point_b, pitch_point=p%pitch_point, &
             contains_pitch_point=logical(p%contains_pitch_point, c_bool))
      call status_to_c(s, status)
   end subroutine test_spur_pair_derive

end module involute_calls
