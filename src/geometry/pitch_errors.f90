!> Pitch errors of a wheel from its flank tolerance class.
!>
!> Tolerances in micrometres with the reference diameter d and the module m in millimetres, class A from 1 to 11:
!>
!>    f_pT = (0.001 d + 0.4 m + 5) sqrt(2)**(A-5)                        single pitch deviation
!>    F_pT = (0.002 d + 0.55 sqrt(d) + 0.7 m + 12) sqrt(2)**(A-5)        total cumulative pitch (index) deviation
!>
!> rounded to 1 above 10, to 0.5 from 5 to 10, to 0.1 below 5. Source: ISO 1328-1:2013, 5.2 and 5.3, formulas (5) and (6).
!>
!> Random numbers are identical on every machine: the generator is SplitMix64. Its arithmetic is modulo 2**64. Fortran integers
!> are signed and must not overflow, so sums and products are formed from parts that fit. Source: G. L. Steele, D. Lea, C. H.
!> Flood, Fast splittable pseudorandom number generators, OOPSLA 2014, with the constants of S. Vigna's splitmix64.c.
module evl_pitch_errors
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_kinds, only: pi, wp
   use evl_status, only: code_invalid_input, fail, quantity, status_t, subject_wheel
   implicit none (type, external)
   private

   public :: pitch_errors_generate, pitch_tolerances, rounded_tolerance, single_pitch_deviation, total_pitch_deviation

   real(wp), parameter :: micrometre = 1.0e-6_wp
   real(wp), parameter :: millimetre = 1.0e-3_wp
   integer, parameter :: most_bisections = 100 !! more than a double has bits to halve

   integer(int64), parameter :: low_32 = int(z"FFFFFFFF", int64), low_16 = int(z"FFFF", int64)
   ! the upper half of a constant, then its lower half
   integer(int64), parameter :: increment = ior(shiftl(int(z"9E3779B9", int64), 32), int(z"7F4A7C15", int64))
   integer(int64), parameter :: first_factor = ior(shiftl(int(z"BF58476D", int64), 32), int(z"1CE4E5B9", int64))
   integer(int64), parameter :: second_factor = ior(shiftl(int(z"94D049BB", int64), 32), int(z"133111EB", int64))

