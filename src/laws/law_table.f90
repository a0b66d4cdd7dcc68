!> The table of all force laws: a line each. The index of a law is its place in the list of its family, from 0.
module evl_law_table
   use evl_coulomb, only: coulomb_t
   use evl_damping_law, only: damping_law_t
   use evl_damping_ratio, only: damping_ratio_t
   use evl_elastic_law, only: elastic_law_t
   use evl_flores, only: flores_t
   use evl_force_law, only: force_law_t, law_choice
   use evl_friction_law, only: friction_law_t
   use evl_given, only: given_t
   use evl_gonthier, only: gonthier_t
   use evl_hunt_crossley, only: hunt_crossley_t
   use evl_johnson, only: johnson_t
   use evl_lankarani_nikravesh, only: lankarani_nikravesh_t
   use evl_lee_wang, only: lee_wang_t
   use evl_linear_damping, only: linear_damping_t
   use evl_linear_spring, only: linear_spring_t
   use evl_no_damping, only: no_damping_t
   use evl_no_friction, only: no_friction_t
   use evl_one_sided_damping, only: one_sided_damping_t
   use evl_power_spring, only: power_spring_t
   use evl_radzimovsky, only: radzimovsky_t
   use evl_rigid, only: rigid_t
   use evl_row, only: is_left_open, kind_t, range_error
   use evl_status, only: code_invalid_input, code_ok, message_length
   use evl_stribeck, only: stribeck_t
   use evl_tanh_friction, only: tanh_friction_t
   use evl_yang_lin, only: yang_lin_t
   implicit none (type, external)
   private

   public :: chosen_law, damping_law, elastic_law, friction_law
   public :: law_count, law_describe, law_validate
   public :: laws_contact, laws_damping, laws_friction

   integer, parameter :: laws_contact = 0  !! family of the elastic laws; evl_law_family of the C header
   integer, parameter :: laws_damping = 1  !! family of the viscous laws
   integer, parameter :: laws_friction = 2 !! family of the friction laws

