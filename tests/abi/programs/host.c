/* A host that knows the headers it is compiled with and nothing else of Pelorus: compiled with an older set, it is a host of that
 * age; with a newer one, a host of the future.
 *
 *     host FOLDER       loads constant_velocity, position and kalman from FOLDER/KIND and prints what they compute, a line each
 *     host abi LIBRARY  says whether it would take that library
 */
#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <pelorus/abi/abi.h>

enum { most_parameters = 16, most_parts = 2, scratch_size = 1 << 18, items = 2 };

static void die(const char* format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
    exit(1);
}

/* Element `index` of an array that somebody else made. */
#define ELEMENT(type, first, index) \
    ((const type*)(const void*)((const char*)(first) + (size_t)(index) * (first)->struct_size))

static const plr_entry_point* load(const char* path) {
    void* library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    const plr_entry_point* entry = library == NULL ? NULL : dlsym(library, PLR_ENTRY_SYMBOL);
    if (entry == NULL) die("%s", dlerror());
    if (entry->abi_major != PLR_ABI_MAJOR)
        die("refused: it speaks ABI %d, this host %d", (int)entry->abi_major, PLR_ABI_MAJOR);
    return entry;
}

static const plr_plugin* find(const char* folder, const char* kind, const char* name, const char* table_id) {
    char path[4096], id[256];
    snprintf(path, sizeof path, "%s/%s/%s.so", folder, kind, name);
    snprintf(id, sizeof id, "%s.%s", kind, name);
    const plr_plugin* plugin = load(path)->factory(id);
    if (plugin == NULL) die("%s does not know %s", path, id);
    if (strcmp(plugin->table_id, table_id) != 0) die("%s speaks %s, this host %s", id, plugin->table_id, table_id);
    if (strcmp(plugin->description->id, id) != 0) die("%s is called %s", id, plugin->description->id);
    return plugin;
}

static const void* no_service(const plr_host* host, const char* id) {
    (void)host;
    (void)id;
    return NULL;
}

static const plr_host self = {sizeof(plr_host), PLR_ABI_MAJOR, PLR_ABI_MINOR, "a host in C", NULL, no_service};

/* What an instance is made of; it must live as long. */
typedef struct instance {
    plr_value values[most_parameters];
    double numbers[most_parameters];
    plr_part parts[most_parts];
    plr_config config;
    plr_instance made;
    const plr_plugin* plugin;
} instance;

/* "name=value, name=value": numbers, and choices by their index. What is not named is absent. */
static void fill(const plr_parameter* parameter, const char* given, plr_value* value, double* number) {
    char key[64];
    snprintf(key, sizeof key, "%s=", parameter->name);
    const char* found = strstr(given, key);
    value->struct_size = sizeof *value;
    if (found == NULL) return;
    *number = strtod(found + strlen(key), NULL);
    value->present = 1;
    value->number = *number;
    value->integer = (int64_t)*number;
    value->text = parameter->type == PLR_TYPE_CHOICE ? parameter->choices[value->integer] : "";
    const plr_const_view view = {number, 1, 1, 1, 1, 1, 1};
    value->numbers = view;
}

static void create(instance* out, const plr_plugin* plugin, const char* values) {
    const plr_description* description = plugin->description;
    plr_error error = {.struct_size = sizeof error, .item = -1};
    if (description->parameter_count > most_parameters) die("%s has too many parameters", description->id);
    for (uint32_t i = 0; i < description->parameter_count; ++i)
        fill(ELEMENT(plr_parameter, description->parameters, i), values, &out->values[i], &out->numbers[i]);
    out->plugin = plugin;
    out->config.struct_size = sizeof out->config;
    out->config.address = "test";
    out->config.values = out->values;
    out->config.value_count = description->parameter_count;
    out->config.parts = out->parts;
    out->config.frame = "";
    out->config.host = &self;
    if (plugin->create(&out->config, &out->made, &error) != PLR_OK)
        die("%s: create: %s: %s", description->id, error.where, error.message);
}

static void add_part(instance* holder, const char* slot, const char* name, const instance* part) {
    plr_part* place = &holder->parts[holder->config.part_count++];
    place->struct_size = sizeof *place;
    place->slot = slot;
    place->name = name;
    place->address = name;
    place->table_id = part->plugin->table_id;
    place->description = part->plugin->description;
    place->instance = part->made;
}

/* The context of all calls. */
static _Alignas(64) unsigned char memory[scratch_size];
static plr_scratch scratch = {memory, scratch_size, 0};
static plr_error error = {.struct_size = sizeof error, .item = -1};
static plr_status item_status[items];
static const plr_call call = {
    .struct_size = sizeof call, .scratch = &scratch, .error = &error, .item_status = item_status};

static void need(plr_status status, const char* what) {
    if (status != PLR_OK) die("%s answered %d: %s", what, (int)status, error.message);
}

static plr_view view(double* data, int64_t rows, int64_t cols, int64_t count) {
    const plr_view made = {data, rows, cols, count, 1, rows, rows * cols};
    return made;
}
static plr_const_view given(const double* data, int64_t rows, int64_t cols, int64_t count) {
    const plr_const_view made = {data, rows, cols, count, 1, rows, rows * cols};
    return made;
}
/* One for all items. */
static plr_const_view common(const double* data, int64_t rows, int64_t cols) {
    const plr_const_view made = {data, rows, cols, items, 1, rows, 0};
    return made;
}

