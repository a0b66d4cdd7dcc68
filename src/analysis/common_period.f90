!> Common period of a gearbox: after it, all meshes, teeth with individual errors, harmonic loads and housing motions are in the
!> same phase, and a motion can repeat. docs/guides/response.md.
!>
!> All cycles are counted in pitches of the first mesh of the case, as fractions: exact ones for meshes and wheels, recognised ones
!> for loads and the housing.
module evl_common_period
   use, intrinsic :: iso_fortran_env, only: int64
   use evl_flank_deviation, only: teeth_differ
   use evl_gearbox, only: gearbox_t
   use evl_housing_motion, only: term_constant, term_harmonic
   use evl_kinds, only: wp
   use evl_rational, only: divisor_of, rational_t
   use evl_status, only: code_invalid_input, fail, has_failed, quantity, status_t, subject_housing, subject_load, subject_none
   implicit none (type, external)
   private

   public :: common_period, period_t, whole_pitches

   integer(int64), parameter :: too_many = 1000001_int64 !! limit of a common period [pitches]
   integer(int64), parameter :: most_common_pitches = 10000 !! limit of the whole pitches of all meshes
   integer(int64), parameter :: most_cycles = 1000_int64 !! maximum number of pitches after which the cycles of a load are whole
   real(wp), parameter :: exact = 1.0e-9_wp !! relative: tolerance for recognising a ratio as a fraction

   type :: period_t
      integer :: pitches = 1      !! of the first mesh
      logical :: by_time = .false. !! a speed is prescribed: the period is a time; else an angle
      integer :: sense = 1        !! of a prescribed speed: +1 nominal sense of rotation, -1 opposite
      real(wp) :: time = 0.0_wp   !! [s] if by_time; else 0
   end type period_t

