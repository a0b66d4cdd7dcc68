!> Special points of a branch, where its stability changes: folds, crossings of branches, period doublings, Neimark-Sacker
!> points, and orbits of which a root function just touches zero (grazing).
!>
!> Each is a zero of a test function between two neighbouring points of a branch.
!>
!> Sources: R. Seydel, Practical Bifurcation and Stability Analysis, 3rd ed., 5.3, 7.4; R. I. Leine, H. Nijmeijer, Dynamics and
!> Bifurcations of Non-Smooth Mechanical Systems, ch. 8 and 9 (jumps of multipliers).
module evl_special_points
   use evl_branch_point, only: branch_point, kind_crossing, kind_fold, kind_grazing, kind_neimark_sacker
   use evl_branch_tests, only: grazing_test, test
   use evl_kinds, only: wp
   use evl_orbit_model, only: orbit_model
   use evl_periodic_orbit, only: orbit_options, orbit_t
   use evl_special_point_search, only: locate, location_t
   use evl_status, only: has_failed, status_t
   implicit none (type, external)
   private

   public :: find_special_points

contains

   !> Find all special points between two neighbouring points of a branch, in their order.
   subroutine find_special_points(model, options, first, last, arclength, points, leap, is_missed, status)
      class(orbit_model), intent(inout) :: model
      type(orbit_options), intent(in) :: options
      type(orbit_t), intent(in) :: first, last !! with tangents
      real(wp), intent(in) :: arclength              !! distance between them along the tangent of the first
      type(branch_point), allocatable, intent(out) :: points(:) !! `arclength` is measured from `first`
      real(wp), intent(out) :: leap            !! largest distance of orbits beside a grazing point, over the way: 0 on a branch
      logical, intent(out) :: is_missed        !! a grazing point was not found, though orbits close to both sides of it were
      type(status_t), intent(inout) :: status
      type(branch_point) :: located(kind_neimark_sacker + model%n_roots)
      real(wp), parameter :: upright = 1.0e-8_wp !! a branch at a constant parameter, as of a linear system, has no folds
      real(wp), parameter :: undamped = 1.0e-8_wp !! products of pairs without damping are 1 everywhere, up to rounding
      type(location_t) :: found
      logical :: was_lost(model%n_roots)
      integer :: kind, n, other, root

      n = 0
      was_lost = .false.
      leap = 0
      is_missed = .false.
      do kind = kind_fold, kind_neimark_sacker
         if (.not. test(model, kind, first)*test(model, kind, last) < 0) cycle
         if (max(abs(test(model, kind, first)), abs(test(model, kind, last))) < undamped .and. kind == kind_neimark_sacker) cycle
         if (kind == kind_fold .and. max(abs(test(model, kind, first)), abs(test(model, kind, last))) < upright) cycle
         if (kind == kind_crossing) then ! a fold is one too
            if (test(model, kind_fold, first)*test(model, kind_fold, last) < 0) cycle
         end if
         call locate(model, options, first, last, arclength, kind, 0, found, status)
         if (has_failed(status)) return
         if (found%exists) call serialize(found%point)
      end do
      do root = 1, model%n_roots
         if (first%flow%crossings(root) == last%flow%crossings(root)) cycle
         if (is_known(located(:n), first, last, root)) cycle
         if (any(are_alike(first, last, root, [(other, other=1, root - 1)]) .and. was_lost(:root - 1))) cycle
         call locate(model, options, first, last, arclength, kind_grazing, root, found, status)
         was_lost(root) = .not. found%exists
         if (has_failed(status)) return
         leap = max(leap, found%leap)
         is_missed = is_missed .or. found%is_missed
         if (found%exists) call serialize(found%point)
      end do
      points = located(:n)
      call sort(points)

   contains

      subroutine serialize(point)
         type(branch_point), intent(in) :: point

         n = n + 1
         located(n) = point
      end subroutine serialize

   end subroutine find_special_points

   !> Whether a root function touches at a known point, as those of two tooth pairs that share a load do: that is one point.
   pure logical function is_known(points, first, last, root)
      type(branch_point), intent(in) :: points(:)
      type(orbit_t), intent(in) :: first, last
      integer, intent(in) :: root
      real(wp), parameter :: near = 1.0e-6_wp
      real(wp) :: at_ends
      integer :: fewer, i

      is_known = .false.
      fewer = min(first%flow%crossings(root), last%flow%crossings(root))
      at_ends = min(abs(grazing_test(first, root, fewer)), abs(grazing_test(last, root, fewer)))
      do i = 1, size(points)
         if (points(i)%kind == kind_grazing) &
            is_known = is_known .or. abs(grazing_test(points(i)%orbit, root, fewer)) <= near*at_ends
      end do
   end function is_known

   !> Whether two root functions are equal on both sides, as those of two tooth pairs that share a load: if one was not
   !> located, the other one cannot be located either.
   elemental logical function are_alike(first, last, root, other)
      type(orbit_t), intent(in) :: first, last
      integer, intent(in) :: root, other
      real(wp), parameter :: near = 1.0e-6_wp
      integer :: fewer, more

      more = first%flow%crossings(other) - first%flow%crossings(root)
      are_alike = last%flow%crossings(other) - last%flow%crossings(root) == more
      if (.not. are_alike) return
      fewer = min(first%flow%crossings(root), last%flow%crossings(root))
      are_alike = same(grazing_test(first, root, fewer), grazing_test(first, other, fewer + more)) &
                  .and. same(grazing_test(last, root, fewer), grazing_test(last, other, fewer + more))

   contains

      elemental logical function same(a, b)
         real(wp), intent(in) :: a, b

         same = abs(a - b) <= near*abs(a)
      end function same

   end function are_alike

   !> Sort by their position.
   subroutine sort(points)
      type(branch_point), intent(inout) :: points(:)
      type(branch_point) :: held
      integer :: i, j

      do i = 2, size(points)
         held = points(i)
         do j = i - 1, 1, -1
            if (points(j)%arclength <= held%arclength) exit
            points(j + 1) = points(j)
         end do
         points(j + 1) = held
      end do
   end subroutine sort

end module evl_special_points
