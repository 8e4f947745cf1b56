! The model: azimuth and elevation of a point seen from a fixed place, and the four hot calls of a sensor, which bearing_sensor.c
! puts into the table. They neither allocate nor keep anything: no variable here outlives a call.
module bearing_model
    use, intrinsic :: iso_c_binding
    use pelorus_abi
    implicit none
    private
    public :: bearing, bearing_measure, bearing_jacobian, bearing_noise, bearing_residual

    real(c_double), parameter :: pi = 3.14159265358979323846_c_double
    integer(c_int64_t), parameter :: none = 0, azimuth = 0, elevation = 1

    ! How an instance of bearing_sensor.c begins.
    type, bind(C) :: bearing
        real(c_double) :: position(3)  ! m
        real(c_double) :: variance(2)  ! rad^2
    end type

    interface
        ! Of C's mathematical library: exact for any quotient, and Fortran 2008 has no such function without its IEEE modules.
        pure real(c_double) function remainder(x, y) bind(C, name="remainder")
            import :: c_double
            real(c_double), value :: x, y
        end function
    end interface

contains

    pure logical function finite(value)
        real(c_double), intent(in) :: value
        finite = abs(value) <= huge(value)
    end function

    ! In (-pi, pi].
    pure real(c_double) function wrapped(angle)
        real(c_double), intent(in) :: angle
        wrapped = angle
        if (angle > -pi .and. angle <= pi) return
        wrapped = remainder(angle, 2 * pi)
        if (wrapped <= -pi) wrapped = pi
    end function

    ! The point of one column, seen from the sensor.
    subroutine look(self, view, item, col, seen)
        type(bearing), intent(in) :: self
        type(plr_view), intent(in) :: view
        integer(c_int64_t), intent(in) :: item, col
        real(c_double), intent(out) :: seen(3)
        real(c_double), pointer :: array(:)
        integer(c_int64_t) :: axis
        array => array_of(view)
        do axis = 0, 2
            seen(axis + 1) = array(place(view, item, axis, col)) - self%position(axis + 1)
        end do
    end subroutine

    ! azimuth = atan2(y, x), elevation = atan2(z, sqrt(x^2 + y^2)); both are 0 at the sensor itself.
    integer(c_int32_t) function bearing_measure(self, context, args) result(status) bind(C, name="bearing_measure")
        type(bearing), intent(in) :: self
        type(plr_call), intent(in) :: context
        type(plr_sensor_measure), intent(in) :: args
        real(c_double), pointer :: out(:)
        real(c_double) :: seen(3), ground, angles(2)
        integer(c_int64_t) :: item, col
        if (.not. has_shape(args%cartesian, 3_c_int64_t, args%out%cols, args%out%count) &
            .or. .not. has_shape(args%out, 2_c_int64_t, args%out%cols, args%out%count)) then
            status = refuse(context, "measure: expected a cartesian of 3 rows and an out of 2, with the same columns and items")
            return
        end if
        status = PLR_OK
        if (args%out%count * args%out%cols == 0) return
        out => array_of(args%out)
        items: do item = 0, args%out%count - 1
            do col = 0, args%out%cols - 1
                call look(self, args%cartesian, item, col, seen)
                if (.not. (finite(seen(1)) .and. finite(seen(2)) .and. finite(seen(3)))) then
                    if (fail_item(context, item, "the point is not finite", status)) return
                    cycle items
                end if
                ground = hypot(seen(1), seen(2))
                angles = 0
                if (ground > 0) angles(1) = wrapped(atan2(seen(2), seen(1)))
                if (ground > 0 .or. abs(seen(3)) > 0) angles(2) = atan2(seen(3), ground)
                out(place(args%out, item, azimuth, col)) = angles(1)
                out(place(args%out, item, elevation, col)) = angles(2)
            end do
        end do items
    end function

    ! With g = sqrt(x^2 + y^2) and r^2 = g^2 + z^2: d azimuth = (-y, x, 0)/g^2, d elevation = (-x z/g, -y z/g, g)/r^2.
    integer(c_int32_t) function bearing_jacobian(self, context, args) result(status) bind(C, name="bearing_jacobian")
        type(bearing), intent(in) :: self
        type(plr_call), intent(in) :: context
        type(plr_sensor_jacobian), intent(in) :: args
        real(c_double), pointer :: out(:)
        real(c_double) :: seen(3), ground, distance, rise, rows(3, 2)
        integer(c_int64_t) :: item, axis
        if (.not. has_shape(args%cartesian, 3_c_int64_t, 1_c_int64_t, args%out%count) &
            .or. .not. has_shape(args%out, 2_c_int64_t, 3_c_int64_t, args%out%count)) then
            status = refuse(context, "jacobian: expected a cartesian of 3 x 1 and an out of 2 x 3, with the same items")
            return
        end if
        status = PLR_OK
        if (args%out%count == 0) return
        out => array_of(args%out)
        do item = 0, args%out%count - 1
            call look(self, args%cartesian, item, none, seen)
            ground = hypot(seen(1), seen(2))
            distance = hypot(ground, seen(3))
            ! 1 / ground: a denormal distance has none that is finite.
            if (.not. (ground > 1e-9_c_double * distance .and. finite(distance) .and. finite(1 / ground))) then
                if (fail_item(context, item, "the object is on the sensor's vertical axis, where azimuth has no " // &
                                             "derivative, or is not finite", status)) return
                cycle
            end if
            rise = seen(3) / distance / ground / distance
            rows(:, 1) = [-seen(2) / ground / ground, seen(1) / ground / ground, 0.0_c_double]
            rows(:, 2) = [-seen(1) * rise, -seen(2) * rise, ground / distance / distance]
            do axis = 0, 2
                out(place(args%out, item, azimuth, axis)) = rows(axis + 1, 1)
                out(place(args%out, item, elevation, axis)) = rows(axis + 1, 2)
            end do
        end do
    end function

    ! Both angles err independently, wherever the object is.
    integer(c_int32_t) function bearing_noise(self, context, args) result(status) bind(C, name="bearing_noise")
        type(bearing), intent(in) :: self
        type(plr_call), intent(in) :: context
        type(plr_sensor_noise), intent(in) :: args
        real(c_double), pointer :: out(:)
        integer(c_int64_t) :: item
        if (.not. has_shape(args%out, 2_c_int64_t, 2_c_int64_t, args%out%count)) then
            status = refuse(context, "noise: expected an out of 2 x 2")
            return
        end if
        status = PLR_OK
        if (args%out%count == 0) return
        out => array_of(args%out)
        do item = 0, args%out%count - 1
            out(place(args%out, item, azimuth, azimuth)) = self%variance(1)
            out(place(args%out, item, elevation, azimuth)) = 0
            out(place(args%out, item, azimuth, elevation)) = 0
            out(place(args%out, item, elevation, elevation)) = self%variance(2)
        end do
    end function

    ! measurement - reference, by the shorter way round.
    integer(c_int32_t) function bearing_residual(self, context, args) result(status) bind(C, name="bearing_residual")
        type(bearing), intent(in) :: self
        type(plr_call), intent(in) :: context
        type(plr_sensor_residual), intent(in) :: args
        real(c_double), pointer :: measured(:), reference(:), out(:)
        real(c_double) :: angles(2)
        integer(c_int64_t) :: item, col, row, reference_col, reference_cols
        reference_cols = merge(1_c_int64_t, args%out%cols, args%reference%cols == 1)
        if (.not. has_shape(args%measurement, 2_c_int64_t, args%out%cols, args%out%count) &
            .or. .not. has_shape(args%out, 2_c_int64_t, args%out%cols, args%out%count) &
            .or. .not. has_shape(args%reference, 2_c_int64_t, reference_cols, args%out%count)) then
            status = refuse(context, "residual: expected 2 rows, a reference of 1 column or as many as measurement and out")
            return
        end if
        status = PLR_OK
        if (args%out%count * args%out%cols == 0) return
        measured => array_of(args%measurement)
        reference => array_of(args%reference)
        out => array_of(args%out)
        items: do item = 0, args%out%count - 1
            do col = 0, args%out%cols - 1
                reference_col = merge(none, col, reference_cols == 1)
                do row = 0, 1
                    angles(row + 1) = wrapped(measured(place(args%measurement, item, row, col)) &
                                              - reference(place(args%reference, item, row, reference_col)))
                end do
                if (.not. (finite(angles(1)) .and. finite(angles(2)))) then
                    if (fail_item(context, item, "an angle is not finite", status)) return
                    cycle items
                end if
                out(place(args%out, item, azimuth, col)) = angles(1)
                out(place(args%out, item, elevation, col)) = angles(2)
            end do
        end do items
    end function

end module
