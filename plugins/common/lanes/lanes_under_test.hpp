/// The algebra over lanes for packed items, as each instruction set has it: what its tests call.
#pragma once

#include <cstdint>

namespace lanes_under_test {

/// Arrays hold `items` packed column-major items, one after another; items are at most `width`.
struct Algebra {
    int width;
    /// Loads and stores items of `size` numbers; those with to_skip != 0 are not stored.
    void (*copy)(int size, int items, const double* from, const bool* to_skip, double* to);
    void (*cholesky)(int n, int items, const double* a, double* l, bool* failed);
    void (*triangularise)(int rows, int columns, int items, const double* w, double* out);
    /// b = (L L')^-1 b, n x columns.
    void (*solve)(int n, int columns, int items, const double* l, double* b);
    void (*log_normal)(int n, int items, const double* l, const double* e, double* out);
    void (*gram)(int n, int columns, int items, const double* a, double* out);
    /// l = the factor of l l' + c c', c n x k.
    void (*append)(int n, int k, int items, double* l, const double* c);
    /// l = the factor of l l' - u u'.
    void (*downdate)(int n, int items, double* l, const double* u, bool* failed);
    /// The array form of an update of n states by m measurements that see the first `seen`; s and z are replaced.
    void (*update)(int n, int m, int seen, int items, double* s, double* z, const double* g, double* k);
    /// The same by reflections: w = [G N], m x (seen + m), is replaced; out gets its columns [K S+], n x (seen + m).
    void (*reflect)(int n, int m, int seen, int items, const double* s, double* w, double* out);
    /// The angles of vectors, and angles wrapped.
    void (*arc_tangent)(int items, const double* y, const double* x, double* out);
    void (*wrap)(int items, const double* x, double* out);
    void (*logarithm)(int items, const double* x, double* out);
};

namespace baseline {
extern const Algebra algebra;
}
#if defined(__x86_64__)
namespace avx2 {
extern const Algebra algebra;
}
namespace avx512 {
extern const Algebra algebra;
}
#endif

}  // namespace lanes_under_test
