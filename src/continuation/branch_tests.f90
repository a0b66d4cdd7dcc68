!> Test functions of a branch: each passes zero at a special point of its kind.
!>
!> Sources: R. Seydel, Practical Bifurcation and Stability Analysis, 3rd ed., 5.3, 7.4; R. I. Leine, H. Nijmeijer, Dynamics and
!> Bifurcations of Non-Smooth Mechanical Systems, ch. 8 and 9 (jumps of multipliers).
module evl_branch_tests
   use evl_branch_point, only: kind_crossing, kind_doubling, kind_fold, kind_neimark_sacker
   use evl_kinds, only: wp
   use evl_multipliers, only: product_over_minus_one, product_over_one, product_over_pairs
   use evl_orbit_model, only: orbit_model
   use evl_periodic_orbit, only: orbit_t, own_multipliers
   implicit none (type, external)
   private

   public :: is_genuine, test, grazing_test

contains

   !> Test function that passes zero at a special point. Equation O10.
   real(wp) function test(model, kind, orbit) result(value)
      class(orbit_model), intent(in) :: model
      integer, intent(in) :: kind
      type(orbit_t), intent(in) :: orbit

      select case (kind)
      case (kind_fold)
         value = orbit%tangent(model%n + 2)
      case (kind_crossing)
         value = product_over_one(own_multipliers(model, orbit))
      case (kind_doubling)
         value = product_over_minus_one(own_multipliers(model, orbit))
      case default
         value = product_over_pairs(own_multipliers(model, orbit))
      end select
   end function test

   !> Distance of a root function from touching zero: positive if it does not reach zero, with as many crossings as `fewer`.
   !> Equation O14.
   pure real(wp) function grazing_test(orbit, root, fewer) result(value)
      type(orbit_t), intent(in) :: orbit
      integer, intent(in) :: root, fewer

      if (orbit%flow%crossings(root) == fewer) then
         value = orbit%flow%nearest(root)
      else
         value = -orbit%flow%slowest(root)
      end if
   end function grazing_test

   !> Whether the multipliers at a zero of the test function are those of its kind.
   pure logical function is_genuine(model, kind, orbit)
      class(orbit_model), intent(in) :: model
      integer, intent(in) :: kind
      type(orbit_t), intent(in) :: orbit
      real(wp), parameter :: near = 1.0e-4_wp
      complex(wp) :: mu(size(own_multipliers(model, orbit)))

      mu = own_multipliers(model, orbit)
      select case (kind)
      case (kind_crossing)
         is_genuine = any(abs(mu - 1) < near)
      case (kind_doubling)
         is_genuine = any(abs(mu + 1) < near)
      case (kind_neimark_sacker)
         is_genuine = any(abs(abs(mu) - 1) < near .and. abs(mu%im) > 0)
      case default
         is_genuine = .true.
      end select
   end function is_genuine

end module evl_branch_tests