static void print(const char* what, const double* numbers, int64_t count) {
    printf("%s", what);
    for (int64_t i = 0; i < count; ++i) printf(" %.17g", numbers[i]);
    putchar('\n');
}

static void run_motion(const instance* motion) {
    const plr_motion* table = (const plr_motion*)(const void*)motion->made.table;
    const plr_motion_info* info = table->info(motion->made.self);
    const double dt = 2, state[items * 4] = {1, 2, 3, 4, -1, -2, -3, -4};
    double out[items * 4], f[items * 16], q[items * 16];
    printf("state");
    for (uint32_t i = 0; i < info->state->size; ++i)
        printf(" %s", ELEMENT(plr_component, info->state->components, i)->name);
    putchar('\n');
    const plr_motion_propagate step = {.struct_size = sizeof step,
                                       .dt = common(&dt, 1, 1),
                                       .state = given(state, 4, 1, items),
                                       .out = view(out, 4, 1, items)};
    need(table->propagate(motion->made.self, &call, &step), "propagate");
    print("propagate", out, items * 4);
    const plr_motion_jacobian slope = {.struct_size = sizeof slope,
                                       .dt = common(&dt, 1, 1),
                                       .state = given(state, 4, 1, items),
                                       .out = view(f, 4, 4, items)};
    need(table->jacobian(motion->made.self, &call, &slope), "jacobian");
    print("jacobian", f, 16);
    const plr_motion_noise noise = {.struct_size = sizeof noise, .dt = common(&dt, 1, 1), .out = view(q, 4, 4, items)};
    need(table->noise(motion->made.self, &call, &noise), "noise");
    print("noise", q, 16);
    const plr_motion_structure* structure =
        table->head.extension == NULL ? NULL : table->head.extension(motion->made.self, PLR_MOTION_STRUCTURE);
    printf("structure %d\n", structure == NULL ? 0 : (int)structure->block);
}

/* Two tracks: started at rest, a step of 2 s, one measurement each. */
static void run_estimator(const instance* estimator) {
    const plr_estimator* table = (const plr_estimator*)(const void*)estimator->made.table;
    const plr_estimator_info* info = table->info(estimator->made.self);
    const void* instance_of = estimator->made.self;
    const int32_t components[4] = {0, 1, 2, 3};
    const double dt = 2, start[items * 4] = {0, 0, 1, 0, 10, 0, 0, 1}, measured[items * 2] = {3, 1, 11, 3},
                 variance[4] = {9, 0, 0, 9};
    double p0[16] = {0}, likelihood[items], mean[items * 4], covariance[items * 16];
    double* record = calloc((size_t)info->record_size * items, sizeof *record);
    if (record == NULL) die("no memory");
    const plr_view whole = view(record, info->record_size, 1, items);
    const plr_const_view read = given(record, info->record_size, 1, items);
    for (int i = 0; i < 4; ++i) p0[5 * i] = 4;
    printf("sensor %s\n", info->sensors->name);
    const plr_estimator_init init = {.struct_size = sizeof init,
                                     .known = 4,
                                     .components = components,
                                     .mean = given(start, 4, 1, items),
                                     .covariance = common(p0, 4, 4),
                                     .record = whole};
    need(table->init(instance_of, &call, &init), "init");
    const plr_estimator_predict predict = {
        .struct_size = sizeof predict, .dt = common(&dt, 1, 1), .record = read, .out = whole};
    need(table->predict(instance_of, &call, &predict), "predict");
    const plr_estimator_update update = {.struct_size = sizeof update,
                                         .record = read,
                                         .measurement = given(measured, 2, 1, items),
                                         .noise = common(variance, 2, 2),
                                         .out = whole,
                                         .log_likelihood = view(likelihood, 1, 1, items)};
    need(table->update(instance_of, &call, &update), "update");
    const plr_estimator_moments summary = {.struct_size = sizeof summary,
                                           .record = read,
                                           .mean = view(mean, 4, 1, items),
                                           .covariance = view(covariance, 4, 4, items)};
    need(table->summary(instance_of, &call, &summary), "summary");
    print("mean", mean, items * 4);
    print("covariance", covariance, 16);
    print("log_likelihood", likelihood, items);
    free(record);
}

int main(int count, char** words) {
    static instance motion, sensor, estimator;
    if (count == 3 && strcmp(words[1], "abi") == 0) {
        load(words[2]);
        puts("taken");
        return 0;
    }
    if (count != 2) die("usage: host FOLDER | host abi LIBRARY");
    create(&motion, find(words[1], "motion", "constant_velocity", PLR_MOTION),
           "dimension=2, form=0, noise=0.5, prior_position=1000, prior_velocity=100");
    create(&sensor, find(words[1], "sensor", "position", PLR_SENSOR), "dimension=2, noise=3, position=0");
    add_part(&estimator, "motion", "", &motion);
    add_part(&estimator, "sensors", "radar", &sensor);
    create(&estimator, find(words[1], "estimator", "kalman", PLR_ESTIMATOR), "");
    run_motion(&motion);
    run_estimator(&estimator);
    estimator.made.table->destroy(estimator.made.self);
    sensor.made.table->destroy(sensor.made.self);
    motion.made.table->destroy(motion.made.self);
    puts("destroyed");
    return 0;
}
