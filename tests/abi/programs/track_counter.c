/* org.example.analyzer.track_counter: a stage in C11: counts what the confirmed tracks say, and publishes a table of it at the end.
 * It steps through arrays as view.h and space.h ask for, and so reads messages of hosts older and newer than itself. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <pelorus/abi/abi.h>

#define ID "org.example.analyzer.track_counter"

PLR_MANIFEST(ID, "analyzer", PLR_STAGE, "1.0.0");

enum { column_count = 2, most_rows = 4096 };

typedef struct counter {
    const plr_publish* publish;
    double rows[column_count * most_rows]; /* time, entries */
    int64_t row_count;
    double entries, from_origin; /* sum of the first component: of the positions, by their place in the space */
} counter;

static const plr_port in_port = {
    .struct_size = sizeof(plr_port), .name = "tracks", .doc = "what is counted", .message = PLR_MESSAGE_TRACKS};
static const plr_port out_port = {
    .struct_size = sizeof(plr_port), .name = "results", .doc = "the table `counts`", .message = PLR_MESSAGE_TABLE};

static const plr_description description = {.struct_size = sizeof(plr_description),
                                            .id = ID,
                                            .kind = "analyzer",
                                            .version = "1.0.0",
                                            .title = "Counter of tracks",
                                            .purpose = "Counts entries of tracks, by time.",
                                            .equation = "",
                                            .source = "",
                                            .license = "Apache-2.0",
                                            .in_ports = &in_port,
                                            .in_port_count = 1,
                                            .out_ports = &out_port,
                                            .out_port_count = 1};

static plr_status fail(plr_error* error, plr_status code, const char* text) {
    if (error->code != PLR_OK) return code;
    error->code = code;
    error->item = -1;
    snprintf(error->message, sizeof error->message, "%s", text);
    return code;
}

/* Which row of the mean is position.x. */
static int64_t place_of_x(const plr_space* space) {
    const char* at = (const char*)space->components;
    for (uint32_t i = 0; i < space->size; ++i, at += space->components->struct_size)
        if (strcmp(((const plr_component*)(const void*)at)->name, "position.x") == 0) return i;
    return -1;
}

static plr_status receive(void* instance, const plr_call* call, uint32_t port, const plr_message* message) {
    counter* self = instance;
    const plr_tracks* tracks = message->body.tracks;
    const int64_t x = place_of_x(tracks->space);
    (void)port;
    if (x < 0) return fail(call->error, PLR_E_DATA, "tracks without position.x");
    if (self->row_count == most_rows) return fail(call->error, PLR_E_CAPACITY, "too many messages");
    self->rows[column_count * self->row_count] = (double)message->time * 1e-9;
    self->rows[column_count * self->row_count + 1] = (double)tracks->count;
    ++self->row_count;
    self->entries += (double)tracks->count;
    for (int64_t i = 0; i < tracks->count; ++i)
        self->from_origin += tracks->mean.data[i * tracks->mean.item_stride + x * tracks->mean.row_stride];
    return PLR_OK;
}

static plr_status finish(void* instance, const plr_call* call) {
    counter* self = instance;
    const plr_column columns[column_count] = {
        {.struct_size = sizeof(plr_column), .reduce = PLR_REDUCE_KEY, .name = "time", .unit = "s"},
        {.struct_size = sizeof(plr_column), .reduce = PLR_REDUCE_MEAN, .name = "entries", .unit = ""}};
    const plr_scalar scalars[2] = {{.struct_size = sizeof(plr_scalar),
                                    .reduce = PLR_REDUCE_MEAN,
                                    .name = "entries",
                                    .unit = "",
                                    .value = self->entries},
                                   {.struct_size = sizeof(plr_scalar),
                                    .reduce = PLR_REDUCE_MEAN,
                                    .name = "from_origin",
                                    .unit = "m",
                                    .value = self->from_origin}};
    const plr_table table = {.struct_size = sizeof table,
                             .column_count = column_count,
                             .name = "counts",
                             .columns = columns,
                             .rows = {self->rows, column_count, 1, self->row_count, 1, column_count, column_count},
                             .scalars = scalars,
                             .scalar_count = 2};
    const plr_message message = {.struct_size = sizeof message,
                                 .kind = PLR_MESSAGE_TABLE,
                                 .time = call->time,
                                 .arrival = INT64_MIN,
                                 .body = {.table = &table}};
    return self->publish->publish(self->publish->context, 0, &message, call->error);
}

/* Behind the version: what has been counted so far, rows first. */
static plr_status save(const void* instance, const plr_writer* writer, plr_error* error) {
    const counter* self = instance;
    const int64_t head[2] = {1, self->row_count};
    const double sums[2] = {self->entries, self->from_origin};
    plr_status status = writer->write(writer->context, head, sizeof head, error);
    if (status == PLR_OK) status = writer->write(writer->context, sums, sizeof sums, error);
    if (status != PLR_OK) return status;
    return writer->write(writer->context, self->rows, (uint64_t)(column_count * self->row_count) * sizeof(double),
                         error);
}

static plr_status load(void* instance, const void* bytes, uint64_t size, plr_error* error) {
    counter* self = instance;
    int64_t head[2];
    double sums[2];
    if (size < sizeof head + sizeof sums) return fail(error, PLR_E_DATA, "the state is too short");
    memcpy(head, bytes, sizeof head);
    if (head[0] != 1) return fail(error, PLR_E_STATE_VERSION, "state of another version");
    const uint64_t rest = size - sizeof head - sizeof sums;
    if (head[1] < 0 || head[1] > most_rows || rest != (uint64_t)(column_count * head[1]) * sizeof(double))
        return fail(error, PLR_E_DATA, "the state has another size than it says");
    memcpy(sums, (const char*)bytes + sizeof head, sizeof sums);
    memcpy(self->rows, (const char*)bytes + sizeof head + sizeof sums, rest);
    self->row_count = head[1];
    self->entries = sums[0];
    self->from_origin = sums[1];
    return PLR_OK;
}

static void destroy(void* self) { free(self); }

static const plr_stage table = {{sizeof(plr_stage), 0, destroy, NULL}, NULL, NULL, NULL, receive, finish, save, load};

static plr_status create(const plr_config* config, plr_instance* out, plr_error* error) {
    counter* self = calloc(1, sizeof *self);
    if (self == NULL) return fail(error, PLR_E_MEMORY, "out of memory");
    self->publish = config->host->service(config->host, PLR_SERVICE_PUBLISH);
    if (self->publish == NULL) {
        free(self);
        return fail(error, PLR_E_UNSUPPORTED, "the host cannot publish");
    }
    out->self = self;
    out->table = &table.head;
    return PLR_OK;
}

static const plr_plugin plugin = {sizeof(plr_plugin), 0, &description, PLR_STAGE, create};

static const plr_plugin* factory(const char* id) { return strcmp(id, ID) == 0 ? &plugin : NULL; }

PLR_EXPORT const plr_entry_point plr_entry = {sizeof plr_entry, PLR_ABI_MAJOR, PLR_ABI_MINOR, NULL, NULL, factory};
