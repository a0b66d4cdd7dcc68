!> Common base of all force laws: parameters and description.
module evl_force_law
   use evl_kind_finder, only: described_t
   use evl_kinds, only: wp
   implicit none (type, external)
   private

   public :: choice_of, force_law_t, law_choice, max_law_parameters
   public :: no, yes

   integer, parameter :: max_law_parameters = 8 !! EVL_MAX_PARAMETERS

   !> A law of a family with its parameters, as chosen by a case.
   type :: law_choice
      integer :: law = 0                                     !! index in the family's table, from 0
      real(wp) :: parameters(max_law_parameters) = 0.0_wp    !! in the units of the table
   end type law_choice

   !> A force law. Its families extend it: evl_elastic_law, evl_damping_law, evl_friction_law.
   type, abstract, extends(described_t) :: force_law_t
      integer :: index = -1                                  !! in the family's table; -1: not chosen from the table
      real(wp) :: parameters(max_law_parameters) = 0.0_wp    !! in the order and the units of the description
   contains
      procedure :: check => accept
      procedure, nopass :: is_none => no
   end type force_law_t

contains

   !> Check relations between parameters, beyond their ranges. A law with such relations overrides it.
   pure subroutine accept(self, field, message)
      class(force_law_t), intent(in) :: self   !! with parameters in their ranges
      character(len=*), intent(out) :: field   !! the parameter's name; "" if valid
      character(len=*), intent(out) :: message !! one sentence; "" if valid

      field = ""
      message = ""
   end subroutine accept

   !> A law as a case would choose it.
   pure type(law_choice) function choice_of(law) result(choice)
      class(force_law_t), intent(in) :: law

      choice = law_choice(law%index, law%parameters)
   end function choice_of

   !> Constant properties of laws.
   pure logical function no()
      no = .false.
   end function no

   pure logical function yes()
      yes = .true.
   end function yes

end module evl_force_law
