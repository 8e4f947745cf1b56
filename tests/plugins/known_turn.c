/* org.example.motion.known_turn: motion in a plane (or on a line, or in space) that turns at a known rate. Written in C11 with
 * nothing but the ABI's headers. State: positions, then velocities, of 1 to 3 axes.
 *
 *   v' = R(w T) v on x and y, p' = p + integral of v; Q = q [T^3/3 T^2/2; T^2/2 T] on each axis
 */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <pelorus/abi/abi.h>

#define ID "org.example.motion.known_turn"

PLR_MANIFEST(ID, "motion", PLR_MOTION, "1.0.0");

enum { max_axes = 3, max_state = 2 * max_axes };

typedef struct known_turn {
    int axes;
    double turn_rate; /* rad/s */
    double noise;     /* m2/s3 */
    plr_component components[max_state];
    plr_space space;
    plr_motion_info info;
} known_turn;

enum { parameter_axes, parameter_turn_rate, parameter_noise };

static const plr_parameter parameters[] = {
    [parameter_axes] = {.struct_size = sizeof(plr_parameter),
                        .type = PLR_TYPE_INT,
                        .name = "axes",
                        .doc = "number of axes: x, y, z",
                        .unit = "",
                        .default_text = "3",
                        .min = 1,
                        .max = max_axes},
    [parameter_turn_rate] = {.struct_size = sizeof(plr_parameter),
                             .type = PLR_TYPE_DOUBLE,
                             .name = "turn_rate",
                             .doc = "change of heading, positive from x to y",
                             .unit = "rad/s",
                             .default_text = "0 rad/s",
                             .min = -INFINITY,
                             .max = INFINITY},
    [parameter_noise] = {.struct_size = sizeof(plr_parameter),
                         .type = PLR_TYPE_DOUBLE,
                         .name = "noise",
                         .doc = "spectral density of the acceleration on each axis",
                         .unit = "m2/s3",
                         .default_text = "1 m2/s3",
                         .min = 0,
                         .max = INFINITY},
};

static const plr_description description = {.struct_size = sizeof(plr_description),
                                            .id = ID,
                                            .kind = "motion",
                                            .version = "1.0.0",
                                            .title = "Turn at a known rate",
                                            .purpose = "Flight whose heading changes at a constant, known rate.",
                                            .equation = "v' = R(w T) v; p' = p + integral of v",
                                            .source = "",
                                            .license = "Apache-2.0",
                                            .parameters = parameters,
                                            .parameter_count = sizeof parameters / sizeof parameters[0]};

static plr_status fail(plr_error* error, plr_status code, int64_t item, const char* where, const char* format, ...) {
    va_list arguments;
    if (error->code != PLR_OK) return code; /* only the first error is kept */
    error->code = code;
    error->item = item;
    snprintf(error->where, sizeof error->where, "%s", where);
    va_start(arguments, format);
    vsnprintf(error->message, sizeof error->message, format, arguments);
    va_end(arguments);
    return code;
}

/* Writes F of a step, n x n column-major. */
static void transition(const known_turn* self, double dt, double* f) {
    const int axes = self->axes, n = 2 * axes;
    const double w = self->turn_rate, angle = w * dt;
    const double s = w == 0 ? dt : sin(angle) / w, c = w == 0 ? 0 : (1 - cos(angle)) / w;
    memset(f, 0, (size_t)(n * n) * sizeof *f);
    for (int axis = 0; axis < axes; ++axis) {
        f[axis * n + axis] = 1;
        f[(axes + axis) * n + axis] = axis < 2 ? s : dt;
        f[(axes + axis) * n + axes + axis] = axis < 2 ? cos(angle) : 1;
    }
    if (axes < 2) return;
    f[(axes + 1) * n + 0] = -c; /* x by v_y */
    f[axes * n + 1] = c;        /* y by v_x */
    f[(axes + 1) * n + axes] = -sin(angle);
    f[axes * n + axes + 1] = sin(angle);
}

/* The step of item i, or an error of that item. */
static plr_status step_of(const plr_call* call, const plr_const_view* dts, int64_t i, double* dt) {
    *dt = dts->data[i * dts->item_stride];
    if (*dt >= 0) return PLR_OK;
    if (call->item_status != NULL) call->item_status[i] = PLR_E_UNSUPPORTED;
    return fail(call->error, PLR_E_UNSUPPORTED, call->item_offset + i, "", "cannot move backward in time (dt = %g s)",
                *dt);
}

/* What is not finite is no answer of item i; `status` is what the item came to so far. */
static plr_status told(const plr_call* call, int64_t i, plr_status status, const double* out, int size) {
    int is_finite = 1;
    if (status != PLR_OK) return status;
    for (int element = 0; element < size; ++element) is_finite = is_finite && isfinite(out[element]);
    if (is_finite) return PLR_OK;
    if (call->item_status != NULL) call->item_status[i] = PLR_E_NUMERIC;
    return fail(call->error, PLR_E_NUMERIC, call->item_offset + i, "", "the result is not finite");
}

/* Whether an array has `rows` rows and, unless it is -1, `cols` columns. */
static plr_status shaped(const plr_call* call, const char* name, int64_t rows, int64_t cols, int64_t wanted_rows,
                         int64_t wanted_cols) {
    if (rows == wanted_rows && (wanted_cols < 0 || cols == wanted_cols)) return PLR_OK;
    return fail(call->error, PLR_E_ARGUMENT, -1, "", "%s: is %lld x %lld, expected %lld x %lld", name, (long long)rows,
                (long long)cols, (long long)wanted_rows, (long long)(wanted_cols < 0 ? cols : wanted_cols));
}