contains

   !> Tolerances of the single pitch and of the total cumulative pitch deviation, arcs on the reference circle [m]. Equation D11.
   !>
   !> Valid: classes 1 to 11, 5 to 1000 teeth, modules of 0.5 to 70 mm, reference diameters of 5 to 15000 mm; the standard
   !> forbids extrapolation. Errors: code_invalid_input with field accuracy.class, teeth or module.
   subroutine pitch_tolerances(teeth, module, class, single, total, status)
      integer, intent(in) :: teeth            !! z
      real(wp), intent(in) :: module          !! m [m]
      integer, intent(in) :: class            !! A
      real(wp), intent(out) :: single         !! f_pT [m]
      real(wp), intent(out) :: total          !! F_pT [m]
      type(status_t), intent(inout) :: status
      real(wp) :: d, m, step
      character(len=16) :: text

      single = 0
      total = 0
      m = module/millimetre
      d = teeth*m
      if (class < 1 .or. class > 11) then
         write (text, "(i0)") class
         call refuse("class "//trim(text)//" must be from 1 to 11", "accuracy.class")
      else if (teeth < 5 .or. teeth > 1000) then
         write (text, "(i0)") teeth
         call refuse("ISO 1328-1:2013 has tolerances for 5 to 1000 teeth, not for "//trim(text)//"; list pitch_errors", "accuracy")
      else if (.not. (m >= 0.5_wp .and. m <= 70)) then
         call refuse("ISO 1328-1:2013 has tolerances for modules of 0.0005 to 0.07 m, not for "//quantity(module, "m") &
                     //"; list pitch_errors", "accuracy")
      else if (.not. (d >= 5 .and. d <= 15000)) then
         call refuse("ISO 1328-1:2013 has tolerances for reference diameters of 0.005 to 15 m, not for " &
                     //quantity(d*millimetre, "m")//"; list pitch_errors", "accuracy")
      else
         step = sqrt(2.0_wp)**(class - 5)
         single = rounded_tolerance((0.001_wp*d + 0.4_wp*m + 5)*step)*micrometre
         total = rounded_tolerance((0.002_wp*d + 0.55_wp*sqrt(d) + 0.7_wp*m + 12)*step)*micrometre
      end if

   contains

      subroutine refuse(message, field)
         character(len=*), intent(in) :: message, field

         call fail(status, code_invalid_input, message, subject_wheel, field=field)
      end subroutine refuse

   end subroutine pitch_tolerances

   !> Tolerance rounded according to ISO 1328-1:2013, 5.2.3, in micrometres. Equation D11.
   pure real(wp) function rounded_tolerance(tolerance)
      real(wp), intent(in) :: tolerance

      if (tolerance > 10) then
         rounded_tolerance = anint(tolerance)
      else if (tolerance >= 5) then
         rounded_tolerance = anint(2*tolerance)/2
      else
         rounded_tolerance = anint(10*tolerance)/10
      end if
   end function rounded_tolerance

   !> Cumulative position deviations of teeth 0 to z-1 [m], with mean 0. Equation D12.
   !>
   !> A wave with one period per revolution, as of an eccentric blank, plus independent, uniformly distributed errors of the
   !> teeth: F_k = A ((1 - q) sin(2 pi (k/z + u)) + q v_k), u and then v_0, v_1, ... from SplitMix64, 0 <= u < 1, -1 <= v < 1.
   !> q and A are such that the largest single pitch deviation |F_k - F_k-1| is `single` and the range of the F_k is `total`.
   !> If no q gives both, as for few teeth (the range of a wave is at most 1/sin(pi/z) times its largest step), A is the
   !> largest that exceeds neither.
   pure subroutine pitch_errors_generate(single, total, seed, errors)
      real(wp), intent(in) :: single     !! > 0 [m]
      real(wp), intent(in) :: total      !! > 0 [m]
      integer, intent(in) :: seed
      real(wp), intent(out) :: errors(:) !! one for each tooth
      real(wp) :: wave(size(errors)), noise(size(errors)), phase, low, high, q
      integer(int64) :: state
      integer :: i

      state = int(seed, int64)
      call splitmix64_uniform(state, phase)
      do i = 1, size(errors)
         wave(i) = sin(2*pi*(real(i - 1, wp)/size(errors) + phase))
         call splitmix64_uniform(state, noise(i))
         noise(i) = 2*noise(i) - 1
      end do
      ! the ratio of range to step falls from that of the wave to that of the noise
      low = 0
      high = 1
      q = 0
      if (excess(wave) > 0) then
         do i = 1, most_bisections
            q = (low + high)/2
            if (.not. (q > low .and. q < high)) exit
            if (excess((1 - q)*wave + q*noise) > 0) then
               low = q
            else
               high = q
            end if
         end do
      end if
      errors = (1 - q)*wave + q*noise
      errors = errors*min(single/single_pitch_deviation(errors), total/total_pitch_deviation(errors))
      errors = errors - sum(errors)/size(errors)

   contains

      !> Positive if the range is too large relative to the largest step.
      pure real(wp) function excess(shape)
         real(wp), intent(in) :: shape(:)

         excess = total_pitch_deviation(shape)*single - single_pitch_deviation(shape)*total
      end function excess

   end subroutine pitch_errors_generate

   !> f_p, the largest single pitch deviation of the teeth of a wheel.
   pure real(wp) function single_pitch_deviation(errors)
      real(wp), intent(in) :: errors(:)

      single_pitch_deviation = maxval(abs(errors - [errors(size(errors)), errors(:size(errors) - 1)]))
   end function single_pitch_deviation

   !> F_p, the total cumulative pitch deviation of the teeth of a wheel.
   pure real(wp) function total_pitch_deviation(errors)
      real(wp), intent(in) :: errors(:)

      total_pitch_deviation = maxval(errors) - minval(errors)
   end function total_pitch_deviation

   !> Advance the state and return its 64 random bits.
   pure subroutine splitmix64_next(state, bits)
      integer(int64), intent(inout) :: state !! the seed in the first call
      integer(int64), intent(out) :: bits

      state = add(state, increment)
      bits = state
      bits = multiply(ieor(bits, shiftr(bits, 30)), first_factor)
      bits = multiply(ieor(bits, shiftr(bits, 27)), second_factor)
      bits = ieor(bits, shiftr(bits, 31))
   end subroutine splitmix64_next

   !> Advance the state and return a multiple of 2**-53, 0 <= value < 1.
   pure subroutine splitmix64_uniform(state, value)
      integer(int64), intent(inout) :: state
      real(wp), intent(out) :: value
      integer(int64) :: bits

      call splitmix64_next(state, bits)
      value = real(shiftr(bits, 11), wp)*2.0_wp**(-53)
   end subroutine splitmix64_uniform

   !> a + b modulo 2**64.
   pure integer(int64) function add(a, b)
      integer(int64), intent(in) :: a, b
      integer(int64) :: low, high

      low = iand(a, low_32) + iand(b, low_32)
      high = shiftr(a, 32) + shiftr(b, 32) + shiftr(low, 32)
      add = ior(shiftl(high, 32), iand(low, low_32))
   end function add

   !> a b modulo 2**64: 16 bits of b at a time, so that each product of parts has at most 48 bits.
   pure integer(int64) function multiply(a, b)
      integer(int64), intent(in) :: a, b
      integer(int64) :: part, product
      integer :: i

      multiply = 0
      do i = 0, 48, 16
         part = iand(shiftr(b, i), low_16)
         product = add(iand(a, low_32)*part, shiftl(shiftr(a, 32)*part, 32))
         multiply = add(multiply, shiftl(product, i))
      end do
   end function multiply

end module evl_pitch_errors
