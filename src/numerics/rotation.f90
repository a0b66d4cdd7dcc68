!> Vectors and rotations in space: cross products, unit quaternions, rotation vectors.
!>
!> A quaternion is (p_0, q), p_0 its scalar part; R(p) transforms components from the housing frame to the ground frame.
module evl_rotation
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: cross, crossed, skew, turned, turned_back
   public :: rotation_matrix, rotated_gradient, rotated_back_gradient, quaternion_product, turn_from_vector, identity

   real(wp), parameter :: identity(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], &
                                                   [3, 3]) !! unit matrix
   integer, parameter :: n_terms = 10 !! of the series below: 1e-18 at x = 1

contains

   !> a x b.
   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3)

      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross

   !> The matrix of a cross product: skew(a) b = a x b.
   pure function skew(a) result(matrix)
      real(wp), intent(in) :: a(3)
      real(wp) :: matrix(3, 3)

      matrix = reshape([0.0_wp, a(3), -a(2), -a(3), 0.0_wp, a(1), a(2), -a(1), 0.0_wp], [3, 3])
   end function skew

   !> a x each column of a matrix.
   pure function crossed(a, matrix) result(columns)
      real(wp), intent(in) :: a(3), matrix(:, :)
      real(wp) :: columns(3, size(matrix, 2))
      integer :: j

      do j = 1, size(matrix, 2)
         columns(:, j) = cross(a, matrix(:, j))
      end do
   end function crossed

   !> matrix x. (gfortran 12 warns of matmul with a function result.)
   pure function turned(matrix, x) result(y)
      real(wp), intent(in) :: matrix(3, 3), x(3)
      real(wp) :: y(3)

      y = matrix(:, 1)*x(1) + matrix(:, 2)*x(2) + matrix(:, 3)*x(3)
   end function turned

   !> matrix^T x.
   pure function turned_back(matrix, x) result(y)
      real(wp), intent(in) :: matrix(3, 3), x(3)
      real(wp) :: y(3)

      y = [dot_product(matrix(:, 1), x), dot_product(matrix(:, 2), x), dot_product(matrix(:, 3), x)]
   end function turned_back

   !> R(p) of a unit quaternion. Equation H1.
   pure function rotation_matrix(p) result(matrix)
      real(wp), intent(in) :: p(4)
      real(wp) :: matrix(3, 3)
      integer :: j

      associate (q => p(2:4))
         matrix = 2*p(1)*skew(q)
         do j = 1, 3
            matrix(:, j) = matrix(:, j) + 2*q(j)*q
            matrix(j, j) = matrix(j, j) + p(1)**2 - dot_product(q, q)
         end do
      end associate
   end function rotation_matrix

   !> d(R(p) x)/dp, for a constant x.
   pure function rotated_gradient(p, x) result(gradient)
      real(wp), intent(in) :: p(4), x(3)
      real(wp) :: gradient(3, 4)
      integer :: j

      associate (q => p(2:4))
         gradient(:, 1) = 2*(p(1)*x + cross(q, x))
         gradient(:, 2:4) = -2*p(1)*skew(x)
         do j = 1, 3
            gradient(:, 1 + j) = gradient(:, 1 + j) - 2*q(j)*x + 2*x(j)*q
            gradient(j, 1 + j) = gradient(j, 1 + j) + 2*dot_product(q, x)
         end do
      end associate
   end function rotated_gradient

   !> d(R(p)^T x)/dp, for a constant x.
   pure function rotated_back_gradient(p, x) result(gradient)
      real(wp), intent(in) :: p(4), x(3)
      real(wp) :: gradient(3, 4)

      gradient = rotated_gradient([p(1), -p(2:4)], x)
      gradient(:, 2:4) = -gradient(:, 2:4)
   end function rotated_back_gradient

   !> a o b.
   pure function quaternion_product(a, b) result(c)
      real(wp), intent(in) :: a(4), b(4)
      real(wp) :: c(4)

      c(1) = a(1)*b(1) - dot_product(a(2:4), b(2:4))
      c(2:4) = a(1)*b(2:4) + b(1)*a(2:4) + cross(a(2:4), b(2:4))
   end function quaternion_product

   !> Orientation, angular velocity and angular acceleration, both in the rotated frame, from a rotation vector and its rates.
   !> Equation H7.
   !>
   !> p = (c(x), s(x) theta) with x = theta . theta, c = cos(sqrt(x)/2), s = sin(sqrt(x)/2)/sqrt(x): entire functions of x, so
   !> that there is no singularity at any angle. Omega = 2 vec(conj(p) o p'), Omega' = 2 vec(conj(p) o p'').
   pure subroutine turn_from_vector(theta, rate, second, p, omega, alpha)
      real(wp), intent(in) :: theta(3), rate(3), second(3) !! rotation vector [rad], its first and second derivative
      real(wp), intent(out) :: p(4), omega(3), alpha(3)    !! [1], [rad/s], [rad/s^2]
      real(wp) :: x, x_rate, x_second, c, s, s_x, s_xx, p_rate(4), p_second(4), conjugate(4), both(4)

      x = dot_product(theta, theta)
      x_rate = 2*dot_product(theta, rate)
      x_second = 2*(dot_product(rate, rate) + dot_product(theta, second))
      c = cos(sqrt(x)/2)
      call half_sine(x, c, s, s_x, s_xx)
      p = [c, s*theta]
      p_rate = [-s/4*x_rate, s_x*x_rate*theta + s*rate] ! dc/dx = -s/4
      p_second = [-s_x/4*x_rate**2 - s/4*x_second, (s_xx*x_rate**2 + s_x*x_second)*theta + 2*s_x*x_rate*rate + s*second]
      conjugate = [p(1), -p(2:4)]
      both = quaternion_product(conjugate, p_rate)
      omega = 2*both(2:4)
      both = quaternion_product(conjugate, p_second)
      alpha = 2*both(2:4)
   end subroutine turn_from_vector

   !> s(x) = sin(sqrt(x)/2)/sqrt(x) with its first two derivatives; by its power series where the quotients suffer from
   !> cancellation. Equation H7.
   pure subroutine half_sine(x, c, s, s_x, s_xx)
      real(wp), intent(in) :: x, c !! x >= 0; cos(sqrt(x)/2)
      real(wp), intent(out) :: s, s_x, s_xx
      real(wp) :: term(0:n_terms) ! coefficients: term(k) = (-1/4)**k/(2 (2k+1)!)
      integer :: k

      if (x > 1) then
         s = sin(sqrt(x)/2)/sqrt(x)
         s_x = (c/2 - s)/(2*x)
         s_xx = -(s/8 + 3*s_x)/(2*x)
         return
      end if
      term(0) = 0.5_wp
      do k = 1, n_terms
         term(k) = -term(k - 1)/(4*2*k*(2*k + 1))
      end do
      s = 0
      s_x = 0
      s_xx = 0
      do k = n_terms, 0, -1
         s_xx = s_xx*x + s_x
         s_x = s_x*x + s
         s = s*x + term(k)
      end do
      s_xx = 2*s_xx
   end subroutine half_sine

end module evl_rotation
