/* The sensor through its table: geometry against trigonometry, the Jacobian against differences, angles that wrap, strides,
 * items that fail alone, values that are refused.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <pelorus/abi/abi.h>

static int failures = 0;

static void check(const char* what, int good) {
    if (good) return;
    printf("FAILED: %s\n", what);
    ++failures;
}

static const plr_sensor* sensor;
static const void* self;
static plr_error error;
static plr_status statuses[4];

static const plr_call* begin(int with_statuses) {
    static plr_call call;
    memset(&error, 0, sizeof error);
    memset(statuses, 0, sizeof statuses);
    error.struct_size = sizeof error;
    call = (plr_call){.struct_size = sizeof call, .error = &error, .item_status = with_statuses ? statuses : NULL};
    return &call;
}

static plr_const_view in(const double* data, int64_t rows, int64_t cols, int64_t count) {
    return (plr_const_view){data, rows, cols, count, 1, rows, rows * cols};
}
static plr_view out(double* data, int64_t rows, int64_t cols, int64_t count) {
    return (plr_view){data, rows, cols, count, 1, rows, rows * cols};
}

static void measure(const double* point, double* angles) {
    const plr_sensor_measure args = {sizeof args, 0, in(point, 3, 1, 1), out(angles, 2, 1, 1)};
    check("measure", sensor->measure(self, begin(1), &args) == PLR_OK);
}

static void check_geometry(void) {
    const double point[3] = {100 - 3000, -200 + 4000, 50 + 5000}; /* (-3000, 4000, 5000) seen from the sensor */
    double angles[2], jacobian[6];
    measure(point, angles);
    check("azimuth", fabs(angles[0] - atan2(4000, -3000)) < 1e-15);
    check("elevation", fabs(angles[1] - atan(1.0)) < 1e-15);
    const plr_sensor_jacobian args = {sizeof args, 0, in(point, 3, 1, 1), out(jacobian, 2, 3, 1)};
    check("jacobian", sensor->jacobian(self, begin(1), &args) == PLR_OK);
    for (int axis = 0; axis < 3; ++axis) {
        double up[3], down[3], above[2], below[2];
        memcpy(up, point, sizeof up);
        memcpy(down, point, sizeof down);
        up[axis] += 0.1;
        down[axis] -= 0.1;
        measure(up, above);
        measure(down, below);
        for (int row = 0; row < 2; ++row)
            check("the Jacobian is the derivative",
                  fabs(jacobian[2 * axis + row] - (above[row] - below[row]) / 0.2) < 1e-11);
    }
    const double west[3] = {100 - 1, -200 - 0.0, 50};
    measure(west, angles);
    check("west is pi, not -pi", angles[0] == acos(-1.0) && angles[1] == 0);
}

static void check_residual(void) {
    const double measured[4] = {3.1, 0.2, -3.1, 0.1}, reference[2] = {-3.1, 0.1};
    double angles[4];
    const plr_sensor_residual args = {sizeof args, 0, in(measured, 2, 2, 1), in(reference, 2, 1, 1),
                                      out(angles, 2, 2, 1)};
    check("residual", sensor->residual(self, begin(1), &args) == PLR_OK);
    check("by the shorter way", fabs(angles[0] - (6.2 - 2 * acos(-1.0))) < 1e-15 && fabs(angles[1] - 0.1) < 1e-15);
    check("nothing to wrap", angles[2] == 0 && angles[3] == 0);
}

