!> The linear spring after Yang and Lin: k = pi E* b/2, the stiffness of two cylinders whose pressure is spread over the strip of
!> contact.
!>
!> Source: D. C. H. Yang, J. Y. Lin, Hertzian damping, tooth friction and bending elasticity in gear impact dynamics,
!> ASME J. Mech. Transm. Autom. Des. 109 (1987) 189: pi E b/(4 (1 - nu**2)) for two wheels of the same material.
module evl_yang_lin
   use evl_kinds, only: pi, wp
   use evl_linear_spring, only: linear_spring_t
   use evl_row, only: kind_t
   implicit none (type, external)
   private

   public :: yang_lin_t

   type, extends(linear_spring_t) :: yang_lin_t
   contains
      procedure :: describe
      procedure :: stiffness
   end type yang_lin_t

contains

   !> Name and source.
   pure subroutine describe(self, info)
      class(yang_lin_t), intent(in) :: self
      type(kind_t), intent(inout) :: info

      info%name = "yang_lin"
      info%text = "proportional to the penetration, with the stiffness pi E* b/2"
      info%source = "Yang & Lin 1987, J. Mech. Transm. Autom. Des. 109, 189"
   end subroutine describe

   !> k [N/m]. Equation L5.
   pure real(wp) function stiffness(self, e_star, width)
      class(yang_lin_t), intent(in) :: self
      real(wp), intent(in) :: e_star !! effective modulus E* [Pa]
      real(wp), intent(in) :: width  !! common face width b [m]

      stiffness = 0.5_wp*pi*e_star*width
   end function stiffness

end module evl_yang_lin
