!> Compliance of the tooth pairs of a flank: the matrix C of evl_coupled_pairs from the influence functions of both wheels, with its
!> derivatives with respect to the feet.
!>
!>    C_kk = c_A(foot_A,k) + c_B(foot_B,k) + (K_A - K_B)/2 ln(foot_A,k/foot_B,k),   K = 2 (1 - nu**2)/(pi E)
!>    C_kl = c_A,k-l(foot_A,k, foot_A,l) + c_B,l-k(foot_B,k, foot_B,l)   drive flank; on the coast flank k-l and l-k exchanged
!>
!> c_j is the displacement of tooth 0 under a load on tooth j, positive towards the side that the loaded flanks face. c_-j(a, b) is
!> c_j(b, a), so that three functions are enough and C is symmetric to the last bit. The logarithm corrects Johnson's law, which
!> assigns equal parts of the displacement to both cylinders. This does not hold for two materials; the term is 0 for wheels of one
!> material.
module evl_pair_compliance
   use evl_coupled_pairs, only: most_pairs
   use evl_kinds, only: lanes, wp
   use evl_pair_point, only: by_a, by_b, pair_feet
   use evl_wheel_compliance, only: coupling_at_t, own_at_t, wheel_compliance_t
   implicit none (type, external)
   private

   public :: couple, couple_in_lanes, assemble_compliance, assemble_in_lanes, own_in_lanes, own_of_pair, pair_compliance

   real(wp), parameter :: least_foot = 1.0e-3_wp !! lower limit of a foot, relative to that of the mate

   !> C with its derivatives. Each term of N C N belongs to an ordered pair (k, l), so the diagonal has factors 1/2.
   type :: pair_compliance
      real(wp) :: c(most_pairs, most_pairs) = 0.0_wp        !! [1/Pa]
      real(wp) :: d(most_pairs, most_pairs, 2) = 0.0_wp     !! of C_kl with respect to foot k on A, on B; of C_kk/2
      real(wp) :: d_own(most_pairs, most_pairs, 2) = 0.0_wp !! second derivatives with respect to foot k; of C_kk/2
      real(wp) :: d_both(most_pairs, most_pairs, 2) = 0.0_wp !! mixed derivatives with respect to feet k and l; 0 for k = l
   end type pair_compliance