contains

   !> Find the common period. Errors: code_invalid_input with the reason if there is none.
   pure subroutine common_period(gearbox, period, status)
      type(gearbox_t), intent(in) :: gearbox
      type(period_t), intent(out) :: period
      type(status_t), intent(inout) :: status
      integer(int64) :: pitches
      real(wp) :: speed !! of the first mesh [pitches/s], in its nominal sense; 0 if no speed is prescribed

      pitches = 1
      call prescribed_pitches(gearbox, period, speed, status)
      if (.not. has_failed(status)) call take_meshes(gearbox, 1, too_many, pitches)
      if (.not. has_failed(status)) call take_teeth(gearbox, pitches)
      if (.not. has_failed(status)) call take_loads(gearbox, period, abs(speed), pitches, status)
      if (.not. has_failed(status)) call take_housing(gearbox, period, abs(speed), pitches, status)
      if (has_failed(status)) return
      if (pitches >= too_many) then
         call fail(status, code_invalid_input, "there is no common period within 1e6 pitches of the first mesh: the periods" &
                   //" of meshes, differing teeth and loads have no smaller common multiple", subject_none)
         return
      end if
      period%pitches = int(pitches)
      if (period%by_time) period%time = period%pitches/abs(speed)
   end subroutine common_period

   !> Whether a speed is prescribed, and the resulting speed of the first mesh.
   pure subroutine prescribed_pitches(gearbox, period, speed, status)
      type(gearbox_t), intent(in) :: gearbox
      type(period_t), intent(inout) :: period
      real(wp), intent(out) :: speed !! [pitches/s]
      type(status_t), intent(inout) :: status
      real(wp) :: nominal
      integer :: i

      speed = 0
      do i = 1, size(gearbox%loads)
         associate (load => gearbox%loads(i)%load)
            if (.not. load%prescribes) cycle
            if (load%i_segment > 0) then
               call fail(status, code_invalid_input, "there is no common period: the prescribed speed changes over time; give" &
                         //" a constant one", subject_load, i, "speed")
               return
            end if
            associate (wheel => gearbox%wheels(load%wheel), contact => gearbox%contacts(1))
               nominal = load%speed(0.0_wp, 0)/wheel%ratio ! of the reference wheel
               speed = nominal*contact%pair%advance/contact%base_pitch
            end associate
            if (.not. abs(speed) > 0) then
               call fail(status, code_invalid_input, "there is no common period: a wheel is held at speed 0, and no mesh turns", &
                         subject_load, i, "value")
               return
            end if
            period%by_time = .true.
         end associate
      end do
      if (speed < 0) period%sense = -1
   end subroutine prescribed_pitches

   !> Pitches of a mesh in which every mesh passes whole pitches, at most most_common_pitches.
   pure integer(int64) function whole_pitches(gearbox, mesh) result(pitches)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh

      pitches = 1
      call take_meshes(gearbox, mesh, most_common_pitches, pitches)
   end function whole_pitches

   !> Include whole pitches of all meshes.
   pure subroutine take_meshes(gearbox, mesh, most, pitches)
      type(gearbox_t), intent(in) :: gearbox
      integer, intent(in) :: mesh                !! mesh whose pitches are counted
      integer(int64), intent(in) :: most
      integer(int64), intent(inout) :: pitches
      integer :: m

      associate (mine => gearbox%contacts(gearbox%first(mesh))%pitches_per_turn)
         do m = 1, size(gearbox%pairs)
            associate (other => gearbox%contacts(gearbox%first(m))%pitches_per_turn)
               call take_fraction(other, mine, most, pitches)
            end associate
         end do
      end associate
   end subroutine take_meshes

   !> Include whole revolutions of the wheels with individual tooth errors.
   pure subroutine take_teeth(gearbox, pitches)
      type(gearbox_t), intent(in) :: gearbox
      integer(int64), intent(inout) :: pitches
      integer :: i

      do i = 1, size(gearbox%wheels)
         associate (wheel => gearbox%wheels(i))
            if (teeth_differ(wheel%deviation)) &
               call take_fraction(wheel%exact_ratio, gearbox%contacts(1)%pitches_per_turn, too_many, pitches)
         end associate
      end do
   end subroutine take_teeth

   !> Include whole cycles of the loads.
   pure subroutine take_loads(gearbox, period, speed, pitches, status)
      type(gearbox_t), intent(in) :: gearbox
      type(period_t), intent(in) :: period
      real(wp), intent(in) :: speed !! [pitches/s]
      integer(int64), intent(inout) :: pitches
      type(status_t), intent(inout) :: status
      real(wp) :: per_pitch
      integer :: i

      do i = 1, size(gearbox%loads)
         associate (load => gearbox%loads(i)%load, contact => gearbox%contacts(1))
            if (load%prescribes) cycle
            if (load%i_segment > 0) then
               call fail(status, code_invalid_input, "there is no common period: the load is a table over time; give a constant" &
                         //" or a harmonic one", subject_load, i, "time")
               return
            end if
            if (.not. (load%swing > 0 .or. load%swing < 0)) cycle
            if (load%by_angle) then
               per_pitch = abs(gearbox%wheels(load%wheel)%ratio*contact%base_pitch/contact%pair%advance)/load%cycle
               call take_real(per_pitch, subject_load, i, "order", pitches, status)
            else if (period%by_time) then
               call take_real(1/(load%cycle*speed), subject_load, i, "frequency", pitches, status)
            else
               call fail(status, code_invalid_input, "there is no common period: the load depends on time, and no speed is" &
                         //" prescribed; prescribe one, or give the load by order", subject_load, i, "frequency")
            end if
            if (has_failed(status)) return
         end associate
      end do
   end subroutine take_loads

   !> Include whole cycles of the prescribed housing motions.
   pure subroutine take_housing(gearbox, period, speed, pitches, status)
      type(gearbox_t), intent(in) :: gearbox
      type(period_t), intent(in) :: period
      real(wp), intent(in) :: speed !! [pitches/s]
      integer(int64), intent(inout) :: pitches
      type(status_t), intent(inout) :: status
      integer :: i

      if (.not. allocated(gearbox%housing%motion)) return
      do i = 1, size(gearbox%housing%motion)
         associate (term => gearbox%housing%motion(i))
            if (term%kind == term_constant) cycle
            if (term%kind == term_harmonic .and. period%by_time) then
               if (.not. (abs(term%value) > 0 .and. term%frequency > 0)) cycle
               call take_real(term%frequency/speed, subject_housing, 0, "frequency", pitches, status)
            else if (term%kind == term_harmonic) then
               call fail(status, code_invalid_input, "there is no common period: the housing moves over time, and no speed is" &
                         //" prescribed", subject_housing, field="kind")
            else
               call fail(status, code_invalid_input, "there is no common period: the housing moves, and not harmonically", &
                         subject_housing, field="kind")
            end if
            if (has_failed(status)) return
         end associate
      end do
   end subroutine take_housing

   !> Include cycles that occur other/mine times per pitch.
   pure subroutine take_fraction(other, mine, most, pitches)
      type(rational_t), intent(in) :: other, mine !! nonzero, of either sign
      integer(int64), intent(in) :: most
      integer(int64), intent(inout) :: pitches    !! at most `most`
      integer(int64) :: above, below

      above = abs(mine%above)/divisor_of(other%above, mine%above) ! the denominator in lowest terms, as two factors
      below = other%below/divisor_of(other%below, mine%below)
      if (real(above, wp)*real(below, wp) > real(most, wp)) then
         pitches = most
      else
         call take_whole(above*below, most, pitches)
      end if
   end subroutine take_fraction

   !> Include cycles that are whole after `cycles` pitches.
   pure subroutine take_whole(cycles, most, pitches)
      integer(int64), intent(in) :: cycles, most !! cycles: 1 .. most
      integer(int64), intent(inout) :: pitches

      pitches = min(most, pitches/divisor_of(pitches, cycles)*cycles)
   end subroutine take_whole

   !> Include cycles given by a real number per pitch.
   pure subroutine take_real(per_pitch, subject, index, field, pitches, status)
      real(wp), intent(in) :: per_pitch
      integer, intent(in) :: subject, index
      character(len=*), intent(in) :: field
      integer(int64), intent(inout) :: pitches
      type(status_t), intent(inout) :: status
      integer(int64) :: below

      do below = 1, most_cycles
         if (fits(per_pitch, below)) exit
      end do
      if (below <= most_cycles) then
         call take_whole(below, too_many, pitches)
      else
         call fail(status, code_invalid_input, "there is no common period: it makes "//quantity(per_pitch, "cycles")//" in a" &
                   //" pitch of the first mesh, no fraction of whole numbers up to 1000", subject, index, field)
      end if
   end subroutine take_real

   !> Whether a number of pitches contains whole cycles.
   pure logical function fits(per_pitch, pitches)
      real(wp), intent(in) :: per_pitch
      integer(int64), intent(in) :: pitches
      real(wp) :: cycles

      cycles = per_pitch*real(pitches, wp)
      fits = cycles > 0.5_wp .and. abs(cycles - anint(cycles)) <= exact*max(cycles, 1.0_wp)
   end function fits

end module evl_common_period
