!> How a force law describes itself: its name, its source and its parameters.
module evl_law_info
   use evl_parameter, only: is_left_open, law_name_length => parameter_name_length, law_parameter => parameter_row, &
                            law_parameter_t => parameter_t, law_text_length => parameter_text_length, &
                            max_law_parameters => max_parameters, parameter_range_error
   implicit none (type, external)
   private

   public :: is_left_open, law_info_t, law_parameter, law_parameter_t, parameter_range_error
   public :: law_name_length, law_text_length, max_law_parameters

   !> One law; evl_law_info of the C header.
   type :: law_info_t
      character(len=law_name_length) :: name = ""        !! as in the case file
      character(len=law_text_length) :: description = "" !! one line
      character(len=law_text_length) :: source = ""      !! where the law comes from
      integer :: n_parameters = 0                        !! how many of `parameters` count
      type(law_parameter_t) :: parameters(max_law_parameters) !! in the order of law_choice%parameters
   end type law_info_t

end module evl_law_info
