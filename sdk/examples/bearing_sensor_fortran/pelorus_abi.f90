! What a sensor needs of the headers pelorus/abi/view.h, status.h, call.h and sensor.h, member by member, as Fortran sees it. These
! structs never change but by growing at their ends, which are not looked at here.
module pelorus_abi
    use, intrinsic :: iso_c_binding
    implicit none
    private
    public :: plr_view, plr_error, plr_call, plr_sensor_measure, plr_sensor_jacobian, plr_sensor_noise, plr_sensor_residual
    public :: PLR_OK, PLR_ITEMS_FAILED, PLR_E_ARGUMENT, PLR_E_NUMERIC
    public :: array_of, place, has_shape, refuse, fail_item

    integer(c_int32_t), parameter :: PLR_OK = 0, PLR_ITEMS_FAILED = 1, PLR_E_ARGUMENT = -1, PLR_E_NUMERIC = -7

    ! Stands for plr_const_view, too.
    type, bind(C) :: plr_view
        type(c_ptr) :: data
        integer(c_int64_t) :: rows, cols, count, row_stride, col_stride, item_stride
    end type

    type, bind(C) :: plr_error
        integer(c_int32_t) :: struct_size, code
        integer(c_int64_t) :: item
        character(kind=c_char) :: where(128), message(512)
    end type

    type, bind(C) :: plr_call
        integer(c_int32_t) :: struct_size, reserved
        integer(c_int64_t) :: time, item_offset
        type(c_ptr) :: item_ids, keys, inputs
        integer(c_int64_t) :: input_stride
        type(c_ptr) :: scratch, error, item_status, log
    end type

    type, bind(C) :: plr_sensor_measure
        integer(c_int32_t) :: struct_size, reserved
        type(plr_view) :: cartesian, out
    end type

    type, bind(C) :: plr_sensor_jacobian
        integer(c_int32_t) :: struct_size, reserved
        type(plr_view) :: cartesian, out
    end type

    type, bind(C) :: plr_sensor_noise
        integer(c_int32_t) :: struct_size, reserved
        type(plr_view) :: cartesian, snr, waveform, out
    end type

    type, bind(C) :: plr_sensor_residual
        integer(c_int32_t) :: struct_size, reserved
        type(plr_view) :: measurement, reference, out
    end type

contains

    ! The doubles of a view, from its first element to its last; see `place`.
    function array_of(view) result(array)
        type(plr_view), intent(in) :: view
        real(c_double), pointer :: array(:)
        integer(c_int64_t) :: last
        last = (view%rows - 1) * view%row_stride + (view%cols - 1) * view%col_stride + (view%count - 1) * view%item_stride
        call c_f_pointer(view%data, array, [last + 1])
    end function

    ! Where element (row, col) of an item stands in array_of(view); all three count from 0, as in C.
    pure integer(c_int64_t) function place(view, item, row, col)
        type(plr_view), intent(in) :: view
        integer(c_int64_t), intent(in) :: item, row, col
        place = 1 + item * view%item_stride + col * view%col_stride + row * view%row_stride
    end function

    ! An input may be one matrix that is common to all items.
    pure logical function has_shape(view, rows, cols, count)
        type(plr_view), intent(in) :: view
        integer(c_int64_t), intent(in) :: rows, cols, count
        has_shape = view%rows == rows .and. view%cols == cols &
                    .and. (view%count == count .or. (view%count >= 1 .and. view%item_stride == 0)) &
                    .and. (c_associated(view%data) .or. rows * cols * count == 0)
    end function

    ! The call as a whole cannot be answered.
    integer(c_int32_t) function refuse(context, message) result(status)
        type(plr_call), intent(in) :: context
        character(len=*), intent(in) :: message
        call tell(context, PLR_E_ARGUMENT, -1_c_int64_t, message)
        status = PLR_E_ARGUMENT
    end function

    ! Item `item` (from 0) cannot be answered; the others can. True if the caller wants only the first failure: then stop.
    logical function fail_item(context, item, message, status) result(stop_here)
        type(plr_call), intent(in) :: context
        integer(c_int64_t), intent(in) :: item
        character(len=*), intent(in) :: message
        integer(c_int32_t), intent(inout) :: status
        integer(c_int32_t), pointer :: item_status(:)
        call tell(context, PLR_E_NUMERIC, context%item_offset + item, message)
        stop_here = .not. c_associated(context%item_status)
        if (stop_here) then
            status = PLR_E_NUMERIC
        else
            call c_f_pointer(context%item_status, item_status, [item + 1])
            item_status(item + 1) = PLR_E_NUMERIC
            status = PLR_ITEMS_FAILED
        end if
    end function

    ! Only the first error of a call is kept. Copied letter by letter: Fortran's own input and output allocate and lock.
    subroutine tell(context, code, item, message)
        type(plr_call), intent(in) :: context
        integer(c_int32_t), intent(in) :: code
        integer(c_int64_t), intent(in) :: item
        character(len=*), intent(in) :: message
        type(plr_error), pointer :: error
        integer :: i
        call c_f_pointer(context%error, error)
        if (error%code /= PLR_OK) return
        error%code = code
        error%item = item
        error%where(1) = c_null_char
        do i = 1, min(len(message), 511)
            error%message(i) = message(i:i)
        end do
        error%message(min(len(message), 511) + 1) = c_null_char
    end subroutine

end module
