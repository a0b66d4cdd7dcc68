!> The places of teeth in a train for the tests: a C call that the kernel does not export.
module tooth_phase_calls
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use evl_capi_types, only: c_status, status_to_c
   use evl_first_tooth_pair, only: find_tooth_phases, tooth_mesh_t, tooth_phase_t
   use evl_status, only: status_t
   implicit none (type, external)
   private

   public :: test_tooth_phases

   !> The fields of `tooth_mesh_t`, wheels from 0.
   type, bind(c) :: c_tooth_mesh
      integer(c_int) :: wheel_a, wheel_b, sigma
      real(c_double) :: chi, alpha_w, rho, base_pitch, rho_start, backlash
   end type c_tooth_mesh

   !> The fields of `tooth_phase_t`.
   type, bind(c) :: c_tooth_phase
      real(c_double) :: rho_start, gap
      integer(c_int) :: tooth_a, tooth_b
   end type c_tooth_phase

contains

   !> Place the teeth of a train from its first mesh on.
   integer(c_int) function test_tooth_phases(n_wheels, base_radii, tooth_angles, teeth, n_meshes, meshes, phases, status) &
      result(code) bind(c)
      integer(c_int), intent(in), value :: n_wheels, n_meshes
      real(c_double), intent(in) :: base_radii(n_wheels), tooth_angles(n_wheels)
      integer(c_int), intent(in) :: teeth(n_wheels)
      type(c_tooth_mesh), intent(in) :: meshes(n_meshes)
      type(c_tooth_phase), intent(out) :: phases(n_meshes)
      type(c_status), intent(out), optional :: status
      type(tooth_mesh_t) :: kernel_meshes(n_meshes)
      type(tooth_phase_t) :: found(n_meshes)
      type(status_t) :: s
      integer :: i

      do i = 1, n_meshes
         associate (c => meshes(i))
            kernel_meshes(i) = tooth_mesh_t(c%wheel_a + 1, c%wheel_b + 1, c%sigma, c%chi, c%alpha_w, c%rho, c%base_pitch, &
                                            c%rho_start, c%backlash)
         end associate
      end do
      call find_tooth_phases(base_radii, tooth_angles, teeth, kernel_meshes, found, s)
      do i = 1, n_meshes
         phases(i) = c_tooth_phase(found(i)%rho_start, found(i)%gap, found(i)%tooth_a, found(i)%tooth_b)
      end do
      if (present(status)) call status_to_c(s, status)
      code = s%code
   end function test_tooth_phases

end module tooth_phase_calls
