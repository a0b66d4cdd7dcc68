!> Johnson's contact in series with a body, for the tests: C calls that the kernel does not export.
module compliant_calls
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use evl_compliant_johnson, only: compliant_contact, compliant_energy, compliant_force, compliant_force_lanes, &
                                    compliant_penetration
   use evl_kinds, only: lanes
   implicit none (type, external)
   private

   public :: test_compliant_force, test_compliant_lanes, test_compliant_penetration

contains

   !> Forces with their derivatives to h, c and Lambda, and energies.
   subroutine test_compliant_force(n, h, length, c, e_star, force, d_h, d_c, d_length, energy, codes) bind(c)
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: h(n), length(n), c(n), e_star(n)
      real(c_double), intent(out) :: force(n), d_h(n), d_c(n), d_length(n), energy(n)
      integer(c_int), intent(out) :: codes(n)
      type(compliant_contact) :: contacts(n)

      call compliant_force(h, length, c, e_star, contacts, codes)
      force = contacts%force
      d_h = contacts%d_h
      d_c = contacts%d_c
      d_length = contacts%d_length
      energy = compliant_energy(h, force, e_star)
   end subroutine test_compliant_force

   !> Eight forces at once; 1 if there is an answer.
   integer(c_int) function test_compliant_lanes(h, length, c, e_star, force) result(answer) bind(c)
      real(c_double), intent(in) :: h(lanes), length(lanes), c(lanes)
      real(c_double), intent(in), value :: e_star
      real(c_double), intent(out) :: force(lanes)
      logical :: is_defined

      call compliant_force_lanes(h, length, c, e_star, force, is_defined)
      answer = merge(1, 0, is_defined)
   end function test_compliant_lanes

   !> The inverse.
   subroutine test_compliant_penetration(n, force, length, c, e_star, h, d_force, codes) bind(c)
      integer(c_int), intent(in), value :: n
      real(c_double), intent(in) :: force(n), length(n), c(n), e_star(n)
      real(c_double), intent(out) :: h(n), d_force(n)
      integer(c_int), intent(out) :: codes(n)

      call compliant_penetration(force, length, c, e_star, h, d_force, codes)
   end subroutine test_compliant_penetration

end module compliant_calls