/* The second of three points is not one; the third is above the sensor. */
static void check_items(void) {
    const double points[9] = {1, 2, 3, 4, NAN, 6, 100, -200, 90};
    double angles[6] = {7, 7, 7, 7, 7, 7}, jacobian[18];
    const plr_sensor_measure args = {sizeof args, 0, in(points, 3, 1, 3), out(angles, 2, 1, 3)};
    check("some items fail", sensor->measure(self, begin(1), &args) == PLR_ITEMS_FAILED);
    check("only that one", statuses[0] == PLR_OK && statuses[1] == PLR_E_NUMERIC && statuses[2] == PLR_OK);
    check("the error names it", error.code == PLR_E_NUMERIC && error.item == 1 && error.message[0] != 0);
    check("the others are answered", angles[0] != 7 && fabs(angles[5] - acos(0.0)) < 1e-15);
    check("the first failure, where no statuses are wanted", sensor->measure(self, begin(0), &args) == PLR_E_NUMERIC);
    const plr_sensor_jacobian derivative = {sizeof derivative, 0, in(points, 3, 1, 3), out(jacobian, 2, 3, 3)};
    check("no derivative above the sensor", sensor->jacobian(self, begin(1), &derivative) == PLR_ITEMS_FAILED &&
                                                statuses[0] == PLR_OK && statuses[2] == PLR_E_NUMERIC);
    const plr_sensor_measure wrong = {sizeof wrong, 0, in(points, 2, 1, 3), out(angles, 2, 1, 3)};
    check("a wrong shape", sensor->measure(self, begin(1), &wrong) == PLR_E_ARGUMENT);
    const plr_sensor_measure nothing = {sizeof nothing, 0, in(NULL, 3, 1, 0), out(NULL, 2, 1, 0)};
    check("no items", sensor->measure(self, begin(1), &nothing) == PLR_OK);
}

/* Structure of arrays, with room between: what packed items answer, and nothing else is written. */
static void check_strides(void) {
    const double points[2][3] = {{1, 2, 3}, {-4, 5, 6}};
    double apart[3][4], angles[2][4], packed[2];
    for (int i = 0; i < 2; ++i)
        for (int axis = 0; axis < 3; ++axis) apart[axis][2 * i] = points[i][axis];
    for (int row = 0; row < 2; ++row)
        for (int k = 0; k < 4; ++k) angles[row][k] = 7;
    const plr_sensor_measure args = {sizeof args, 0, {apart[0], 3, 1, 2, 4, 1, 2}, {angles[0], 2, 1, 2, 4, 1, 2}};
    check("any strides", sensor->measure(self, begin(1), &args) == PLR_OK);
    for (int i = 0; i < 2; ++i) {
        measure(points[i], packed);
        check("the same angles", angles[0][2 * i] == packed[0] && angles[1][2 * i] == packed[1]);
        check("nothing between", angles[0][2 * i + 1] == 7 && angles[1][2 * i + 1] == 7);
    }
}

int main(void) {
    double noise[2] = {1e-3, 2e-3};
    const double position[3] = {100, -200, 50};
    const plr_value values[2] = {
        {.struct_size = sizeof(plr_value), .present = 1, .numbers = {noise, 2, 1, 1, 1, 2, 2}},
        {.struct_size = sizeof(plr_value), .present = 1, .numbers = {position, 3, 1, 1, 1, 3, 3}}};
    const plr_config config = {.struct_size = sizeof config, .value_count = 2, .values = values};
    check("an id of somebody else", plr_entry.factory("org.example.sensor.other") == NULL);
    const plr_plugin* const plugin = plr_entry.factory("org.example.sensor.bearing");
    plr_instance instance;
    begin(0);
    if (plugin == NULL || plugin->create(&config, &instance, &error) != PLR_OK) return 1;
    sensor = (const plr_sensor*)(const void*)instance.table;
    self = instance.self;

    check_geometry();
    check_residual();
    check_items();
    check_strides();
    double covariance[4];
    const plr_sensor_noise args = {.struct_size = sizeof args, .out = out(covariance, 2, 2, 1)};
    check("noise", sensor->noise(self, begin(1), &args) == PLR_OK && covariance[0] == 1e-3 * 1e-3 &&
                       covariance[1] == 0 && covariance[2] == 0 && covariance[3] == 2e-3 * 2e-3);
    instance.table->destroy(instance.self);

    noise[1] = 0;
    begin(0);
    check("no noise is refused",
          plugin->create(&config, &instance, &error) == PLR_E_PARAMETER && strcmp(error.where, "noise") == 0);
    if (failures == 0) printf("the sensor does as it says\n");
    return failures == 0 ? 0 : 1;
}
