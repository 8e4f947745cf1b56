/// A second opinion on what a tracker did: the same measurements, read from the CSV files of its run, through a filter that is written
/// down here and shares nothing with the plugins.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace pelorus::test {

/// The columns of a CSV file by their names; cells that are no numbers are NaN.
std::map<std::string, std::vector<double>> read_csv(const std::filesystem::path& file);

/// A motion as a differential equation, x' = derivative(x), and the noise that a step adds.
struct Dynamics {
    std::function<Eigen::VectorXd(const Eigen::VectorXd&)> derivative;
    std::function<Eigen::MatrixXd(double dt)> noise;

    /// By the classical method of Runge and Kutta, 64 steps.
    Eigen::VectorXd flow(Eigen::VectorXd x, double dt) const;
    /// d flow / d x, by differences.
    Eigen::MatrixXd transition(const Eigen::VectorXd& x, double dt) const;
};

/// The integral over a step of e^(A s) G q G' e^(A' s), summed in 2000 pieces with e^(A s) by its series.
Eigen::MatrixXd integrated_noise(const Eigen::MatrixXd& drift, const Eigen::MatrixXd& density, double dt);

/// Takes the first published estimate of the only track in FOLDER/tracks.csv (with `uncertainty: covariance`), filters the
/// positions in FOLDER/scans_radar.csv from there on, each with `deviation` on each axis, and answers the largest differences from
/// what the tracker published: of each component of the mean, in its deviations.
double largest_difference(const std::filesystem::path& folder, const std::vector<std::string>& components,
                          const Dynamics& dynamics, double deviation);

}  // namespace pelorus::test
