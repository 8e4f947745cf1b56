/* org.example.sensor.bearing: what the host reads of the sensor: manifest, description, spaces, creation. The model itself is in
 * bearing_model.f90. Strings and tables of pointers are what C is good at.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <pelorus/abi/abi.h>

#define ID "org.example.sensor.bearing"
#define VERSION "1.0.0"

PLR_MANIFEST(ID, "sensor", PLR_SENSOR, VERSION);

/* Begins like the type of the same name in bearing_model.f90. */
typedef struct bearing {
    double position[3]; /* m */
    double variance[2]; /* rad^2 */
} bearing;

/* bearing_model.f90 */
plr_status bearing_measure(const void* self, const plr_call* call, const plr_sensor_measure* args);
plr_status bearing_jacobian(const void* self, const plr_call* call, const plr_sensor_jacobian* args);
plr_status bearing_noise(const void* self, const plr_call* call, const plr_sensor_noise* args);
plr_status bearing_residual(const void* self, const plr_call* call, const plr_sensor_residual* args);

enum { parameter_noise, parameter_position, parameter_count };

static const double least_noise = 1e-9, most_noise = 1.0; /* rad */

static const plr_parameter parameters[parameter_count] = {
    [parameter_noise] = {.struct_size = sizeof(plr_parameter),
                         .type = PLR_TYPE_VECTOR,
                         .name = "noise",
                         .doc = "deviations of azimuth and elevation; for scans that carry no covariances",
                         .unit = "rad",
                         .default_text = "[1 mrad, 1 mrad]",
                         .min = 1e-9,
                         .max = 1.0,
                         .rows_min = 2,
                         .rows_max = 2},
    [parameter_position] = {.struct_size = sizeof(plr_parameter),
                            .type = PLR_TYPE_VECTOR,
                            .name = "position",
                            .doc = "where the sensor stands",
                            .unit = "m",
                            .default_text = "[0 m, 0 m, 0 m]",
                            .min = -INFINITY,
                            .max = INFINITY,
                            .rows_min = 3,
                            .rows_max = 3}};

static const plr_description description = {
    .struct_size = sizeof(plr_description),
    .id = ID,
    .kind = "sensor",
    .version = VERSION,
    .title = "Bearings: azimuth and elevation",
    .purpose =
        "A camera, direction finder or passive sonar that sees in which direction something is, not how far away. It "
        "cannot start a track; beside a sensor that can, it makes it precise across the line of sight.",
    .equation =
        "(x, y, z) = p - position; azimuth = atan2(y, x); elevation = atan2(z, sqrt(x^2 + y^2)); R = diag(noise^2)",
    .source = "",
    .license = "Apache-2.0",
    .parameters = parameters,
    .parameter_count = parameter_count};

static const plr_component angles[2] = {{sizeof(plr_component), PLR_COMPONENT_ANGLE, "azimuth", "rad", 0, 0},
                                        {sizeof(plr_component), PLR_COMPONENT_ANGLE, "elevation", "rad", 0, 0}};
static const plr_component positions[3] = {{sizeof(plr_component), 0, "position.x", "m", 0, 0},
                                           {sizeof(plr_component), 0, "position.y", "m", 0, 0},
                                           {sizeof(plr_component), 0, "position.z", "m", 0, 0}};
static const plr_space measurement = {sizeof(plr_space), 2, angles};
static const plr_space cartesian = {sizeof(plr_space), 3, positions};

static const plr_sensor_info the_info = {.struct_size = sizeof(plr_sensor_info),
                                         .flags = PLR_FLAG_ANY_STRIDE | PLR_SENSOR_CONSTANT_NOISE,
                                         .measurement = &measurement,
                                         .cartesian = &cartesian};

static const plr_sensor_info* info(const void* self) {
    (void)self; /* all instances look at the same spaces */
    return &the_info;
}

static void destroy(void* self) { free(self); }

static const plr_sensor table = {{sizeof(plr_sensor), 0, destroy, NULL},
                                 info,
                                 bearing_measure,
                                 bearing_jacobian,
                                 bearing_noise,
                                 bearing_residual,
                                 NULL};

static plr_status refuse(plr_error* error, const char* parameter, const char* message) {
    if (error->code != PLR_OK) return PLR_E_PARAMETER;
    error->code = PLR_E_PARAMETER;
    error->item = -1;
    snprintf(error->where, sizeof error->where, "%s", parameter);
    snprintf(error->message, sizeof error->message, "%s", message);
    return PLR_E_PARAMETER;
}

/* The numbers of value `index`, if there are `size`; the host's structs may be longer than ours. */
static const plr_const_view* vector(const plr_config* config, uint32_t index, int64_t size) {
    if (index >= config->value_count) return NULL;
    const char* const at = (const char*)config->values + (size_t)index * config->values->struct_size;
    const plr_const_view* const numbers = &((const plr_value*)(const void*)at)->numbers;
    return numbers->data != NULL && numbers->rows * numbers->cols == size ? numbers : NULL;
}

static plr_status create(const plr_config* config, plr_instance* out, plr_error* error) {
    if (config->struct_size < PLR_CONFIG_LEAST_SIZE || error->struct_size < PLR_ERROR_LEAST_SIZE) return PLR_E_ARGUMENT;
    const plr_const_view* const noise = vector(config, parameter_noise, 2);
    const plr_const_view* const position = vector(config, parameter_position, 3);
    if (noise == NULL) return refuse(error, "noise", "expected 2 numbers");
    if (position == NULL) return refuse(error, "position", "expected 3 numbers");
    bearing made;
    for (int64_t i = 0; i < 2; ++i) {
        const double deviation = noise->data[i * noise->row_stride];
        if (!(deviation >= least_noise && deviation <= most_noise))
            return refuse(error, "noise", "is not from 1e-9 rad to 1 rad");
        made.variance[i] = deviation * deviation;
    }
    for (int64_t i = 0; i < 3; ++i) {
        made.position[i] = position->data[i * position->row_stride];
        if (!isfinite(made.position[i])) return refuse(error, "position", "is not finite");
    }
    bearing* const self = malloc(sizeof *self);
    if (self == NULL) {
        refuse(error, "", "out of memory");
        return error->code = PLR_E_MEMORY;
    }
    *self = made;
    out->self = self;
    out->table = &table.head;
    return PLR_OK;
}

static const plr_plugin plugin = {sizeof(plr_plugin), 0, &description, PLR_SENSOR, create};

static const plr_plugin* factory(const char* id) { return id != NULL && strcmp(id, ID) == 0 ? &plugin : NULL; }

PLR_EXPORT const plr_entry_point plr_entry = {sizeof plr_entry, PLR_ABI_MAJOR, PLR_ABI_MINOR, NULL, NULL, factory};
