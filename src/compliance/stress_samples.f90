!> Samples of the root stress of a wheel: Sigma at arcs of both fillets of tooth 0, under unit loads at Chebyshev points of the
!> flank of every tooth. Lengths are in modules (evl_fillet_stress).
!>
!> The farther the loaded tooth, the fewer points are necessary: the stress depends less and less on the position of the load on
!> its tooth. All teeth are included, because the loads of other meshes of the wheel act anywhere. For the own tooth the flank is
!> divided where the width of the load becomes constant, since the slope of the stress jumps there.
module evl_stress_samples
   use evl_chebyshev, only: chebyshev_points
   use evl_fillet_stress, only: fillet_arc, flank_range, stress_of_elements, widest_from
   use evl_kinds, only: wp
   use evl_plane_element, only: elasticity_t
   use evl_status, only: has_failed, status_t
   use evl_tooth_outline, only: tooth_outline_t
   implicit none (type, external)
   private

   public :: compute_stress_samples, count_stress_samples, pack_stress_samples, stress_samples_t, unpack_stress_samples

   integer, parameter, public :: stress_version = 1 !! of this method: increase it if any bit of its results changes
   integer, parameter, public :: n_arcs = 12  !! intervals of the arcs
   integer, parameter, public :: n_loads_low = 8, n_loads_high = 16 !! intervals of the loads' points on the own tooth
   integer, parameter, public :: n_loads_near = 8, n_loads_far = 4  !! on other teeth; the points of far ones are every second one
   integer, parameter, public :: n_near = 2   !! near are teeth up to this
   real(wp), parameter :: first_arc = 0.12_wp, last_arc = 0.96_wp !! relative to the arc of the fillet
   integer, parameter :: side_right = 1, side_left = 2

   !> Samples, independent of the modulus of elasticity.
   type :: stress_samples_t
      real(wp) :: arcs(0:n_arcs) = 0                  !! of the fillet, from the form circle
      real(wp) :: low = 0, border = 0, high = 0       !! radii of curvature: first load, border of both parts, last load
      real(wp) :: own_low(0:n_arcs, 0:n_loads_low, 2) = 0 !! (arc, load, right or left), tooth 0 loaded below the border
      real(wp) :: own_high(0:n_arcs, 0:n_loads_high, 2) = 0 !! likewise above the border
      real(wp) :: near(0:n_arcs, 0:n_loads_near, 2, -n_near:n_near) = 0 !! tooth j loaded; 0: not used
      real(wp), allocatable :: far(:, :, :, :)        !! (0:n_arcs, 0:n_loads_far, 2, teeth - 1), tooth 1 .. teeth - 1 loaded
   end type stress_samples_t

contains

   !> Compute the samples of a wheel fixed at its hub. Equation RS1.
   !>
   !> Errors: code_invalid_input with subject_wheel if the outline cannot be meshed.
   subroutine compute_stress_samples(outline, hub_radius, p, law, samples, status)
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: hub_radius !! in modules
      integer, intent(in) :: p           !! order of the elements
      type(elasticity_t), intent(in) :: law
      type(stress_samples_t), intent(out) :: samples
      type(status_t), intent(inout) :: status
      integer, parameter :: low = n_loads_low, high = low + 1 + n_loads_high, last = high + 1 + n_loads_near !! of each part
      real(wp), allocatable, dimension(:, :, :) :: right, left
      real(wp) :: length, rho(0:last)
      integer :: largest, j, turned

      length = fillet_arc(outline, 0.0_wp)
      samples%arcs = chebyshev_points(n_arcs, first_arc*length, last_arc*length)
      call flank_range(outline, hub_radius, p, samples%low, samples%high)
      samples%border = widest_from(outline)
      rho(:low) = chebyshev_points(n_loads_low, samples%low, samples%border)
      rho(low + 1:high) = chebyshev_points(n_loads_high, samples%border, samples%high)
      rho(high + 1:) = chebyshev_points(n_loads_near, samples%low, samples%high)
      largest = max(n_near, outline%teeth/2)
      allocate (right(0:n_arcs, 0:last, -largest:largest), left(0:n_arcs, 0:last, -largest:largest))
      call stress_of_elements(outline, hub_radius, p, law, samples%arcs, rho, largest, right, left, status)
      if (has_failed(status)) return
      samples%own_low(:, :, side_right) = right(:, :low, 0)
      samples%own_low(:, :, side_left) = left(:, :low, 0)
      samples%own_high(:, :, side_right) = right(:, low + 1:high, 0)
      samples%own_high(:, :, side_left) = left(:, low + 1:high, 0)
      do j = -n_near, n_near
         if (j == 0) cycle
         samples%near(:, :, side_right, j) = right(:, high + 1:, j)
         samples%near(:, :, side_left, j) = left(:, high + 1:, j)
      end do
      allocate (samples%far(0:n_arcs, 0:n_loads_far, 2, outline%teeth - 1))
      do j = 1, outline%teeth - 1
         turned = j
         if (j > outline%teeth/2) turned = j - outline%teeth
         samples%far(:, :, side_right, j) = right(:, high + 1::n_loads_near/n_loads_far, turned)
         samples%far(:, :, side_left, j) = left(:, high + 1::n_loads_near/n_loads_far, turned)
      end do
   end subroutine compute_stress_samples

   !> Number of values in all samples of a wheel.
   pure integer function count_stress_samples(teeth) result(n)
      integer, intent(in) :: teeth

      n = n_arcs + 4 + 2*(n_arcs + 1)*(n_loads_low + n_loads_high + 2 + (2*n_near + 1)*(n_loads_near + 1) &
                                       + (teeth - 1)*(n_loads_far + 1))
   end function count_stress_samples

   !> All samples in one array.
   pure function pack_stress_samples(samples) result(numbers)
      type(stress_samples_t), intent(in) :: samples
      real(wp), allocatable :: numbers(:)

      numbers = [samples%arcs, samples%low, samples%border, samples%high, &
                 reshape(samples%own_low, [size(samples%own_low)]), reshape(samples%own_high, [size(samples%own_high)]), &
                 reshape(samples%near, [size(samples%near)]), reshape(samples%far, [size(samples%far)])]
   end function pack_stress_samples

   !> Samples from one array.
   pure subroutine unpack_stress_samples(teeth, numbers, samples)
      integer, intent(in) :: teeth
      real(wp), intent(in) :: numbers(:) !! count_stress_samples(teeth)
      type(stress_samples_t), intent(out) :: samples
      integer :: from

      samples%arcs = numbers(:n_arcs + 1)
      samples%low = numbers(n_arcs + 2)
      samples%border = numbers(n_arcs + 3)
      samples%high = numbers(n_arcs + 4)
      from = n_arcs + 4
      samples%own_low = reshape(numbers(from + 1:from + size(samples%own_low)), shape(samples%own_low))
      from = from + size(samples%own_low)
      samples%own_high = reshape(numbers(from + 1:from + size(samples%own_high)), shape(samples%own_high))
      from = from + size(samples%own_high)
      samples%near = reshape(numbers(from + 1:from + size(samples%near)), shape(samples%near))
      from = from + size(samples%near)
      allocate (samples%far(0:n_arcs, 0:n_loads_far, 2, teeth - 1))
      samples%far(:, :, :, :) = reshape(numbers(from + 1:), shape(samples%far))
   end subroutine unpack_stress_samples

end module evl_stress_samples
