#include "lanes_under_test.hpp"

#include "angles.hpp"
#include "factors.hpp"

namespace lanes_under_test {

namespace PELORUS_LANES {

namespace {

using namespace lanes;

constexpr int most = 160;

/// Calls body(size) with a size that the compiler knows, where it is one of those that filters have.
template <class Body> void sized(int size, Body body) noexcept {
    if (size == 3) return body(Fixed<3>{});
    if (size == 6) return body(Fixed<6>{});
    if (size == 9) return body(Fixed<9>{});
    body(size);
}

void load_items(int size, int items, const double* from, Pack* to) noexcept {
    static const double nothing[most] = {};
    const double* item[width];
    for (int lane = 0; lane < width; ++lane) item[lane] = lane < items ? from + lane * size : nothing;
    load(item, size, to);
}

void store_items(const Pack* from, int size, int items, double* to) noexcept {
    double* item[width];
    for (int lane = 0; lane < width; ++lane) item[lane] = lane < items ? to + lane * size : nullptr;
    store(from, size, item);
}

void copy(int size, int items, const double* from, const bool* to_skip, double* to) noexcept {
    Pack packs[most];
    load_items(size, items, from, packs);
    double* item[width];
    for (int lane = 0; lane < width; ++lane) item[lane] = lane < items && !to_skip[lane] ? to + lane * size : nullptr;
    store(packs, size, item);
}

void cholesky(int size, int items, const double* a, double* l, bool* failed) noexcept {
    Pack from[most], to[most] = {};
    load_items(size * size, items, a, from);
    Mask mask{};
    sized(size, [&](auto n) { cholesky_semidefinite(n, from, to, mask); });
    store_items(to, size * size, items, l);
    for (int lane = 0; lane < items; ++lane) failed[lane] = mask[lane] != 0;
}

void triangularise(int rows, int columns, int items, const double* w, double* out) noexcept {
    Pack packs[most];
    load_items(rows * columns, items, w, packs);
    sized(rows, [&](auto n) { triangularise_rows(n, columns, packs); });
    store_items(packs, rows * columns, items, out);
}

void invert_diagonal(int n, const Pack* l, Pack* out) noexcept {
    for (int j = 0; j < n; ++j) out[j] = 1.0 / l[j * n + j];
}

void solve(int size, int columns, int items, const double* l, double* b) noexcept {
    Pack factor[most], inverse[most], x[most];
    load_items(size * size, items, l, factor);
    load_items(size * columns, items, b, x);
    invert_diagonal(size, factor, inverse);
    sized(size, [&](auto n) { cholesky_solve(n, columns, factor, inverse, x); });
    store_items(x, size * columns, items, b);
}

void log_density(int size, int items, const double* l, const double* e, double* out) noexcept {
    Pack factor[most], inverse[most], x[most], scratch[most];
    load_items(size * size, items, l, factor);
    load_items(size, items, e, x);
    invert_diagonal(size, factor, inverse);
    Pack told{};
    sized(size, [&](auto n) { told = log_normal(n, factor, inverse, x, scratch); });
    store_items(&told, 1, items, out);
}

void square(int size, int columns, int items, const double* a, double* out) noexcept {
    Pack from[most], to[most];
    load_items(size * columns, items, a, from);
    sized(size, [&](auto n) { gram(n, columns, from, to); });
    store_items(to, size * size, items, out);
}

void append(int size, int columns, int items, double* l, const double* c) noexcept {
    Pack factor[most], more[most];
    load_items(size * size, items, l, factor);
    load_items(size * columns, items, c, more);
    sized(size, [&](auto n) { append_columns(n, columns, factor, more); });
    store_items(factor, size * size, items, l);
}

void take_away(int size, int items, double* l, const double* u, bool* failed) noexcept {
    Pack factor[most], less[most], scratch[most];
    load_items(size * size, items, l, factor);
    load_items(size, items, u, less);
    Mask mask{};
    sized(size, [&](auto n) { downdate(n, factor, less, scratch, mask); });
    store_items(factor, size * size, items, l);
    for (int lane = 0; lane < items; ++lane) failed[lane] = mask[lane] != 0;
}

void update(int size, int m, int seen, int items, double* s, double* z, const double* g, double* k) noexcept {
    Pack factor[most], noise[most], looks[most], gain[most], scratch[most];
    load_items(size * size, items, s, factor);
    load_items(m * m, items, z, noise);
    load_items(m * seen, items, g, looks);
    sized(size, [&](auto n) { array_update(n, m, seen, factor, noise, looks, gain, scratch); });
    store_items(factor, size * size, items, s);
    store_items(noise, m * m, items, z);
    store_items(gain, size * m, items, k);
}

void reflect(int size, int m, int seen, int items, const double* s, double* w, double* out) noexcept {
    Pack factor[most], array[most], columns[most];
    load_items(size * size, items, s, factor);
    load_items(m * (seen + m), items, w, array);
    sized(size, [&](auto n) {
        Pack more[most];
        reflect_update(n, m, seen, array, factor, more);
        for (int j = 0; j < seen + m; ++j)
            for (int i = 0; i < size; ++i) columns[j * size + i] = column_of_update(n, seen, factor, more, j)[i];
    });
    store_items(array, m * (seen + m), items, w);
    store_items(columns, size * (seen + m), items, out);
}

void angles(int items, const double* y, const double* x, double* out) noexcept {
    Pack up[1], right[1];
    load_items(1, items, y, up);
    load_items(1, items, x, right);
    up[0] = arc_tangent(up[0], right[0]);
    store_items(up, 1, items, out);
}

void wrap(int items, const double* x, double* out) noexcept {
    Pack pack[1];
    load_items(1, items, x, pack);
    pack[0] = wrapped(pack[0]);
    store_items(pack, 1, items, out);
}

void logarithms(int items, const double* x, double* out) noexcept {
    Pack pack{};
    load_items(1, items, x, &pack);
    pack = logarithm(pack);
    store_items(&pack, 1, items, out);
}

}  // namespace

extern const Algebra algebra;
const Algebra algebra{width,   &copy,      &cholesky, &triangularise, &solve,  &log_density, &square,
                      &append, &take_away, &update,   &reflect,       &angles, &wrap,        &logarithms};

}  // namespace PELORUS_LANES

}  // namespace lanes_under_test
