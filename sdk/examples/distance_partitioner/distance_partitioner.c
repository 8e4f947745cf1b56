/* org.example.partitioner.distance: measurements that a chain of short links joins are one cell. C11, nothing but the headers
 * of the ABI.
 *
 * The points are sorted along the axis on which they spread most; each one is compared with those after it until they are
 * farther away on that axis alone than a link is long. A forest of parents (union-find) keeps what belongs together. Cost: sorting, plus
 * the pairs that are near on that axis. All memory comes from call.scratch.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <pelorus/abi/abi.h>

#define ID "org.example.partitioner.distance"
#define VERSION "1.0.0"

PLR_MANIFEST(ID, "partitioner", PLR_PARTITIONER, VERSION);

typedef struct distance {
    double gap; /* m */
    plr_partitioner_info info;
} distance;

static const plr_parameter parameters[] = {{.struct_size = sizeof(plr_parameter),
                                            .type = PLR_TYPE_DOUBLE,
                                            .flags = PLR_PARAMETER_MIN_EXCLUSIVE,
                                            .name = "gap",
                                            .doc = "longest distance between neighbours within a cell",
                                            .unit = "m",
                                            .default_text = "50 m",
                                            .min = 0,
                                            .max = 1e9}};

static const plr_description description = {
    .struct_size = sizeof(plr_description),
    .id = ID,
    .kind = "partitioner",
    .version = VERSION,
    .title = "Cells by distance",
    .purpose =
        "Two measurements are in one cell if a chain of measurements joins them in which no link is longer than the "
        "gap (single linkage). What the tracker predicts is not looked at.",
    .equation = "connected components of the graph |z_i - z_j| <= gap",
    .source =
        "K. Granstrom, C. Lundquist, U. Orguner, Extended Target Tracking using a Gaussian-Mixture PHD Filter, IEEE "
        "Transactions on Aerospace and Electronic Systems 48(4), 3268-3286, 2012 (distance partitioning)",
    .license = "Apache-2.0",
    .parameters = parameters,
    .parameter_count = 1};

static plr_status fail(plr_error* error, plr_status code, int64_t item, const char* where, const char* message) {
    if (error->code != PLR_OK) return code; /* only the first error is kept */
    error->code = code;
    error->item = item;
    snprintf(error->where, sizeof error->where, "%s", where);
    snprintf(error->message, sizeof error->message, "%s", message);
    return code;
}

/* ------------------------------------------------------------------------------------------------ points and their order */

static double coordinate(const plr_const_view* points, int64_t point, int64_t axis) {
    return points->data[point * points->item_stride + axis * points->row_stride];
}

static int is_near(const plr_const_view* points, int64_t a, int64_t b, double gap) {
    double square = 0;
    for (int64_t axis = 0; axis < points->rows; ++axis) {
        const double difference = coordinate(points, a, axis) - coordinate(points, b, axis);
        square += difference * difference;
    }
    return square <= gap * gap;
}

/* The axis on which the points spread most, or -1 if a coordinate is not finite. */
static int64_t widest_axis(const plr_const_view* points) {
    double widest = -1;
    int64_t axis_of_it = 0;
    for (int64_t axis = 0; axis < points->rows; ++axis) {
        double low = INFINITY, high = -INFINITY;
        for (int64_t i = 0; i < points->count; ++i) {
            const double value = coordinate(points, i, axis);
            if (!isfinite(value)) return -1;
            low = fmin(low, value);
            high = fmax(high, value);
        }
        if (high - low > widest) {
            widest = high - low;
            axis_of_it = axis;
        }
    }
    return axis_of_it;
}

/* Sorts the indices of all points by one coordinate: merges runs of 1, 2, 4, ... (the library's qsort may allocate). */
static void sort(const plr_const_view* points, int64_t axis, int64_t* order, int64_t* other) {
    const int64_t count = points->count;
    int64_t *from = order, *to = other;
    for (int64_t i = 0; i < count; ++i) from[i] = i;
    for (int64_t run = 1; run < count; run *= 2) {
        for (int64_t begin = 0; begin < count; begin += 2 * run) {
            const int64_t middle = begin + run < count ? begin + run : count;
            const int64_t end = begin + 2 * run < count ? begin + 2 * run : count;
            int64_t left = begin, right = middle;
            for (int64_t k = begin; k < end; ++k) {
                const int take_left = left < middle && (right == end || coordinate(points, from[left], axis) <=
                                                                            coordinate(points, from[right], axis));
                to[k] = from[take_left ? left++ : right++];
            }
        }
        int64_t* const sorted = to;
        to = from;
        from = sorted;
    }
    if (from != order) memcpy(order, from, (size_t)count * sizeof *order);
}

/* ----------------------------------------------------------------------------------------------- what belongs together */

/* The first point of the cell that a point is in. Shortens the way for the next time. */
static int64_t first_of(int64_t* parent, int64_t point) {
    while (parent[point] != point) point = parent[point] = parent[parent[point]];
    return point;
}

/* A point's parent has a lower index than the point, so the root of a cell is its first member. */
static void join(int64_t* parent, int64_t a, int64_t b) {
    a = first_of(parent, a);
    b = first_of(parent, b);
    if (a < b) parent[b] = a;
    if (b < a) parent[a] = b;
}

