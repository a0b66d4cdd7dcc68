!> Store of influence functions of wheels, with all the data that determine them as the key.
!>
!> Keys and values are real arrays, so that an extension can store them elsewhere. Stored values replace a computation exactly:
!> equal keys mean identical bits, independent of the module, width and modulus of the wheel.
module evl_influence_store
   use evl_influence_functions, only: compute_influence, influence_t, influence_version, n_neighbours, n_other, n_own
   use evl_kinds, only: wp
   use evl_plane_element, only: elasticity_t
   use evl_status, only: has_failed, status_t
   use evl_tooth_outline, only: tooth_outline_t
   implicit none (type, external)
   private

   public :: influence_by_store, influence_store_t, n_key, wheel_key

   integer, parameter :: n_key = 19
   integer, parameter :: n_numbers = 2*(n_own + 1) + (2*n_neighbours + 1)*(n_other + 1)**2

   !> Entry of one wheel: its influence functions, or its root stress with a longer key.
   type :: entry_t
      real(wp), allocatable :: key(:)
      real(wp), allocatable :: numbers(:)
   end type entry_t

   !> Store in memory, for its own lifetime.
   type :: influence_store_t
      type(entry_t), allocatable, private :: entries(:)
   contains
      procedure :: find
      procedure :: put
   end type influence_store_t

contains

   !> Influence functions of a wheel: from the store, or computed and added to the store.
   !>
   !> Errors: those of compute_influence and of the store.
   subroutine influence_by_store(store, outline, hub_radius, order, law, influence, status)
      class(influence_store_t), intent(inout) :: store
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: hub_radius !! in modules
      integer, intent(in) :: order       !! of the elements
      type(elasticity_t), intent(in) :: law
      type(influence_t), intent(out) :: influence
      type(status_t), intent(inout) :: status
      real(wp) :: key(n_key), numbers(n_numbers)
      logical :: is_known

      key = wheel_key(outline, hub_radius, order, law)
      call store%find(key, numbers, is_known, status)
      if (has_failed(status)) return
      if (.not. is_known) then
         call compute_influence(outline, hub_radius, order, law, influence, status)
         if (has_failed(status)) return
         numbers = [influence%rho, influence%own, reshape(influence%other, [size(influence%other)])]
         call store%put(key, numbers, status)
         if (has_failed(status)) return
      end if
      influence%rho = numbers(:n_own + 1)
      influence%own = numbers(n_own + 2:2*n_own + 2)
      influence%other = reshape(numbers(2*n_own + 3:), shape(influence%other))
   end subroutine influence_by_store

   !> Key of a wheel: all independent data of its elements.
   pure function wheel_key(outline, hub_radius, order, law) result(key)
      type(tooth_outline_t), intent(in) :: outline
      real(wp), intent(in) :: hub_radius !! in modules
      integer, intent(in) :: order       !! of the elements
      type(elasticity_t), intent(in) :: law
      real(wp) :: key(n_key)

      ! to the last bit: a wheel with another module may differ in the last bit
      key = [real(influence_version, wp), real(order, wp), hub_radius, &
             law%direct, law%across, law%shear, law%plane_modulus, law%tangential, &
             real(outline%teeth, wp), outline%pressure_angle, outline%half_tooth, outline%reference_radius, outline%base_radius, &
             outline%tip_radius, outline%root_radius, outline%tip_angle, outline%rho_form, outline%rho_tip, outline%rounding]
   end function wheel_key

   !> Return the values of a key, if present.
   subroutine find(self, key, numbers, is_known, status)
      class(influence_store_t), intent(inout) :: self
      real(wp), intent(in) :: key(:)
      real(wp), intent(out) :: numbers(:)
      logical, intent(out) :: is_known
      type(status_t), intent(inout) :: status !! for extensions
      integer :: i

      is_known = .false.
      numbers = 0
      if (has_failed(status) .or. .not. allocated(self%entries)) return
      do i = 1, size(self%entries)
         if (size(self%entries(i)%key) /= size(key)) cycle
         is_known = all(abs(self%entries(i)%key - key) <= 0)
         if (.not. is_known) cycle
         numbers = self%entries(i)%numbers
         return
      end do
   end subroutine find

   !> Store computed values. An extension may return other values, which are then used.
   subroutine put(self, key, numbers, status)
      class(influence_store_t), intent(inout) :: self
      real(wp), intent(in) :: key(:)
      real(wp), intent(inout) :: numbers(:)
      type(status_t), intent(inout) :: status !! for extensions
      type(entry_t), allocatable :: longer(:)
      integer :: i, n

      if (has_failed(status)) return
      if (.not. allocated(self%entries)) allocate (self%entries(0))
      n = size(self%entries)
      allocate (longer(n + 1)) ! not by constructors: gfortran 12 does not free the components of theirs
      do i = 1, n
         call move_alloc(self%entries(i)%key, longer(i)%key)
         call move_alloc(self%entries(i)%numbers, longer(i)%numbers)
      end do
      longer(n + 1)%key = key
      longer(n + 1)%numbers = numbers
      call move_alloc(longer, self%entries)
   end subroutine put

end module evl_influence_store
