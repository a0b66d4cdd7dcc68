!> Split of a motion by natural modes: slow modes do not follow the meshes, fast modes do.
!>
!> With B = -M^-1 K, whose eigenvalues are -omega_k^2, a vector v = sum c_k v_k becomes sum w_k c_k v_k. The weight w is 0 for modes
!> with a frequency below half the mesh frequency, 1 above twice, and in between
!>
!>    w = s^3 (10 - 15 s + 6 s^2),   s = log2(2 omega/Omega)/2.
!>
!> For an overdamped mode the slower of its two rates is used.
!>
!> Source: docs/theory/theory.md, section 9.
module evl_steady_split
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use evl_kinds, only: wp
   use evl_lapack, only: dgeevx, dgesv
   implicit none (type, external)
   private

   public :: retain_fast_modes, mode_weight

   real(wp), parameter :: slow = 0.5_wp, fast = 2.0_wp !! ratios of modal to mesh frequency at which the weight is 0 and 1
   real(wp), parameter :: tiny_part = 1.0e-13_wp        !! relative to the largest eigenvalue: smaller ones count as 0

contains

   !> Weight of a mode by the ratio of its frequency to the mesh frequency; its first two derivatives are continuous. Equation T65.
   pure real(wp) function mode_weight(ratio) result(weight)
      real(wp), intent(in) :: ratio
      real(wp) :: s

      s = 0
      if (ratio > slow) s = min(log(ratio/slow)/log(fast/slow), 1.0_wp)
      weight = s**3*(10 - 15*s + 6*s**2)
   end function mode_weight

   !> Multiply the modal components of vectors by their weights. Without a complete set of modes the vectors are unchanged.
   !> Equation T64.
   subroutine retain_fast_modes(stiffness, damping, mesh_frequency, vectors)
      real(wp), intent(in) :: stiffness(:, :)    !! B [1/s^2]
      real(wp), intent(in) :: damping(:, :)      !! -M^-1 C [1/s]
      real(wp), intent(in) :: mesh_frequency     !! Omega, the highest of all meshes [rad/s]
      real(wp), intent(inout) :: vectors(:, :)
      real(wp), dimension(size(stiffness, 1)) :: re, im, balance, condition, condition_vectors, rate, weight
      real(wp), dimension(size(stiffness, 1), size(stiffness, 1)) :: a, left, right, factors
      real(wp) :: right_hand(size(stiffness, 1), size(stiffness, 1) + size(vectors, 2))
      real(wp) :: norm, work(size(stiffness, 1)*(size(stiffness, 1) + 6))
      integer :: n, m, k, low, high, info, unused(1), pivots(size(stiffness, 1))

      n = size(stiffness, 1)
      m = size(vectors, 2)
      if (n == 0) return
      a = stiffness
      call dgeevx("B", "N", "V", "N", n, a, n, re, im, left, n, right, n, low, high, balance, norm, condition, condition_vectors, &
                  work, size(work), unused, info)
      if (info /= 0) return
      ! the two columns of a complex pair contain its real and imaginary part; their weights are equal
      factors = right
      right_hand(:, :n) = matmul(damping, right)
      right_hand(:, n + 1:) = vectors
      call dgesv(n, n + m, factors, n, pivots, right_hand, n, info)
      if (info /= 0 .or. .not. all(ieee_is_finite(right_hand))) return
      rate = rates(sqrt(re**2 + im**2), right_hand(:, :n), im)
      !GCC$ novector
      do k = 1, n
         weight(k) = mode_weight(rate(k)/max(mesh_frequency, tiny(mesh_frequency)))
      end do
      if (all(weight >= 1)) return
      do k = n + 1, n + m
         right_hand(:, k) = right_hand(:, k)*weight
      end do
      vectors = matmul(right, right_hand(:, n + 1:))
   end subroutine retain_fast_modes

   !> Frequency of every mode, or the slower rate of an overdamped one [1/s].
   pure function rates(squares, damping, im) result(rate)
      real(wp), intent(in) :: squares(:)     !! omega^2
      real(wp), intent(in) :: damping(:, :)  !! of the modes
      real(wp), intent(in) :: im(:)          !! nonzero for a complex pair
      real(wp) :: rate(size(squares)), half
      integer :: k

      do k = 1, size(squares)
         rate(k) = 0
         if (.not. squares(k) > tiny_part*maxval(squares)) cycle
         rate(k) = sqrt(squares(k))
         half = -damping(k, k)/2
         if (abs(im(k)) > 0 .or. .not. half > rate(k)) cycle
         rate(k) = squares(k)/(half + sqrt((half - rate(k))*(half + rate(k))))
      end do
   end function rates

end module evl_steady_split