static void join_neighbours(const plr_const_view* points, double gap, int64_t axis, const int64_t* order,
                            int64_t* parent) {
    for (int64_t i = 0; i < points->count; ++i) parent[i] = i;
    for (int64_t i = 0; i < points->count; ++i) {
        const double here = coordinate(points, order[i], axis);
        for (int64_t j = i + 1; j < points->count && coordinate(points, order[j], axis) - here <= gap; ++j)
            if (is_near(points, order[i], order[j], gap)) join(parent, order[i], order[j]);
    }
}

/* Cells in the order of their first members, members ascending. */
static plr_status write_cells(int64_t count, int64_t* parent, int64_t* cell_of, plr_partition* out) {
    int64_t cells = 0;
    for (int64_t i = 0; i < count; ++i) {
        const int64_t first = first_of(parent, i);
        cell_of[i] = first == i ? cells++ : cell_of[first];
    }
    out->alternatives = count > 0;
    out->cells = cells;
    out->members = count;
    if (out->alternatives > out->alternative_capacity || cells > out->cell_capacity || count > out->member_capacity)
        return PLR_E_CAPACITY;

    int64_t* const offsets =
        out->cell_offsets; /* sizes first, each one place to the right; then where a cell ends so far */
    memset(offsets, 0, (size_t)(cells + 1) * sizeof *offsets);
    out->alternative_offsets[0] = 0;
    if (count == 0) return PLR_OK;
    out->alternative_offsets[1] = cells;
    out->alternative_weights[0] = 1;
    for (int64_t i = 0; i < count; ++i) ++offsets[cell_of[i] + 1];
    for (int64_t cell = 0; cell < cells; ++cell) {
        const double weight = 1 / (double)offsets[cell + 1];
        out->cell_predictions[cell] = -1; /* serves no prediction */
        offsets[cell + 1] += offsets[cell];
        for (int64_t k = offsets[cell]; k < offsets[cell + 1]; ++k) out->member_weights[k] = weight;
    }
    int64_t* const next = parent; /* done with: now the place of each cell's next member */
    memcpy(next, offsets, (size_t)cells * sizeof *next);
    for (int64_t i = 0; i < count; ++i) out->member_points[next[cell_of[i]]++] = i;
    return PLR_OK;
}

/* ------------------------------------------------------------------------------------------------------------- the table */

static const plr_partitioner_info* info(const void* self) { return &((const distance*)self)->info; }

/* A split is one item: what is wrong with one of its points is wrong with it. */
static plr_status not_finite(const plr_call* call) {
    fail(call->error, PLR_E_NUMERIC, call->item_offset, "", "points: a coordinate is not finite");
    if (call->item_status == NULL) return PLR_E_NUMERIC;
    call->item_status[0] = PLR_E_NUMERIC;
    return PLR_ITEMS_FAILED;
}

static plr_status split(const void* instance, const plr_call* call, const plr_partitioner_split* args) {
    const distance* self = instance;
    const plr_const_view* points = &args->points;
    plr_scratch* const scratch = call->scratch;
    const uint64_t row = (uint64_t)points->count * sizeof(int64_t);
    if (points->rows < 1 || points->rows > 3 || points->cols != 1)
        return fail(call->error, PLR_E_ARGUMENT, -1, "", "points: expected 1 to 3 rows and 1 column");
    const int64_t axis = widest_axis(points);
    if (axis < 0) return not_finite(call);
    const uint64_t begin = (scratch->used + 15) / 16 * 16;
    if (scratch->size < begin || scratch->size - begin < 3 * row)
        return fail(call->error, PLR_E_SCRATCH, -1, "", "less scratch memory than the info asks for");

    /* Nothing is called in between that takes scratch memory as well: `used` may stay as it is. */
    int64_t* const order = (int64_t*)(void*)(scratch->data + begin);
    int64_t* const parent = order + points->count;
    int64_t* const other = parent + points->count;
    sort(points, axis, order, other);
    join_neighbours(points, self->gap, axis, order, parent);
    return write_cells(points->count, parent, other, args->out);
}

static void destroy(void* self) { free(self); }

static const plr_partitioner table = {{sizeof(plr_partitioner), 0, destroy, NULL}, info, split};

static plr_status create(const plr_config* config, plr_instance* out, plr_error* error) {
    if (config->struct_size < PLR_CONFIG_LEAST_SIZE || error->struct_size < PLR_ERROR_LEAST_SIZE) return PLR_E_ARGUMENT;
    const double gap = config->value_count > 0 ? config->values[0].number : 0;
    if (!(gap > 0 && gap <= 1e9)) return fail(error, PLR_E_PARAMETER, -1, "gap", "is not above 0 m and at most 1e9 m");
    distance* self = calloc(1, sizeof *self);
    if (self == NULL) return fail(error, PLR_E_MEMORY, -1, "", "out of memory");
    self->gap = gap;
    self->info.struct_size = sizeof self->info;
    self->info.flags = PLR_FLAG_ANY_STRIDE;
    self->info.dimension_min = 1;
    self->info.dimension_max = 3;
    self->info.scratch_bytes = 16; /* for alignment */
    self->info.scratch_bytes_point = 3 * sizeof(int64_t);
    out->self = self;
    out->table = &table.head;
    return PLR_OK;
}

static const plr_plugin plugin = {sizeof(plr_plugin), 0, &description, PLR_PARTITIONER, create};

static const plr_plugin* factory(const char* id) { return id != NULL && strcmp(id, ID) == 0 ? &plugin : NULL; }

PLR_EXPORT const plr_entry_point plr_entry = {sizeof plr_entry, PLR_ABI_MAJOR, PLR_ABI_MINOR, NULL, NULL, factory};
