/// Numbers of several items beside each other: the type that batched kernels count with, and its way from and to packed items.
///
/// Purpose  A kernel written once over Pack works on `width` items at a time: as many as a register of the instruction set holds
///          for which its source is compiled (see CMakeLists.txt). Every operation acts on each lane alone and is one that IEEE 754
///          rounds exactly (+ - * / sqrt), nothing is contracted: so an item's result is the same bytes in every lane, for
///          every width and instruction set, whatever lies in the other lanes.
/// Names    Everything is in a namespace of the instruction set, so that no function of one is linked in place of another's. For
///          the same reason sources that include this use no inline function of the standard library or of Eigen.
/// Threads  All functions are pure: [worker, concurrent] [hot], no allocation, no exception.
#pragma once

#include <cstdint>
#include <limits>
#include <utility>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#if !defined(PELORUS_LANES)
#error "compile this through pelorus_add_lanes (cmake/PelorusAddLanes.cmake)"
#endif

namespace lanes {

inline namespace PELORUS_LANES {

#if defined(__AVX512F__)
constexpr int width = 8;
#elif defined(__AVX2__)
constexpr int width = 4;
#else
constexpr int width = 2;
#endif

typedef double Pack __attribute__((vector_size(8 * width)));
using Mask = decltype(Pack{} < Pack{});  // a lane is -1 or 0
typedef std::uint64_t Bits __attribute__((vector_size(8 * width)));

/// A size known to the compiler; loops over it are unrolled. Where a size is known at run time only, an int stands for it.
template <int N> struct Fixed {
    constexpr operator int() const noexcept { return N; }
};
template <int A, int B> constexpr Fixed<A + B> plus(Fixed<A>, Fixed<B>) noexcept { return {}; }
template <int A, int B> constexpr Fixed<A * B> times(Fixed<A>, Fixed<B>) noexcept { return {}; }
constexpr int plus(int a, int b) noexcept { return a + b; }
constexpr int times(int a, int b) noexcept { return a * b; }

inline Pack all(double number) noexcept { return Pack{} + number; }
inline Pack absolute(Pack x) noexcept { return (Pack)((Bits)x & ~(std::uint64_t{1} << 63)); }
inline Pack larger(Pack a, Pack b) noexcept { return a < b ? b : a; }  // a where either is not a number

inline Pack square_root(Pack x) noexcept {
#if defined(__AVX512F__)
    return (Pack)_mm512_maskz_sqrt_pd(0xff, (__m512d)x);  // the plain one warns in GCC 12
#elif defined(__AVX2__)
    return (Pack)_mm256_sqrt_pd((__m256d)x);
#elif defined(__SSE2__)
    return (Pack)_mm_sqrt_pd((__m128d)x);
#else
    Pack out;
    for (int lane = 0; lane < width; ++lane) out[lane] = __builtin_sqrt(x[lane]);
    return out;
#endif
}

/// Ends a kernel: what is not lanes costs two to three times as much while the upper halves of registers hold something, and
/// GCC 12 does not clear them at every return from a function with loops over lanes (seen on AMD EPYC 9005).
inline void leave_lanes() noexcept {
#if defined(__AVX2__)
    _mm256_zeroupper();
#endif
}

/// Where x is neither infinite nor NaN.
inline Mask is_finite(Pack x) noexcept { return absolute(x) <= std::numeric_limits<double>::max(); }

inline bool any(Mask mask) noexcept {
#if defined(__AVX512F__)
    return _mm512_test_epi64_mask((__m512i)mask, (__m512i)mask) != 0;
#elif defined(__AVX2__)
    return _mm256_movemask_pd((__m256d)mask) != 0;
#elif defined(__SSE2__)
    return _mm_movemask_pd((__m128d)mask) != 0;
#else
    std::int64_t sum = 0;
    for (int lane = 0; lane < width; ++lane) sum |= mask[lane];
    return sum != 0;
#endif
}

/// The natural logarithm of positive finite numbers, to less than 1 ulp. Other lanes hold some number.
/// Source: K. C. Ng, FDLIBM 5.3, e_log.c (Sun Microsystems, 1995): ln(2^k (1 + f)) = k ln 2 + ln(1 + f), and with
/// s = f / (2 + f), ln(1 + f) = 2 s + s R(s^2), R a minimax polynomial.
inline Pack logarithm(Pack x) noexcept {
    constexpr double two52 = 4503599627370496.0, two54 = 18014398509481984.0;
    constexpr std::uint64_t fraction = (std::uint64_t{1} << 52) - 1, one = std::uint64_t{1023} << 52;
    const Mask subnormal = x < std::numeric_limits<double>::min();
    const Bits bits = (Bits)(subnormal ? x * two54 : x);
    // An exponent below 2^52 is the fraction of 2^52 + exponent.
    Pack k = (Pack)((bits >> 52) | (std::uint64_t{1075} << 52)) - two52 - 1023.0;
    k = subnormal ? k - 54.0 : k;
    Pack m = (Pack)((bits & fraction) | one);  // in [1, 2)
    const Mask high = m > 1.41421356237309504880;
    m = high ? m * 0.5 : m;
    k = high ? k + 1.0 : k;

    const Pack f = m - 1.0, s = f / (2.0 + f), z = s * s, w = z * z, half_square = 0.5 * f * f;
    const Pack even = w * (3.999999999940941908e-01 + w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
    const Pack odd =
        z * (6.666666666666735130e-01 +
             w * (2.857142874366239149e-01 + w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01)));
    constexpr double ln2_high = 6.93147180369123816490e-01, ln2_low = 1.90821492927058770002e-10;
    return k * ln2_high - ((half_square - (s * (half_square + even + odd) + k * ln2_low)) - f);
}

namespace detail {

/// One round of a transposition of two rows: first the numbers of each pair of lanes change places, so that pairs of rows' elements
/// lie beside each other; from then on pairs are dealt out, the even ones of both rows to a, the odd ones to b.
template <int Step, int... Lane> inline void exchange(Pack& a, Pack& b, std::integer_sequence<int, Lane...>) noexcept {
    constexpr bool apart = Step == 1;
    const Mask low{(apart ? (Lane % 2 == 0 ? Lane : width + Lane - 1) : 2 * Lane - Lane % 2)...};
    const Mask high{(apart ? (Lane % 2 == 0 ? Lane + 1 : width + Lane) : 2 * Lane - Lane % 2 + 2)...};
    const Pack first = __builtin_shuffle(a, b, low);
    b = __builtin_shuffle(a, b, high);
    a = first;
}

/// Element `lane` of row r becomes element r of row `lane`, by log2(width) rounds of exchanges (after J. O. Eklundh, A fast computer
/// method for matrix transposing, IEEE Transactions on Computers C-21, 801-803, 1972). Whole pairs are dealt out in place of
/// halves that change places: processors have that as one operation without a register of lanes' numbers.
template <int Step = 1> inline void transpose(Pack (&rows)[width]) noexcept {
    if constexpr (Step < width) {
        for (int r = 0; r < width; ++r) {
            if ((r & Step) == 0) exchange<Step>(rows[r], rows[r + Step], std::make_integer_sequence<int, width>{});
        }
        transpose<2 * Step>(rows);
    }
}

}  // namespace detail

/// to[e] = element e of each of `width` packed items, the first of which are at from[0], from[1], ...
template <class Count> inline void load(const double* const (&from)[width], Count count, Pack* to) noexcept {
    const int size = count, whole = size - size % width;
    for (int e = 0; e < whole; e += width) {
        Pack square[width];
        for (int lane = 0; lane < width; ++lane) __builtin_memcpy(&square[lane], from[lane] + e, sizeof(Pack));
        detail::transpose(square);
        for (int row = 0; row < width; ++row) to[e + row] = square[row];
    }
    for (int e = whole; e < size; ++e) {
        Pack row{};
        for (int lane = 0; lane < width; ++lane) row[lane] = from[lane][e];
        to[e] = row;
    }
}

/// The way back, into the items whose pointer is not null.
template <class Count> inline void store(const Pack* from, Count count, double* const (&to)[width]) noexcept {
    const int size = count;
    bool complete = true;
    for (int lane = 0; lane < width; ++lane) complete = complete && to[lane] != nullptr;
    const int whole = complete ? size - size % width : 0;
    for (int e = 0; e < whole; e += width) {
        Pack square[width];
        for (int row = 0; row < width; ++row) square[row] = from[e + row];
        detail::transpose(square);
        for (int lane = 0; lane < width; ++lane) __builtin_memcpy(to[lane] + e, &square[lane], sizeof(Pack));
    }
    for (int lane = 0; lane < width; ++lane) {
        if (to[lane] == nullptr) continue;
        for (int e = whole; e < size; ++e) to[lane][e] = from[e][lane];
    }
}

}  // namespace PELORUS_LANES

}  // namespace lanes
