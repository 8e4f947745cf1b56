/// How groups begin: three centres, in three scans one after the other, that lie on a line.
/// Source: Han, Zhou, Journal of Ordnance Equipment Engineering 41(12), 2020, section 4.1 (3/3 logic).
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "../../common/extended/points.hpp"

namespace group {

using extended::Points;

/// A cell that no group took, and its plain means.
struct Centre {
    Points points;
    Eigen::VectorXd position;  ///< d, m
    Eigen::MatrixXd noise;     ///< d x d, m^2: mean of the members' R
    std::uint64_t cell = 0;    ///< index among the scan's cells
    bool is_used = false;
    template <class Archive> void state(Archive& archive) { archive(points, position, noise, cell, is_used); }
};

Centre centre_of(Points points, std::size_t cell);

/// The centres of one scan.
struct Centres {
    std::int64_t time = 0;  ///< ns
    std::vector<Centre> centres;
    template <class Archive> void state(Archive& archive) { archive(time, centres); }
};

struct StartGate {
    double maximum_speed = 0;     ///< m/s, between the first and the second centre
    double squared_distance = 0;  ///< of the third from where the first two point to
};

/// Three centres that begin a group, and what they tell at the time of the third.
struct Start {
    Centre first, second, third;
    Eigen::VectorXd velocity;  ///< m/s, mean over both steps
    double half_time = 0;      ///< s from the time that the mean velocity belongs to until the third centre
};

class Starts {
public:
    void setup(const StartGate& gate) { gate_ = gate; }

    /// Takes the centres that are left over in a scan later than the last one, which must be handed in even if there are none. Answers
    /// who begins: greedy by distance, each centre once.
    std::vector<Start> take(Centres&& newest);

    std::int64_t newest_time() const noexcept { return before_.empty() ? INT64_MIN : before_.back().time; }

    template <class Archive> void state(Archive& archive) { archive(before_); }
    /// What a saved state must keep to.
    bool is_of(int dimension, std::size_t sensors) const;

private:
    struct Triple {
        std::size_t first, second, third;
        double squared_distance;
    };
    std::vector<Triple> triples(const Centres& third) const;

    StartGate gate_;
    std::deque<Centres> before_;  ///< of the last two scans, the older one first
};

}  // namespace group
