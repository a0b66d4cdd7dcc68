!> What the tooth pairs of a flank yield to each other's loads: the matrix C of evl_coupled_pairs, from the influence functions of
!> both wheels, with its derivatives to the feet.
!>
!>    C_kk = c_A(foot_A,k) + c_B(foot_B,k) + (K_A - K_B)/2 ln(foot_A,k/foot_B,k),   K = 2 (1 - nu**2)/(pi E)
!>    C_kl = c_A,k-l(foot_A,k, foot_A,l) + c_B,l-k(foot_B,k, foot_B,l)   drive flank; on the coast flank k-l and l-k exchanged
!>
!> c_j is the displacement of tooth 0 under a load on tooth j, counted towards the side that the loaded flanks face; c_-j(a, b) is
!> c_j(b, a), so that three functions are enough and C is symmetric to the last bit. The logarithm is there since Johnson's law
!> gives both cylinders the same part of the displacement, and two materials have not: 0 for wheels of one material.
module evl_pair_compliance
   use evl_coupled_pairs, only: most_pairs
   use evl_kinds, only: wp
   use evl_pair_place, only: by_a, by_b, pair_feet
   implicit none (type, external)
   private

   public :: gather_compliance, influence_value, other_value, pair_compliance, wheel_influence_t

   !> c of a load's own place, with derivatives.
   type :: influence_value
      real(wp) :: c = 0.0_wp    !! [1/Pa]
      real(wp) :: d = 0.0_wp    !! dc/drho [1/(Pa m)]
      real(wp) :: d2 = 0.0_wp
   end type influence_value

   !> c_j, with derivatives to the place on tooth 0 and to that on tooth j.
   type :: other_value
      real(wp) :: c = 0.0_wp
      real(wp) :: d_1 = 0.0_wp, d_2 = 0.0_wp
      real(wp) :: d_11 = 0.0_wp, d_12 = 0.0_wp, d_22 = 0.0_wp
   end type other_value

   !> How a wheel yields.
   type, abstract :: wheel_influence_t
   contains
      procedure(own_tooth), deferred :: own_tooth
      procedure(other_tooth), deferred :: other_tooth
   end type wheel_influence_t

   abstract interface

      !> At a load's own place.
      pure subroutine own_tooth(self, rho, value)
         import :: influence_value, wheel_influence_t, wp
         implicit none (type, external)
         class(wheel_influence_t), intent(in) :: self
         real(wp), intent(in) :: rho !! roll length [m]
         type(influence_value), intent(out) :: value
      end subroutine own_tooth

      !> Of tooth 0 under a load on tooth j = 1, 2, ...; zero where it is not known.
      pure subroutine other_tooth(self, j, rho, rho_load, value)
         import :: other_value, wheel_influence_t, wp
         implicit none (type, external)
         class(wheel_influence_t), intent(in) :: self
         integer, intent(in) :: j
         real(wp), intent(in) :: rho, rho_load !! roll lengths on tooth 0 and on tooth j [m]
         type(other_value), intent(out) :: value
      end subroutine other_tooth

   end interface

   !> C with its derivatives. Every term of N C N is that of a pair k with a pair l, so the diagonal has halves.
   type :: pair_compliance
      real(wp) :: c(most_pairs, most_pairs) = 0.0_wp        !! [1/Pa]
      real(wp) :: d(most_pairs, most_pairs, 2) = 0.0_wp     !! of C_kl to foot k on A, on B; of half C_kk
      real(wp) :: d_own(most_pairs, most_pairs, 2) = 0.0_wp !! to it twice; of half C_kk
      real(wp) :: d_both(most_pairs, most_pairs, 2) = 0.0_wp !! to it and to foot l; 0 for k = l
   end type pair_compliance

contains

   !> C of n tooth pairs.
   pure subroutine gather_compliance(a, b, k_difference, is_drive, couples, n, numbers, feet, compliance)
      class(wheel_influence_t), intent(in) :: a, b
      real(wp), intent(in) :: k_difference !! K_A - K_B [1/Pa]
      logical, intent(in) :: is_drive      !! flank: pairs come in the order in which A's teeth face
      logical, intent(in) :: couples       !! false: each pair stands alone
      integer, intent(in) :: n
      integer, intent(in) :: numbers(n)    !! of the tooth pairs
      type(pair_feet), intent(in) :: feet(n)
      type(pair_compliance), intent(out) :: compliance
      type(influence_value) :: own(2)
      integer :: k, l

      do k = 1, n
         call a%own_tooth(feet(k)%foot(by_a), own(by_a))
         call b%own_tooth(feet(k)%foot(by_b), own(by_b))
         call add_materials(k_difference/2, feet(k)%foot, own)
         compliance%c(k, k) = own(by_a)%c + own(by_b)%c
         compliance%d(k, k, :) = own%d/2
         compliance%d_own(k, k, :) = own%d2/2
      end do
      if (.not. couples) return
      do k = 1, n
         do l = k + 1, n
            call add_other(a, by_a, is_drive, numbers, feet, k, l, compliance)
            call add_other(b, by_b,.not. is_drive, numbers, feet, k, l, compliance)
         end do
      end do
   end subroutine gather_compliance

   !> What one wheel has of C_kl.
   pure subroutine add_other(wheel, w, against, numbers, feet, k, l, compliance)
      class(wheel_influence_t), intent(in) :: wheel
      integer, intent(in) :: w
      logical, intent(in) :: against !! the index is k - l, else l - k
      integer, intent(in) :: numbers(:), k, l
      type(pair_feet), intent(in) :: feet(:)
      type(pair_compliance), intent(inout) :: compliance
      type(other_value) :: value
      integer :: first, second

      first = merge(l, k, against .eqv. numbers(l) > numbers(k)) ! so that its index is positive
      second = k + l - first
      call wheel%other_tooth(abs(numbers(k) - numbers(l)), feet(first)%foot(w), feet(second)%foot(w), value)
      compliance%c(k, l) = compliance%c(k, l) + value%c
      compliance%c(l, k) = compliance%c(k, l)
      compliance%d(first, second, w) = value%d_1
      compliance%d(second, first, w) = value%d_2
      compliance%d_own(first, second, w) = value%d_11
      compliance%d_own(second, first, w) = value%d_22
      compliance%d_both(first, second, w) = value%d_12
      compliance%d_both(second, first, w) = value%d_12
   end subroutine add_other

   !> Wheels of two materials.
   pure subroutine add_materials(half, foot, own)
      real(wp), intent(in) :: half !! (K_A - K_B)/2 [1/Pa]
      real(wp), intent(in) :: foot(2)
      type(influence_value), intent(inout) :: own(2)

      if (.not. abs(half) > 0) return
      own(by_a)%c = own(by_a)%c + half*log(foot(by_a)/foot(by_b))
      own%d = own%d + [half, -half]/foot
      own%d2 = own%d2 - [half, -half]/foot**2
   end subroutine add_materials

end module evl_pair_compliance
