#include "least_squares_stage.hpp"

#include "polynomial.hpp"

namespace least_squares {

void LeastSquares::describe(pelorus::Describe<LeastSquares>& plugin) {
    plugin.title("A stream at the times of another, by least squares")
        .purpose(
            "Puts the stream of a fast sensor onto the times of a slow one: fits a polynomial in the time stamps to "
            "the "
            "samples since the slow sensor's last time and tells its value at this one, with its covariance. It goes "
            "by "
            "stamps and not by counts, so frames may be missing, late or at another rate.")
        .equation(
            "z = sum w_i z_i, w_i = sum_k p_k(t) p_k(t_i) / sum_j p_k(t_j)^2, p_k orthogonal on the t_i; R = sum w_i^2 "
            "R_i. "
            "Even times, a line: w_i = -2/n + 6 i/(n (n + 1)), R = 2 (2 n - 1)/(n (n + 1)) R_i")
        .source(
            "Xiang et al., Computer Measurement & Control 31(5), 2023 (the line on even times; its 2 n + 1 in the "
            "variance "
            "is a misprint for 2 n - 1); A. Bjoerck, Numerical Methods for Least Squares Problems, SIAM 1996, 2.5 "
            "(orthogonal polynomials)");
    describe_streams(plugin);
    plugin.parameter("order", &LeastSquares::order_)
        .initially("1")
        .min(1)
        .max(2)
        .doc("1: a line; 2: a parabola, for angles that bend within the window, at the price of a larger variance");
    plugin.parameter("min_samples", &LeastSquares::min_samples_)
        .initially("4")
        .min(1)
        .max(1000)
        .doc("where there are fewer, nothing is told: the other sensor stands alone at that time");
    plugin.parameter("window", &LeastSquares::window_)
        .unit("s")
        .above(0)
        .doc("samples that are older than this at the time are left out; absent: all since the last time count");
}

void LeastSquares::prepare() {
    if (window_) window_ns_ = streams::nanoseconds("window", *window_);
}

std::optional<streams::Estimate> LeastSquares::tell(const streams::SampleBuffer::Samples& samples, streams::Clock time,
                                                    const pelorus::Space& space) const {
    std::vector<const streams::Sample*> used;
    for (const streams::Sample& each : samples)
        if (each.time <= time && (!window_ns_ || time - each.time < *window_ns_)) used.push_back(&each);
    if (used.size() < static_cast<std::size_t>(min_samples_)) return std::nullopt;
    const auto n = static_cast<Eigen::Index>(used.size());
    Eigen::VectorXd times(n);
    Eigen::MatrixXd values(space.size(), n);
    std::vector<const Eigen::MatrixXd*> covariances;
    for (Eigen::Index i = 0; i < n; ++i) {
        const streams::Sample& each = *used[static_cast<std::size_t>(i)];
        times(i) = streams::seconds(each.time - time);
        values.col(i) = i == 0 ? each.value : streams::unwrapped(space, values.col(i - 1), each.value);
        covariances.push_back(&each.covariance);
    }
    streams::Estimate estimate = fit(times, values, covariances, order_);
    estimate.id = used.back()->id;  // the id of a sample that nothing else is made of
    return estimate;
}

}  // namespace least_squares
