!> Stresses of a whole wheel from one half of a sector: loads on a flank of one tooth, stresses in both fillets of all teeth.
!>
!> A stress at a point of the outline is a linear functional of the displacements there. It is condensed onto the cut as a load is,
!> so its value under a load is an element of the same matrices (evl_cyclic_wheel). The modelled half has the right fillet, which
!> is on the side of the loaded flank. The functional of the mirrored point in the left fillet has the same part g_s, the part g_a
!> with the opposite sign, and the difference of both compliances with the cut fixed.
module evl_cyclic_stress
   use evl_cyclic_wheel, only: harmonic_products
   use evl_kinds, only: pi, wp
   implicit none (type, external)
   private

   public :: stress_response

contains

   !> Stresses of tooth 0 under unit loads on tooth j, counted toward the side that the loaded flank faces. Equation RS4.
   subroutine stress_response(teeth, n_cut, n_loads, symmetric, antisymmetric, last, right, left, is_definite)
      integer, intent(in) :: teeth                     !! z
      integer, intent(in) :: n_cut                     !! unknowns on the cut, then the loads, then the stress functionals
      integer, intent(in) :: n_loads
      real(wp), intent(in) :: symmetric(:, :), antisymmetric(:, :)
      integer, intent(in) :: last                      !! largest |j|
      real(wp), intent(out), dimension(:, :, -last:) :: right, left !! (functional, load, j)
      logical, intent(out) :: is_definite
      real(wp), allocatable :: products(:, :)
      real(wp) :: theta, share, even, odd
      integer :: n_all, n, j, a, b

      n_all = size(symmetric, 1) - n_cut
      allocate (products(2*n_all, 2*n_all))
      right = 0
      left = 0
      associate (rows => n_cut + n_loads, s => symmetric, t => antisymmetric)
         right(:, :, 0) = -(s(rows + 1:, n_cut + 1:rows) + t(rows + 1:, n_cut + 1:rows))/2
         left(:, :, 0) = -(s(rows + 1:, n_cut + 1:rows) - t(rows + 1:, n_cut + 1:rows))/2
      end associate
      do n = 0, teeth/2
         theta = pi*n/teeth
         call harmonic_products(theta, n_cut, symmetric, antisymmetric, products, is_definite)
         if (.not. is_definite) return
         share = merge(1.0_wp, 2.0_wp, n == 0 .or. 2*n == teeth)/teeth
         do j = -last, last
            ! a load on tooth j acts on tooth 0 as a load on tooth 0 acts on tooth -j
            even = share*cos(2*theta*j)
            odd = -share*sin(2*theta*j)
            do b = 1, n_loads
               do a = 1, n_all - n_loads
                  associate (ss => products(n_loads + a, b), aa => products(n_all + n_loads + a, n_all + b), &
                             as => products(n_all + n_loads + a, b), sa => products(n_loads + a, n_all + b))
                     right(a, b, j) = right(a, b, j) - even*(ss + aa) + odd*(as - sa)
                     left(a, b, j) = left(a, b, j) - even*(ss - aa) - odd*(as + sa)
                  end associate
               end do
            end do
         end do
      end do
   end subroutine stress_response

end module evl_cyclic_stress