contains

   !> C of n tooth pairs. Equations F4, F10.
   pure subroutine assemble_compliance(a, b, k_difference, is_drive, couples, n, numbers, feet, compliance)
      class(wheel_compliance_t), intent(in) :: a, b
      real(wp), intent(in) :: k_difference !! K_A - K_B [1/Pa]
      logical, intent(in) :: is_drive      !! drive flank: pairs are numbered in the direction that the teeth of A face
      logical, intent(in) :: couples       !! false: pairs are independent
      integer, intent(in) :: n
      integer, intent(in) :: numbers(n)    !! of the tooth pairs
      type(pair_feet), intent(in) :: feet(n)
      type(pair_compliance), intent(out) :: compliance
      type(own_at_t) :: own(2)
      integer :: k, l

      do k = 1, n
         call own_of_pair(a, b, k_difference, feet(k)%foot, own)
         compliance%c(k, k) = sum(own%value)
         compliance%d(k, k, :) = own%slope/2
         compliance%d_own(k, k, :) = own%curvature/2
      end do
      if (.not. couples) return
      do k = 1, n
         do l = k + 1, n
            call add_other(a, by_a, is_drive, numbers, feet, k, l, compliance)
            call add_other(b, by_b,.not. is_drive, numbers, feet, k, l, compliance)
         end do
      end do
   end subroutine assemble_compliance

   !> Contribution of one wheel to C_kl. Equation F4.
   pure subroutine add_other(wheel, w, against, numbers, feet, k, l, compliance)
      class(wheel_compliance_t), intent(in) :: wheel
      integer, intent(in) :: w
      logical, intent(in) :: against !! the index is k - l, otherwise l - k
      integer, intent(in) :: numbers(:), k, l
      type(pair_feet), intent(in) :: feet(:)
      type(pair_compliance), intent(inout) :: compliance
      type(coupling_at_t) :: at
      integer :: first, second

      first = merge(l, k, against .eqv. numbers(l) > numbers(k)) ! makes the index positive
      second = k + l - first
      call wheel%coupling(abs(numbers(k) - numbers(l)), feet(first)%foot(w), feet(second)%foot(w), at)
      compliance%c(k, l) = compliance%c(k, l) + at%value
      compliance%c(l, k) = compliance%c(k, l)
      compliance%d(first, second, w) = at%by_here
      compliance%d(second, first, w) = at%by_there
      compliance%d_own(first, second, w) = at%here_here
      compliance%d_own(second, first, w) = at%there_there
      compliance%d_both(first, second, w) = at%here_there
      compliance%d_both(second, first, w) = at%here_there
   end subroutine add_other

   !> C and its first derivatives, as in `pair_compliance`, for eight states; coupled. Equation F4.
   pure subroutine assemble_in_lanes(a, b, k_difference, is_drive, n, numbers, foot, c, d)
      class(wheel_compliance_t), intent(in) :: a, b
      real(wp), intent(in) :: k_difference
      logical, intent(in) :: is_drive
      integer, intent(in) :: n
      integer, intent(in) :: numbers(n)
      real(wp), intent(in) :: foot(lanes, 2, n)
      real(wp), intent(out) :: c(lanes, most_pairs, *), d(lanes, most_pairs, most_pairs, 2)
      integer :: k, l

      do k = 1, n
         call own_in_lanes(a, b, k_difference, foot(:, :, k), c(:, k, k), d(:, k, k, by_a), d(:, k, k, by_b))
      end do
      do k = 1, n
         do l = k + 1, n
            c(:, k, l) = 0
            call add_other_in_lanes(a, by_a, is_drive, numbers, foot, k, l, c, d)
            call add_other_in_lanes(b, by_b,.not. is_drive, numbers, foot, k, l, c, d)
         end do
      end do
   end subroutine assemble_in_lanes

   !> C_kk and half of its derivatives for eight states. Equation F15.
   pure subroutine own_in_lanes(a, b, k_difference, foot, c, half_a, half_b)
      class(wheel_compliance_t), intent(in) :: a, b
      real(wp), intent(in) :: k_difference
      real(wp), intent(in) :: foot(lanes, 2)
      real(wp), intent(out), dimension(lanes) :: c, half_a, half_b
      real(wp), dimension(lanes) :: value_b
      real(wp) :: here(2)
      integer :: l

      call a%own_lanes(foot(:, by_a), c, half_a)
      call b%own_lanes(foot(:, by_b), value_b, half_b)
      if (abs(k_difference) > 0) then
         !GCC$ novector
         do l = 1, lanes
            here = on_involutes(foot(l, :))
            c(l) = c(l) + k_difference/2*log(here(by_a)/here(by_b))
            half_a(l) = half_a(l) + k_difference/2/here(by_a)
            half_b(l) = half_b(l) + (-k_difference/2)/here(by_b)
         end do
      end if
      c = c + value_b
      half_a = half_a/2
      half_b = half_b/2
   end subroutine own_in_lanes

   !> Contribution of one wheel to C_kl for eight states. Equation F4.
   pure subroutine add_other_in_lanes(wheel, w, against, numbers, foot, k, l, c, d)
      class(wheel_compliance_t), intent(in) :: wheel
      integer, intent(in) :: w
      logical, intent(in) :: against
      integer, intent(in) :: numbers(*), k, l
      real(wp), intent(in) :: foot(lanes, 2, *)
      real(wp), intent(inout) :: c(lanes, most_pairs, *), d(lanes, most_pairs, most_pairs, 2)
      real(wp), dimension(lanes) :: value, by_here, by_there
      integer :: first, second

      first = merge(l, k, against .eqv. numbers(l) > numbers(k))
      second = k + l - first
      call wheel%coupling_lanes(abs(numbers(k) - numbers(l)), foot(:, w, first), foot(:, w, second), value, by_here, by_there)
      c(:, k, l) = c(:, k, l) + value
      c(:, l, k) = c(:, k, l)
      d(:, first, second, w) = by_here
      d(:, second, first, w) = by_there
   end subroutine add_other_in_lanes

   !> Single element C_kl, for two given pairs.
   pure real(wp) function couple(a, b, is_drive, number, foot, other, other_foot) result(c)
      class(wheel_compliance_t), intent(in) :: a, b
      logical, intent(in) :: is_drive
      integer, intent(in) :: number, other !! of the tooth pairs
      real(wp), intent(in) :: foot(2), other_foot(2)
      type(coupling_at_t) :: on_a, on_b

      if (is_drive .eqv. other > number) then ! the index of A would be negative: exchange its arguments
         call a%coupling(abs(other - number), other_foot(by_a), foot(by_a), on_a)
         call b%coupling(abs(other - number), foot(by_b), other_foot(by_b), on_b)
      else
         call a%coupling(abs(other - number), foot(by_a), other_foot(by_a), on_a)
         call b%coupling(abs(other - number), other_foot(by_b), foot(by_b), on_b)
      end if
      c = on_a%value + on_b%value
   end function couple

   !> `couple` for eight states.
   pure subroutine couple_in_lanes(a, b, is_drive, number, foot, other, other_foot, c)
      class(wheel_compliance_t), intent(in) :: a, b
      logical, intent(in) :: is_drive
      integer, intent(in) :: number, other
      real(wp), intent(in) :: foot(lanes, 2), other_foot(lanes, 2)
      real(wp), intent(out) :: c(lanes)
      real(wp) :: on_b(lanes)

      if (is_drive .eqv. other > number) then
         call a%coupling_values(abs(other - number), other_foot(:, by_a), foot(:, by_a), c)
         call b%coupling_values(abs(other - number), foot(:, by_b), other_foot(:, by_b), on_b)
      else
         call a%coupling_values(abs(other - number), foot(:, by_a), other_foot(:, by_a), c)
         call b%coupling_values(abs(other - number), other_foot(:, by_b), foot(:, by_b), on_b)
      end if
      c = c + on_b
   end subroutine couple_in_lanes

   !> Compliance of a pair under its own load: the parts of A and B, with the sum C_kk. Equation F15.
   pure subroutine own_of_pair(a, b, k_difference, foot, own)
      class(wheel_compliance_t), intent(in) :: a, b
      real(wp), intent(in) :: k_difference !! K_A - K_B [1/Pa]
      real(wp), intent(in) :: foot(2)      !! roll lengths at which A and B are loaded [m]
      type(own_at_t), intent(out) :: own(2)
      real(wp) :: half(2), here(2)

      call a%own(foot(by_a), own(by_a))
      call b%own(foot(by_b), own(by_b))
      if (.not. abs(k_difference) > 0) return
      half = [k_difference, -k_difference]/2
      here = on_involutes(foot)
      own(by_a)%value = own(by_a)%value + half(by_a)*log(here(by_a)/here(by_b))
      own%slope = own%slope + half/here
      own%curvature = own%curvature - half/here**2
   end subroutine own_of_pair

   !> Feet limited for the logarithm. The foot of an edge far off the path may lie past the mate's base circle, where there is no
   !> flank and no pair carries load.
   pure function on_involutes(foot) result(here)
      real(wp), intent(in) :: foot(2) !! [m]
      real(wp) :: here(2)

      here = max(foot, least_foot*foot(2:1:-1))
   end function on_involutes

end module evl_pair_compliance
