/* Random scans in 1 to 3 dimensions: cells as from trying every pair, in the order that partitioner.h asks for; buffers that
 * are too small; points that are not finite.
 */
#include "distance_partitioner.c"

enum { most = 60 };

static int failures = 0;

static void check(const char* what, int good) {
    if (good) return;
    printf("FAILED: %s\n", what);
    ++failures;
}

/* One call with buffers of `capacity` cells and members. */
static plr_status split_points(const plr_instance* instance, plr_const_view points, int64_t capacity,
                               plr_partition* out, plr_error* error) {
    static int64_t alternative_offsets[2], cell_offsets[most + 1], predictions[most], members[most];
    static double alternative_weights[1], member_weights[most];
    static _Alignas(64) unsigned char bytes[16 + most * 3 * sizeof(int64_t)];
    plr_scratch scratch = {bytes, sizeof bytes, 0};
    const plr_call call = {.struct_size = sizeof call, .scratch = &scratch, .error = error};
    const plr_partition blank = {.struct_size = sizeof blank,
                                 .alternative_capacity = 1,
                                 .cell_capacity = capacity,
                                 .member_capacity = capacity,
                                 .alternative_offsets = alternative_offsets,
                                 .alternative_weights = alternative_weights,
                                 .cell_offsets = cell_offsets,
                                 .cell_predictions = predictions,
                                 .member_points = members,
                                 .member_weights = member_weights};
    const plr_partitioner_split args = {.struct_size = sizeof args, .points = points, .out = out};
    *out = blank;
    error->struct_size = sizeof *error;
    error->code = PLR_OK;
    return ((const plr_partitioner*)(const void*)instance->table)->split(instance->self, &call, &args);
}

/* Floods from the lowest free point on; answers the cell of each point. */
static int64_t cells_by_flooding(const plr_const_view* points, double gap, int64_t* cell) {
    int64_t cells = 0;
    for (int64_t i = 0; i < points->count; ++i) cell[i] = -1;
    for (int64_t seed = 0; seed < points->count; ++seed) {
        if (cell[seed] >= 0) continue;
        cell[seed] = cells;
        for (int changed = 1; changed;) {
            changed = 0;
            for (int64_t i = 0; i < points->count; ++i)
                for (int64_t j = 0; j < points->count; ++j)
                    if (cell[i] == cells && cell[j] < 0 && is_near(points, i, j, gap)) cell[j] = cells, changed = 1;
        }
        ++cells;
    }
    return cells;
}

static void check_scan(const plr_instance* instance, plr_const_view points, double gap) {
    int64_t expected[most];
    const int64_t cells = cells_by_flooding(&points, gap, expected);
    plr_partition out;
    plr_error error = {0};
    check("a split succeeds", split_points(instance, points, points.count, &out, &error) == PLR_OK);
    check("as many cells as by flooding", out.cells == cells && out.members == points.count);
    check("one alternative", out.alternatives == (points.count > 0));
    for (int64_t k = 0; k < cells; ++k) {
        double sum = 0;
        for (int64_t m = out.cell_offsets[k]; m < out.cell_offsets[k + 1]; ++m) {
            check("every point in its cell", expected[out.member_points[m]] == k);
            check("members ascend", m == out.cell_offsets[k] || out.member_points[m - 1] < out.member_points[m]);
            sum += out.member_weights[m];
        }
        check("weights sum to 1", fabs(sum - 1) < 1e-12);
        check("no prediction", out.cell_predictions[k] == -1);
    }
    check("all points are told", points.count == 0 || out.cell_offsets[cells] == points.count);
    if (points.count == 0) return;
    check("a small buffer", split_points(instance, points, points.count - 1, &out, &error) == PLR_E_CAPACITY);
    check("what is needed", out.cells == cells && out.members == points.count);
}

int main(void) {
    const plr_value gap = {.struct_size = sizeof gap, .present = 1, .number = 1.0};
    const plr_config config = {.struct_size = sizeof config, .value_count = 1, .values = &gap};
    plr_instance instance;
    plr_error error = {.struct_size = sizeof error};
    check("an id of somebody else", plr_entry.factory("org.example.partitioner.other") == NULL);
    if (plr_entry.factory(ID)->create(&config, &instance, &error) != PLR_OK) return 1;

    double data[3 * most];
    srand(1);
    for (int trial = 0; trial < 3000; ++trial) {
        const int64_t rows = 1 + trial % 3, count = rand() % (most + 1);
        const double width = 2 + rand() % 40;
        for (int64_t i = 0; i < rows * count; ++i)
            data[i] = 0.25 * floor(4 * width * rand() / RAND_MAX); /* many ties */
        const plr_const_view packed = {data, rows, 1, count, 1, rows, rows};
        const plr_const_view by_axis = {data, rows, 1, count, count, 1, 1}; /* structure of arrays */
        check_scan(&instance, trial % 2 ? packed : by_axis, 1.0);
    }

    plr_partition out;
    data[4] = NAN;
    const plr_const_view bad = {data, 3, 1, 3, 1, 3, 3};
    check("what is not finite", split_points(&instance, bad, 3, &out, &error) == PLR_E_NUMERIC && error.item == 0);
    instance.table->destroy(instance.self);
    if (failures == 0) printf("all cells as they must be\n");
    return failures == 0 ? 0 : 1;
}