static plr_status after(const plr_call* call, plr_status failed) {
    return failed == PLR_OK || call->item_status == NULL ? failed : (plr_status)PLR_ITEMS_FAILED;
}

static const plr_motion_info* info(const void* self) { return &((const known_turn*)self)->info; }

static plr_status propagate(const void* instance, const plr_call* call, const plr_motion_propagate* args) {
    const known_turn* self = instance;
    const int n = 2 * self->axes;
    double f[max_state * max_state], dt;
    plr_status failed = PLR_OK;
    plr_status shape = shaped(call, "state", args->state.rows, args->state.cols, n, args->out.cols);
    if (shape == PLR_OK) shape = shaped(call, "out", args->out.rows, args->out.cols, n, -1);
    if (shape != PLR_OK) return shape;
    for (int64_t i = 0; i < args->out.count; ++i) {
        plr_status status = step_of(call, &args->dt, i, &dt);
        if (status != PLR_OK) {
            failed = status;
            continue;
        }
        transition(self, dt, f);
        for (int64_t p = 0; p < args->out.cols; ++p) {
            const double* x = args->state.data + i * args->state.item_stride + p * args->state.col_stride;
            double* out = args->out.data + i * args->out.item_stride + p * args->out.col_stride;
            for (int row = 0; row < n; ++row) {
                double sum = 0;
                for (int col = 0; col < n; ++col) sum += f[col * n + row] * x[col];
                out[row] = sum;
            }
            status = told(call, i, status, out, n);
        }
        if (status != PLR_OK) failed = status;
    }
    return after(call, failed);
}

static plr_status jacobian(const void* instance, const plr_call* call, const plr_motion_jacobian* args) {
    const int n = 2 * ((const known_turn*)instance)->axes;
    plr_status failed = shaped(call, "out", args->out.rows, args->out.cols, n, n);
    double dt;
    if (failed != PLR_OK) return failed;
    for (int64_t i = 0; i < args->out.count; ++i) {
        double* out = args->out.data + i * args->out.item_stride;
        plr_status status = step_of(call, &args->dt, i, &dt);
        if (status == PLR_OK) {
            transition(instance, dt, out);
            status = told(call, i, status, out, n * n);
        }
        if (status != PLR_OK) failed = status;
    }
    return after(call, failed);
}

static plr_status noise(const void* instance, const plr_call* call, const plr_motion_noise* args) {
    const known_turn* self = instance;
    const int axes = self->axes, n = 2 * axes;
    plr_status failed = shaped(call, "out", args->out.rows, args->out.cols, n, n);
    double dt;
    if (failed != PLR_OK) return failed;
    for (int64_t i = 0; i < args->out.count; ++i) {
        double* q = args->out.data + i * args->out.item_stride;
        plr_status status = step_of(call, &args->dt, i, &dt);
        if (status != PLR_OK) {
            failed = status;
            continue;
        }
        memset(q, 0, (size_t)(n * n) * sizeof *q);
        for (int axis = 0; axis < axes; ++axis) {
            q[axis * n + axis] = self->noise * dt * dt * dt / 3;
            q[axis * n + axes + axis] = q[(axes + axis) * n + axis] = self->noise * dt * dt / 2;
            q[(axes + axis) * n + axes + axis] = self->noise * dt;
        }
        status = told(call, i, status, q, n * n);
        if (status != PLR_OK) failed = status;
    }
    return after(call, failed);
}

static void destroy(void* self) { free(self); }

static const plr_motion table = {
    {sizeof(plr_motion), 0, destroy, NULL}, info, propagate, jacobian, noise, NULL, NULL, NULL, NULL};

/* Value `index`: the host's structs may be longer than ours. */
static const plr_value* value(const plr_config* config, size_t index) {
    return (const plr_value*)(const void*)((const char*)config->values + index * config->values->struct_size);
}

static plr_status create(const plr_config* config, plr_instance* out, plr_error* error) {
    static const char* const names[2][max_axes] = {{"position.x", "position.y", "position.z"},
                                                   {"velocity.x", "velocity.y", "velocity.z"}};
    known_turn* self = calloc(1, sizeof *self);
    if (self == NULL) return fail(error, PLR_E_MEMORY, -1, "", "out of memory");
    self->axes = (int)value(config, parameter_axes)->integer;
    self->turn_rate = value(config, parameter_turn_rate)->number;
    self->noise = value(config, parameter_noise)->number;
    if (self->axes < 2 && self->turn_rate != 0) {
        free(self);
        return fail(error, PLR_E_PARAMETER, -1, "turn_rate", "a turn needs two axes at least");
    }
    for (int order = 0; order < 2; ++order)
        for (int axis = 0; axis < self->axes; ++axis) {
            const plr_component component = {sizeof component,         0, names[order][axis],
                                             order == 0 ? "m" : "m/s", 0, order == 0 ? 1e6 : 100};
            self->components[order * self->axes + axis] = component;
        }
    self->space.struct_size = sizeof self->space;
    self->space.size = (uint32_t)(2 * self->axes);
    self->space.components = self->components;
    self->info.struct_size = sizeof self->info;
    self->info.flags = PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE | PLR_MOTION_TIME_INVARIANT;
    self->info.state = self->info.cartesian = &self->space;
    out->self = self;
    out->table = &table.head;
    return PLR_OK;
}

static const plr_plugin plugin = {sizeof(plr_plugin), 0, &description, PLR_MOTION, create};

static const plr_plugin* factory(const char* id) { return strcmp(id, ID) == 0 ? &plugin : NULL; }

PLR_EXPORT const plr_entry_point plr_entry = {sizeof plr_entry, PLR_ABI_MAJOR, PLR_ABI_MINOR, NULL, NULL, factory};
