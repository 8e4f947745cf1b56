/// What the laws of extents are tried with: bodies that fly straight on, and what an extent makes of the points they give.
#pragma once

#include <vector>

#include "extent_calls.hpp"

namespace pelorus::conformance {

struct Shape {
    Eigen::MatrixXd matrix;
    Eigen::VectorXd half_axes;
    Eigen::MatrixXd axes;
};

/// Bodies, seen turned and shifted.
struct Motioned {
    std::vector<Body> bodies;
    Eigen::MatrixXd turn;
    Eigen::VectorXd shift;
};

class ExtentBench : public ExtentCalls {
public:
    using ExtentCalls::ExtentCalls;

    std::vector<Body> bodies(Sample& sample, int count) const;
    /// A start with so many points an object in each start scan.
    HotCall start_call(const std::vector<Body>& bodies, const std::vector<std::int64_t>& points, Sample& sample) const;
    /// Records with points enough to start from.
    Argument start(const std::vector<Body>& bodies, Sample& sample) const;
    Argument predicted(const Argument& record, const std::vector<Body>& bodies, double dt) const;
    /// An update with the innovation that the scan's centroids have from where the bodies are.
    HotCall update_call(const Argument& record, const std::vector<Body>& bodies, const PointsOfScan& scan) const;
    Argument updated(const Argument& record, const std::vector<Body>& bodies, const PointsOfScan& scan) const;
    Shape shape_at(const HotCall& call, const Execution& done, std::int64_t item) const;
    std::vector<Eigen::MatrixXd> shapes_of(const Argument& record) const;
    /// Where the object is taken to be: a joint extent's own word, else the body's.
    Eigen::VectorXd position_of(const Argument& record, const Body& body) const;
    std::vector<double> distances(const Argument& record, const std::vector<Body>& bodies,
                                  const PointsOfScan& scan) const;

    /// Start, prediction, update and gate of bodies that are seen turned and shifted: the points are those of the bodies, moved.
    struct StepAnswer {
        std::vector<Eigen::MatrixXd> shapes;
        std::vector<double> log_likelihood, distances;
    };
    StepAnswer whole_step(const Motioned& seen, Sample sample) const;

private:
    HotCall start_call(const Motioned& seen, const std::vector<std::int64_t>& points, Sample& sample) const;
    Execution well(const HotCall& call) const;
    Argument run(const HotCall& call) const;
};

}  // namespace pelorus::conformance
