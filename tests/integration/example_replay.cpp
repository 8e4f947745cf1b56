#include "example_replay.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <stdexcept>

#include <Eigen/LU>

#include "../support/process.hpp"

namespace pelorus::test {

namespace {

using Columns = std::map<std::string, std::vector<double>>;

const std::vector<double>& column(const Columns& table, const std::string& name) {
    const auto found = table.find(name);
    if (found == table.end()) throw std::runtime_error("there is no column " + name);
    return found->second;
}

/// Mean and covariance of a filter.
struct Estimate {
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;

    Estimate(const Columns& tracks, std::size_t row, const std::vector<std::string>& components) {
        const auto n = static_cast<Eigen::Index>(components.size());
        mean.resize(n);
        covariance.resize(n, n);
        for (Eigen::Index i = 0; i < n; ++i) {
            const std::string& name = components[static_cast<std::size_t>(i)];
            mean(i) = column(tracks, name)[row];
            for (Eigen::Index j = i; j < n; ++j) {
                const std::string both = "covariance." + name + "." + components[static_cast<std::size_t>(j)];
                covariance(i, j) = covariance(j, i) = column(tracks, both)[row];
            }
        }
    }
    void predict(const Dynamics& dynamics, double dt) {
        const Eigen::MatrixXd f = dynamics.transition(mean, dt);
        mean = dynamics.flow(mean, dt);
        covariance = f * covariance * f.transpose() + dynamics.noise(dt);
    }
    /// A measurement of the first three components.
    void update(const Eigen::Vector3d& position, double deviation) {
        const Eigen::Matrix3d s = covariance.topLeftCorner(3, 3) + deviation * deviation * Eigen::Matrix3d::Identity();
        const Eigen::MatrixXd gain = covariance.leftCols(3) * s.inverse();
        mean += gain * (position - mean.head(3));
        covariance -= gain * covariance.topRows(3);
        covariance = (covariance + covariance.transpose()).eval() / 2;
    }
};

}  // namespace

std::map<std::string, std::vector<double>> read_csv(const std::filesystem::path& file) {
    std::istringstream text(read_file(file));
    std::string line, cell;
    std::getline(text, line);
    std::vector<std::string> names;
    for (std::istringstream header(line); std::getline(header, cell, ',');) names.push_back(cell);
    Columns columns;
    while (std::getline(text, line)) {
        std::istringstream cells(line);
        for (const std::string& name : names) {
            cell.clear();
            std::getline(cells, cell, ',');
            char* end = nullptr;
            const double value = std::strtod(cell.c_str(), &end);
            const bool number = !cell.empty() && *end == 0;
            columns[name].push_back(number ? value : std::numeric_limits<double>::quiet_NaN());
        }
    }
    return columns;
}

Eigen::VectorXd Dynamics::flow(Eigen::VectorXd x, double dt) const {
    const int steps = 64;
    const double h = dt / steps;
    for (int i = 0; i < steps; ++i) {
        const Eigen::VectorXd a = derivative(x), b = derivative(x + h / 2 * a), c = derivative(x + h / 2 * b),
                              d = derivative(x + h * c);
        x += h / 6 * (a + 2 * b + 2 * c + d);
    }
    return x;
}

Eigen::MatrixXd Dynamics::transition(const Eigen::VectorXd& x, double dt) const {
    Eigen::MatrixXd out(x.size(), x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) {
        const double step = 1e-5 * std::max(1.0, std::fabs(x(i)));
        Eigen::VectorXd up = x, down = x;
        up(i) += step;
        down(i) -= step;
        out.col(i) = (flow(up, dt) - flow(down, dt)) / (up(i) - down(i));
    }
    return out;
}

Eigen::MatrixXd integrated_noise(const Eigen::MatrixXd& drift, const Eigen::MatrixXd& density, double dt) {
    const int pieces = 2000;
    const double h = dt / pieces;
    const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(drift.rows(), drift.cols()), a = h / 2 * drift;
    const Eigen::MatrixXd half = one + a + a * a / 2 + a * a * a / 6 + a * a * a * a / 24;
    Eigen::MatrixXd state = half, sum = Eigen::MatrixXd::Zero(drift.rows(), drift.cols());
    for (int i = 0; i < pieces; ++i) {  // the midpoint of each piece
        sum += h * state * density * state.transpose();
        state = half * half * state;
    }
    return sum;
}

double largest_difference(const std::filesystem::path& folder, const std::vector<std::string>& components,
                          const Dynamics& dynamics, double deviation) {
    const Columns tracks = read_csv(folder / "tracks.csv"), scans = read_csv(folder / "scans_radar.csv");
    const std::vector<double>&time = column(scans, "time"), &id = column(scans, "id"),
          &told_time = column(tracks, "time"), &measurement = column(tracks, "measurements");
    Estimate replayed(tracks, 0, components);
    double now = told_time[0], largest = 0;
    std::size_t told = 1;
    for (std::size_t scan = 0; scan < time.size() && told < told_time.size(); ++scan) {
        if (time[scan] <= now) continue;
        replayed.predict(dynamics, time[scan] - now);
        now = time[scan];
        if (told_time[told] != now) continue;  // the measurement was not taken, and nothing is told
        const bool taken = measurement[told] == measurement[told];  // else only the status changed
        if (taken && measurement[told] != id[scan])
            throw std::runtime_error("the track took a measurement of another scan");
        if (taken)
            replayed.update({column(scans, "position.x")[scan], column(scans, "position.y")[scan],
                             column(scans, "position.z")[scan]},
                            deviation);
        const Estimate published(tracks, told++, components);
        const Eigen::ArrayXd deviations = published.covariance.diagonal().array().sqrt();
        largest = std::max(largest, ((published.mean - replayed.mean).array() / deviations).abs().maxCoeff());
        largest = std::max(largest, (replayed.covariance.diagonal().array().sqrt() / deviations - 1).abs().maxCoeff());
    }
    if (told != told_time.size()) throw std::runtime_error("the track was told at times without a scan");
    return largest;
}

}  // namespace pelorus::test
