// The sizes for which the kernels are compiled: n in {4, 6, 9} x m in {2, 3}; all others at run-time size (0).
#include "step_kernels.hpp"

#include "factors.hpp"

namespace gaussian {

namespace {

template <int N, int Max> constexpr int bound() noexcept { return N > 0 ? N : Max; }
template <int Rows, int Cols, int MaxRows, int MaxCols>
using Sized = Eigen::Matrix<double, Rows == 0 ? Eigen::Dynamic : Rows, Cols == 0 ? Eigen::Dynamic : Cols,
                            Eigen::ColMajor, bound<Rows, MaxRows>(), bound<Cols, MaxCols>()>;
template <int N> using Square = Sized<N, N, max_state, max_state>;
template <int M> using Noise = Sized<M, M, max_measurement, max_measurement>;

Outcome stored(const double* from, int count, double* out) noexcept {
    if (!all_finite(from, count)) return Outcome::not_finite;
    std::copy_n(from, count, out);
    return Outcome::done;
}

/// out += C C' - u u', lower triangle.
void add_columns(int rows, const double* c, int columns, const double* u, double* out) noexcept {
    for (int j = 0; j < rows; ++j) {
        for (int k = 0; k < columns; ++k) {
            for (int i = j; i < rows; ++i) out[j * rows + i] += c[k * rows + i] * c[k * rows + j];
        }
        for (int i = j; u != nullptr && i < rows; ++i) out[j * rows + i] -= u[i] * u[j];
    }
}

void mirror(int rows, double* a) noexcept {
    for (int j = 0; j < rows; ++j) {
        for (int i = j + 1; i < rows; ++i) a[i * rows + j] = a[j * rows + i];
    }
}

/// S = the triangle of [N G E], less u u'.
template <int N> Outcome predict_root(int size, const Image& image, const MotionNoise& noise, double* out) noexcept {
    constexpr int max_n = bound<N, max_state>();
    const int n = N > 0 ? N : size;
    Square<N> s(n, n);
    if (noise.kind == MotionNoise::Kind::triangle) {
        std::copy_n(noise.data, n * n, s.data());
    } else if (noise.kind == MotionNoise::Kind::covariance) {
        if (!small::cholesky_semidefinite(Eigen::Map<const Square<N>>(noise.data, n, n), s))
            return Outcome::motion_noise_indefinite;
    } else {
        s.setZero();
        for (int first = 0; first < noise.columns; first += max_n) {
            double columns[max_n * max_n];
            const int count = std::min(max_n, noise.columns - first);
            std::copy_n(noise.data + first * n, count * n, columns);
            append_columns<N, max_n>(n, s.data(), columns, count);
        }
    }
    append_columns<N, max_n>(n, s.data(), image.slope, n);
    append_columns<N, max_n>(n, s.data(), image.residual, image.columns);
    if (image.downdate != nullptr && !downdate<max_n>(n, s.data(), image.downdate))
        return Outcome::prediction_indefinite;
    return stored(s.data(), n * n, out);
}

/// P = Q + G G' + E E' - u u'.
template <int N> Outcome predict_plain(int size, const Image& image, const MotionNoise& noise, double* out) noexcept {
    const int n = N > 0 ? N : size;
    double p[max_state * max_state] = {};
    if (noise.kind == MotionNoise::Kind::covariance) {
        for (int c = 0; c < n; ++c) {
            for (int r = c; r < n; ++r) p[c * n + r] = 0.5 * (noise.data[c * n + r] + noise.data[r * n + c]);
        }
    } else {
        add_columns(n, noise.data, noise.kind == MotionNoise::Kind::triangle ? n : noise.columns, nullptr, p);
    }
    add_columns(n, image.slope, n, nullptr, p);
    add_columns(n, image.residual, image.columns, image.downdate, p);
    for (int r = 0; r < n; ++r) {
        if (p[r * n + r] < 0.0) return Outcome::prediction_indefinite;
    }
    mirror(n, p);
    return stored(p, n * n, out);
}

/// x + K e with K given as K Z, and what else an update tells.
template <int N, int M>
Outcome finish(int n, int m, const Noise<M>& z, const double* gain, const Measured& given, const double* spread,
               const Updated& out) noexcept {
    using Innovation = Sized<M, 1, max_measurement, 1>;
    const Eigen::Map<const Innovation> innovation(given.innovation, m, 1);
    Innovation white = innovation;
    small::solve_lower(z, white);
    double mean[bound<N, max_state>()];
    for (int r = 0; r < n; ++r) mean[r] = given.mean[r];
    for (int c = 0; c < m; ++c) {
        for (int r = 0; r < n; ++r) mean[r] += gain[c * n + r] * white.data()[c];
    }
    if (out.log_likelihood != nullptr) *out.log_likelihood = small::log_normal(z, innovation);
    if (out.innovation_covariance != nullptr) small::gram(z, Eigen::Map<Noise<M>>(out.innovation_covariance, m, m));
    const Outcome moved = stored(mean, n, out.mean);
    return moved != Outcome::done ? moved : stored(spread, n * n, out.spread);
}

template <int M> Outcome check_innovation(const Noise<M>& z) noexcept {
    if (!small::all_finite(z)) return Outcome::not_finite;
    for (int i = 0; i < z.rows(); ++i) {
        if (!(z.data()[i * z.rows() + i] > 0.0)) return Outcome::innovation_singular;
    }
    return Outcome::done;
}

template <int N, int M>
Outcome update_root(int states, int measured, const Image& image, const Measured& given, const Updated& out) noexcept {
    constexpr int max_m = bound<M, max_measurement>();
    const int n = N > 0 ? N : states, m = M > 0 ? M : measured;
    Noise<M> noise(m, m);
    if (!small::cholesky_semidefinite(Eigen::Map<const Noise<M>>(given.noise, m, m), noise))
        return Outcome::noise_indefinite;
    append_columns<M, max_m>(m, noise.data(), image.residual, image.columns);
    if (image.downdate != nullptr && !downdate<max_m>(m, noise.data(), image.downdate))
        return Outcome::regression_indefinite;
    double s[bound<N, max_state>() * bound<N, max_state>()], gain[bound<N, max_state>() * max_m];
    std::copy_n(given.factor, n * n, s);
    array_update<N, M>(n, m, s, noise.data(), image.slope, gain);
    const Outcome checked = check_innovation<M>(noise);
    return checked != Outcome::done ? checked : finish<N, M>(n, m, noise, gain, given, s, out);
}

/// The same on covariances: W = R + E E' - u u', S = G G' + W, K = S_x G' S^-1, and Joseph's form (with P = S_x S_x').
template <int N, int M>
Outcome update_plain(int states, int measured, const Image& image, const Measured& given, const Updated& out) noexcept {
    constexpr int joined = N == 0 || M == 0 ? 0 : N + M;
    using Wide = Sized<M, N, max_measurement, max_state>;
    using Tall = Sized<N, M, max_state, max_measurement>;
    const int n = N > 0 ? N : states, m = M > 0 ? M : measured;
    Noise<M> noise(m, m);
    if (!small::cholesky_semidefinite(Eigen::Map<const Noise<M>>(given.noise, m, m), noise))
        return Outcome::noise_indefinite;
    if (image.columns > 0 || image.downdate != nullptr) {
        std::copy_n(given.noise, m * m, noise.data());
        small::symmetrise(noise);
        add_columns(m, image.residual, image.columns, image.downdate, noise.data());
        if (!small::cholesky_semidefinite(noise, noise)) return Outcome::regression_indefinite;
    }
    Sized<M, joined, max_measurement, max_measurement + max_state> array(m, n + m);
    std::copy_n(image.slope, m * n, array.data());
    std::copy_n(noise.data(), m * m, array.data() + m * n);
    small::triangularise_rows(array, m);
    const Noise<M> z = Eigen::Map<const Noise<M>>(array.data(), m, m);
    const Outcome checked = check_innovation<M>(z);
    if (checked != Outcome::done) return checked;

    const Eigen::Map<const Wide> g(image.slope, m, n);
    const Eigen::Map<const Square<N>> s(given.factor, n, n);
    Wide weighted = g;
    small::solve_lower(z, weighted);
    Tall root_gain(n, m), gain(n, m);
    small::multiply_transposed(s, weighted, root_gain);  // K Z
    small::solve_lower_transposed(z, weighted);
    small::multiply_transposed(s, weighted, gain);
    Square<N> covariance(n, n);
    small::joseph_update(s, g, noise, gain, covariance);
    return finish<N, M>(n, m, z, root_gain.data(), given, covariance.data(), out);
}

template <int N> Update update_of(Form form, int m) noexcept {
    if (m == 2) return form == Form::square_root ? &update_root<N, 2> : &update_plain<N, 2>;
    if (m == 3) return form == Form::square_root ? &update_root<N, 3> : &update_plain<N, 3>;
    return form == Form::square_root ? &update_root<0, 0> : &update_plain<0, 0>;
}

}  // namespace

PredictSpread predict_kernel(Form form, int n) noexcept {
    const bool root = form == Form::square_root;
    if (n == 4) return root ? &predict_root<4> : &predict_plain<4>;
    if (n == 6) return root ? &predict_root<6> : &predict_plain<6>;
    if (n == 9) return root ? &predict_root<9> : &predict_plain<9>;
    return root ? &predict_root<0> : &predict_plain<0>;
}

Update update_kernel(Form form, int n, int m) noexcept {
    if (n == 4) return update_of<4>(form, m);
    if (n == 6) return update_of<6>(form, m);
    if (n == 9) return update_of<9>(form, m);
    return form == Form::square_root ? &update_root<0, 0> : &update_plain<0, 0>;
}

void image_covariance(int rows, int n, const Image& image, double* out) noexcept {
    std::fill_n(out, rows * rows, 0.0);
    add_columns(rows, image.slope, n, nullptr, out);
    add_columns(rows, image.residual, image.columns, image.downdate, out);
    mirror(rows, out);
}

}  // namespace gaussian