contains

   !> The table. Take law `index` of a family out of it, without parameters, and count the laws of the family.
   subroutine take_law(family, index, law, n)
      integer, intent(in) :: family
      integer, intent(in) :: index                           !! from 0
      class(force_law_t), allocatable, intent(out) :: law    !! not allocated if there is no such law
      integer, intent(out) :: n                              !! 0 if there is no such family

      n = 0
      select case (family)
      case (laws_contact)
         call enter_elastic(johnson_t())
         call enter_elastic(radzimovsky_t())
         call enter_elastic(linear_spring_t())
         call enter_elastic(yang_lin_t())
         call enter_elastic(power_spring_t())
         call enter_elastic(rigid_t())
      case (laws_damping)
         call enter_damping(no_damping_t())
         call enter_damping(linear_damping_t())
         call enter_damping(one_sided_damping_t())
         call enter_damping(hunt_crossley_t())
         call enter_damping(lankarani_nikravesh_t())
         call enter_damping(flores_t())
         call enter_damping(gonthier_t())
         call enter_damping(lee_wang_t())
         call enter_damping(damping_ratio_t())
      case (laws_friction)
         call enter_friction(no_friction_t())
         call enter_friction(coulomb_t())
         call enter_friction(tanh_friction_t())
         call enter_friction(stribeck_t())
      end select

   contains

      ! A law under another family's case does not compile.

      subroutine enter_elastic(entry)
         class(elastic_law_t), intent(in) :: entry

         call enter(entry)
      end subroutine enter_elastic

      subroutine enter_damping(entry)
         class(damping_law_t), intent(in) :: entry

         call enter(entry)
      end subroutine enter_damping

      subroutine enter_friction(entry)
         class(friction_law_t), intent(in) :: entry

         call enter(entry)
      end subroutine enter_friction

      subroutine enter(entry)
         class(force_law_t), intent(in) :: entry

         if (n == index) then
            allocate (law, source=entry)
            law%index = index
         end if
         n = n + 1
      end subroutine enter

   end subroutine take_law

   !> Number of laws of a family; 0 if there is no such family.
   integer function law_count(family) result(n)
      integer, intent(in) :: family !! laws_contact, laws_damping or laws_friction
      class(force_law_t), allocatable :: law

      call take_law(family, -1, law, n)
   end function law_count

   !> Describe law `index` of a family.
   subroutine law_describe(family, index, info, code)
      integer, intent(in) :: family           !! laws_contact, laws_damping or laws_friction
      integer, intent(in) :: index            !! from 0; there is none after the last
      type(kind_t), intent(out) :: info   !! empty if there is no such law
      integer, intent(out) :: code            !! code_ok, or code_invalid_input if there is no such law
      class(force_law_t), allocatable :: law
      integer :: n

      call take_law(family, index, law, n)
      code = merge(code_ok, code_invalid_input, allocated(law))
      if (allocated(law)) call law%describe(info)
   end subroutine law_describe

   !> The law that a block chooses, with its parameters; NaN for those that it leaves open.
   subroutine chosen_law(family, block, choice)
      integer, intent(in) :: family
      type(given_t), intent(in) :: block
      type(law_choice), intent(out) :: choice !! behind the last law of the family if there is no such law
      class(force_law_t), allocatable :: law
      type(kind_t) :: info
      integer :: i, n

      choice%law = -1
      do
         choice%law = choice%law + 1
         call take_law(family, choice%law, law, n)
         if (.not. allocated(law)) return
         call law%describe(info)
         if (block%word("law") == info%name) exit
      end do
      if (.not. allocated(info%rows)) return
      do i = 1, size(info%rows)
         choice%parameters(i) = block%number(trim(info%rows(i)%key))
      end do
   end subroutine chosen_law

   !> The elastic law of a choice; not allocated if there is no such law.
   subroutine elastic_law(choice, law)
      type(law_choice), intent(in) :: choice
      class(elastic_law_t), allocatable, intent(out) :: law
      class(force_law_t), allocatable :: entry
      integer :: n

      call take_law(laws_contact, choice%law, entry, n)
      if (.not. allocated(entry)) return
      select type (entry)
      class is (elastic_law_t)
         allocate (law, source=entry)
         law%parameters = choice%parameters
      end select
   end subroutine elastic_law

   !> The damping law of a choice; not allocated if there is no such law.
   subroutine damping_law(choice, law)
      type(law_choice), intent(in) :: choice
      class(damping_law_t), allocatable, intent(out) :: law
      class(force_law_t), allocatable :: entry
      integer :: n

      call take_law(laws_damping, choice%law, entry, n)
      if (.not. allocated(entry)) return
      select type (entry)
      class is (damping_law_t)
         allocate (law, source=entry)
         law%parameters = choice%parameters
      end select
   end subroutine damping_law

   !> The friction law of a choice; not allocated if there is no such law.
   subroutine friction_law(choice, law)
      type(law_choice), intent(in) :: choice
      class(friction_law_t), allocatable, intent(out) :: law
      class(force_law_t), allocatable :: entry
      integer :: n

      call take_law(laws_friction, choice%law, entry, n)
      if (.not. allocated(entry)) return
      select type (entry)
      class is (friction_law_t)
         allocate (law, source=entry)
         law%parameters = choice%parameters
      end select
   end subroutine friction_law

   !> Check that a choice names a law of the family and that its parameters are valid.
   subroutine law_validate(family, choice, code, field, message)
      integer, intent(in) :: family            !! laws_contact, laws_damping or laws_friction
      type(law_choice), intent(in) :: choice   !! to check; parameters that the law does not have are ignored
      integer, intent(out) :: code             !! code_ok or code_invalid_input
      character(len=*), intent(out) :: field   !! "law", or the parameter's name; "" if valid
      character(len=*), intent(out) :: message !! one sentence; "" if valid
      class(force_law_t), allocatable :: law
      type(kind_t) :: info
      character(len=message_length) :: reason
      character(len=12) :: number
      integer :: i, n

      message = ""
      call take_law(family, choice%law, law, n)
      if (.not. allocated(law)) then
         code = code_invalid_input
         field = "law"
         write (number, "(i0)") choice%law
         message = "there is no law "//trim(number)//" in this family"
         return
      end if
      call law%describe(info)
      reason = ""
      if (.not. allocated(info%rows)) allocate (info%rows(0))
      do i = 1, size(info%rows)
         field = info%rows(i)%key
         if (is_left_open(info%rows(i), choice%parameters(i))) cycle
         reason = range_error(info%rows(i), choice%parameters(i))
         if (reason /= "") exit
      end do
      if (reason == "") then
         law%parameters = choice%parameters
         call law%check(field, reason)
      end if
      code = merge(code_ok, code_invalid_input, reason == "")
      if (reason /= "") message = trim(reason)//" (law "//trim(info%name)//")"
   end subroutine law_validate

end module evl_law_table
