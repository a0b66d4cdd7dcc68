!> C interface: how this kernel was built.
module evl_capi_build
   use, intrinsic :: iso_c_binding, only: c_char, c_loc, c_null_char, c_ptr
   use, intrinsic :: iso_fortran_env, only: compiler_options, compiler_version
   implicit none (type, external)
   private

   public :: evl_kernel_compiler, evl_kernel_processor

   ! The compiler notes -march even where it is its own default; of several the last counts.
   character(len=*), parameter :: options = compiler_options()//" ", key = "-march="
   integer, parameter :: before = index(options, key, back=.true.)
   integer, parameter :: first = merge(before + len(key), 1, before > 0)
   integer, parameter :: length = merge(index(options(first:), " ") - 1, 0, before > 0)

   ! Written once, at compile time; C gets their addresses.
   character(len=len(compiler_version()) + 1, kind=c_char), target, protected :: compiler = compiler_version()//c_null_char
   character(len=length + 1, kind=c_char), target, protected :: processor = options(first:first + length - 1)//c_null_char

contains

   type(c_ptr) function evl_kernel_compiler() bind(c)
      evl_kernel_compiler = c_loc(compiler)
   end function evl_kernel_compiler

   type(c_ptr) function evl_kernel_processor() bind(c)
      evl_kernel_processor = c_loc(processor)
   end function evl_kernel_processor

end module evl_capi_build
