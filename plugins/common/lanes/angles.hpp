/// Angles over lanes. Shapes and threads as in pack.hpp.
#pragma once

#include "pack.hpp"

namespace lanes {

inline namespace PELORUS_LANES {

/// The angle of the vector (x, y) of finite numbers, none of which is subnormal, in [-pi, pi], to less than 1.5 ulp; where both are 0,
/// 0 or +-pi by their signs.
/// Source: FDLIBM 5.3, s_atan.c and e_atan2.c (Sun Microsystems, 1993): |y / x| is taken to one of five intervals, atan a + atan t =
/// atan of it with t = (|y| - a |x|) / (|x| + a |y|), a of 0, 1/2, 1, 3/2 and infinity, and atan t = t - t R(t^2), R a minimax
/// polynomial. Here t comes from x and y at once, by a single division.
inline Pack arc_tangent(Pack y, Pack x) noexcept {
    const Pack a = absolute(y), b = absolute(x);
    const Mask below_half = a <= 0.4375 * b, below_one = a < 0.6875 * b, below_more = a < 1.1875 * b,
               below_all = a < 2.4375 * b;
    Pack top = -b, bottom = a, high = all(1.57079632679489655800e+00), low = all(6.12323399573676603587e-17);
    const auto choose = [&](Mask where, Pack t, Pack s, double base, double rest) {
        top = where ? t : top;
        bottom = where ? s : bottom;
        high = where ? all(base) : high;
        low = where ? all(rest) : low;
    };
    choose(below_all, a - 1.5 * b, b + 1.5 * a, 9.82793723247329054082e-01, 1.39033110312309984516e-17);
    choose(below_more, a - b, a + b, 7.85398163397448278999e-01, 3.06161699786838301793e-17);
    choose(below_one, 2.0 * a - b, 2.0 * b + a, 4.63647609000806093515e-01, 2.26987774529616870924e-17);
    choose(below_half, a, b, 0.0, 0.0);
    const Pack t = a == 0.0 ? Pack{} : top / bottom;

    const Pack z = t * t, w = z * z;
    const Pack even = z * (3.33333333333329318027e-01 +
                           w * (1.42857142725034663711e-01 +
                                w * (9.09088713343650656196e-02 +
                                     w * (6.66107313738753120669e-02 +
                                          w * (4.97687799461593236017e-02 + w * 1.62858201153657823623e-02)))));
    const Pack odd =
        w *
        (-1.99999999998764832476e-01 +
         w * (-1.11111104054623557880e-01 +
              w * (-7.69187620504482999495e-02 + w * (-5.83357013379057348645e-02 + w * -3.65315727442169155270e-02))));
    Pack angle = high - ((t * (even + odd) - low) - t);
    // Of a vector that points to the left; the sign of zero counts, as it does for y.
    constexpr double pi = 3.14159265358979311600, pi_rest = 1.2246467991473531772e-16;
    constexpr std::uint64_t sign = std::uint64_t{1} << 63;
    const Mask left = (Mask)((Bits)x & sign) != 0;
    angle = left ? pi - (angle - pi_rest) : angle;
    return (Pack)((Bits)angle | ((Bits)y & sign));
}

/// The same angle in (-pi, pi]: pelorus::wrap_angle over lanes.
inline Pack wrapped(Pack angle) noexcept {
    constexpr double pi = 3.14159265358979323846;
    const Mask outside = ~((angle > -pi) & (angle <= pi));
    if (!any(outside)) return angle;
    for (int lane = 0; lane < width; ++lane) {
        if (outside[lane] == 0) continue;
        const double nearest = __builtin_remainder(angle[lane], 2 * pi);
        angle[lane] = nearest <= -pi ? pi : nearest;
    }
    return angle;
}

}  // namespace PELORUS_LANES

}  // namespace lanes
