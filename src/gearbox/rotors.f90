!> Rotors: wheels joined by rigid shafts.
module evl_rotors
   use evl_gearbox, only: gearbox_t
   use evl_indices, only: indices, joined_to
   use evl_status, only: code_invalid_input, fail, has_failed, status_t, subject_load, subject_shaft
   implicit none (type, external)
   private

   public :: rotors_join

contains

   !> Determine the rotor of every wheel, the wheels behind every rigid shaft, the reference wheel, and the load that prescribes the
   !> speed of a rotor.
   !>
   !> The reference wheel is the leader of the first rotor with a prescribed speed, or of the first rotor; the leader of a rotor is
   !> its first wheel. Errors: code_invalid_input for a shaft whose wheels already belong to one rotor, and for a second prescribed
   !> speed.
   subroutine rotors_join(gearbox, status)
      type(gearbox_t), intent(inout) :: gearbox !! with wheels, loads and shafts
      type(status_t), intent(inout) :: status
      logical :: joined(size(gearbox%wheels))
      integer :: i, k

      associate (a => gearbox%shafts%wheel_a, b => gearbox%shafts%wheel_b, rigid => gearbox%shafts%rigid)
         do i = 1, size(gearbox%shafts) ! an elastic shaft must not connect wheels of one rotor
            joined = joined_to(a(i), a, b, rigid .and. [(k < i .or. .not. rigid(i), k=1, size(rigid))], size(joined))
            if (.not. joined(b(i))) cycle
            call fail(status, code_invalid_input, "rigid shafts already join its two wheels, so its torque is not" &
                      //" determined", subject_shaft, i, "wheels")
            return
         end do
         do i = 1, size(gearbox%shafts)
            if (.not. rigid(i)) cycle
            joined = joined_to(b(i), a, b, rigid .and. [(k /= i, k=1, size(rigid))], size(joined))
            gearbox%shafts(i)%behind = indices(joined)
         end do
         do i = 1, size(gearbox%wheels)
            gearbox%wheels(i)%leader = findloc(joined_to(i, a, b, rigid, size(joined)), .true., dim=1)
         end do
      end associate
      do i = 1, size(gearbox%loads)
         if (gearbox%loads(i)%load%prescribes) call prescribe(i)
         if (has_failed(status)) return
      end do
      gearbox%reference = max(1, findloc(gearbox%wheels%prescribed > 0, .true., dim=1))

   contains

      !> Assign a prescribed speed to the rotor of the load.
      subroutine prescribe(load)
         integer, intent(in) :: load
         integer :: leader

         leader = gearbox%wheels(gearbox%loads(load)%load%wheel)%leader
         if (gearbox%wheels(leader)%prescribed > 0) call fail(status, code_invalid_input, &
                           "a rigid shaft joins its wheel to another whose speed is prescribed as well", subject_load, load, "kind")
         where (gearbox%wheels%leader == leader) gearbox%wheels%prescribed = load
      end subroutine prescribe

   end subroutine rotors_join

end module evl_rotors
