// What a trajectory promises: true motion whose derivatives are what they are called, drawn by key and nothing else.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "call_matrices.hpp"
#include "differences.hpp"
#include "machine/bench.hpp"
#include "machine/guarded_memory.hpp"
#include "space_laws.hpp"
#include "trajectory_calls.hpp"

namespace pelorus::conformance {

namespace {

using namespace trajectory_calls;
using Times = std::vector<std::int64_t>;
constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();

/// What `states` answered for one realisation.
struct Flight {
    Flight(const Instance& instance, const Argument& record, const Times& times_, bool with_extents)
        : times(times_), call(trajectory_calls::states(instance, record, times_, with_extents)) {
        done = execute_well(instance, call);
        const auto whole = [&](std::size_t output) {
            std::vector<std::int64_t> values(done.out[output].size());
            std::memcpy(values.data(), done.out[output].data(), values.size() * sizeof(std::int64_t));
            return values;
        };
        ids = whole(ids_out);
        parents = whole(parents_out);
        births = whole(births_out);
        deaths = whole(deaths_out);
    }
    /// c x T of an object.
    Eigen::MatrixXd states_of(std::int64_t object) const { return item_matrix(call, done, states_out, object); }
    Eigen::MatrixXd extents_of(std::int64_t object) const { return item_matrix(call, done, extents_out, object); }
    std::int64_t objects() const noexcept { return call.count; }
    bool is_alive(std::int64_t object, std::int64_t time) const {
        const auto at = static_cast<std::size_t>(object);
        return time >= births[at] && time < deaths[at];
    }

    Times times;
    HotCall call;
    Execution done;
    Times ids, parents, births, deaths;
};

struct TrajectoryTrial {
    explicit TrajectoryTrial(const Bench& bench)
        : instance(bench.make()),
          facts(info(*instance)),
          space(*facts.state),
          sample(bench.sample()),
          axes(leading_positions(*facts.state)),
          record(realised(*instance, sample.key())) {}

    Flight flight(const Times& times, bool with_extents = false) const {
        return {*instance, record, times, with_extents};
    }
    bool has_extents() const noexcept { return facts.extent_dimension > 0; }
    /// Times of interest: about each birth and death, all through the first minutes, and some far ahead.
    Times interesting_times() {
        const Flight first = flight({0});
        Times times;
        for (int k = 0; k < 60; ++k) times.push_back(std::llround(sample.uniform(0.0, 600.0) * 1e9));
        times.push_back(7'200'000'000'000);
        for (std::size_t o = 0; o < first.births.size(); ++o)
            for (const std::int64_t edge : {first.births[o], first.deaths[o]})
                for (const std::int64_t beside : {-1'000'000'000, -1, 0, 1, 1'000'000'000})
                    if (edge != never && edge + beside >= 0) times.push_back(edge + beside);
        std::sort(times.begin(), times.end());
        times.erase(std::unique(times.begin(), times.end()), times.end());
        return times;
    }

    std::unique_ptr<Instance> instance;
    const plr_trajectory_info& facts;
    Space space;
    Sample sample;
    int axes;
    Argument record;
};

std::string at_time(std::int64_t time) { return fmt::format("at {:.9f} s", static_cast<double>(time) * 1e-9); }

/// Rows `of` of the states against the integral of rows `rate`, over many short spans of each object's life; the worst fault in
/// words, or "". A function may have corners: where a span disagrees, it is cut into sixteen, and most of these must as well.
class IntegralTest {
public:
    IntegralTest(const TrajectoryTrial& trial, int of, int rate) : trial_(trial), of_(of), rate_(rate) {}

    std::string fault(Sample& sample) {
        const Flight born = trial_.flight({0});
        for (std::int64_t object = 0; object < born.objects(); ++object) {
            const auto at = static_cast<std::size_t>(object);
            const double begin = static_cast<double>(born.births[at]);
            for (const double horizon : {30.0, 600.0}) {
                const double end = std::min(begin + horizon * 1e9, static_cast<double>(born.deaths[at]) - 1.0) - span;
                if (!(end > begin)) continue;
                Times starts;
                for (int k = 0; k < 60; ++k) starts.push_back(static_cast<std::int64_t>(sample.uniform(begin, end)));
                std::sort(starts.begin(), starts.end());
                starts.erase(std::unique(starts.begin(), starts.end()), starts.end());
                for (const std::int64_t start : disagreeing(object, starts, span)) {
                    Times parts;
                    for (int k = 0; k < 16; ++k) parts.push_back(start + k * (span / 16));
                    if (disagreeing(object, parts, span / 16).size() > 8) return told_;
                }
            }
        }
        return {};
    }

private:
    static constexpr std::int64_t span = 48'000'000;  // ns

    /// The starts of spans (ascending) over which the integral is not the difference.
    Times disagreeing(std::int64_t object, const Times& starts, std::int64_t length) {
        Times times;
        for (const std::int64_t start : starts)
            for (int k = 0; k <= 4; ++k) times.push_back(start + k * (length / 4));
        Times sorted = times;
        std::sort(sorted.begin(), sorted.end());
        sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
        const Eigen::MatrixXd x = trial_.flight(sorted).states_of(object);
        Times bad;
        for (std::size_t s = 0; s < starts.size(); ++s) {
            Eigen::Index at[5];
            for (std::size_t k = 0; k < 5; ++k)
                at[k] = std::lower_bound(sorted.begin(), sorted.end(), times[5 * s + k]) - sorted.begin();
            if (disagrees(x, at, starts[s], static_cast<double>(length / 4 * 4) * 1e-9)) bad.push_back(starts[s]);
        }
        return bad;
    }

    bool disagrees(const Eigen::MatrixXd& x, const Eigen::Index (&at)[5], std::int64_t start, double seconds) {
        for (int axis = 0; axis < trial_.axes; ++axis) {
            const auto v = [&](int k) { return x(rate_ + axis, at[k]); };
            const double simpson = seconds / 6 * (v(0) + 4 * v(2) + v(4));
            const double finer = seconds / 12 * (v(0) + 4 * v(1) + 2 * v(2) + 4 * v(3) + v(4));
            const double from = x(of_ + axis, at[0]), to = x(of_ + axis, at[4]);
            double largest = 0, reach = 0;
            for (int other = 0; other < trial_.axes; ++other) {
                for (int k = 0; k < 5; ++k) largest = std::max(largest, std::fabs(x(rate_ + other, at[k])));
                reach = std::max({reach, std::fabs(x(of_ + other, at[0])), std::fabs(x(of_ + other, at[4]))});
            }
            // What the two rules differ by, a few ten-thousandths (for interpolated paths), and rounding.
            const double allowed = 4 * std::fabs(finer - simpson) + 3e-4 * largest * seconds + 1e-14 * reach + 1e-12;
            if (std::fabs(to - from - finer) <= allowed) continue;
            told_ = fmt::format("{} changes by {:.9g} in {:.4g} s, the integral of {} is {:.9g}, {}",
                                trial_.space[of_ + axis].name, to - from, seconds, trial_.space[rate_ + axis].name,
                                finer, at_time(start));
            return true;
        }
        return false;
    }

    const TrajectoryTrial& trial_;
    int of_, rate_;
    std::string told_;
};

}  // namespace

PELORUS_CHECK(trajectory, "trajectory-space-well-formed", 2,
              "States are positions, velocities and perhaps accelerations, each on the same axes, with their units; "
              "a simulation hands them to sensors by name.",
              {}) {
    const TrajectoryTrial trial(bench);
    for (const std::string& fault : faults_of(trial.facts.state, "state", Priors::free)) FAIL_CHECK(fault);
    if (trial.axes == 0) FAIL("state begins with " << trial.space[0].name << ", expected position.x");
    const Space expected = kinematic_space(trial.axes, {0, 0, 0});
    const bool is_whole = trial.space.size() == 2 * trial.axes || trial.space.size() == 3 * trial.axes;
    for (int r = 0; is_whole && r < trial.space.size(); ++r)
        if (trial.space[r].name != expected[r].name)
            FAIL("state: component " << r << " is " << trial.space[r].name << ", expected " << expected[r].name);
    if (!is_whole)
        FAIL("state (" << trial.space.text() << ") is not positions, velocities[, accelerations] on the same axes");
    if (trial.facts.objects < 1) FAIL_CHECK("info.objects is " << trial.facts.objects << ", expected 1 at least");
    if (trial.has_extents() && trial.facts.extent_dimension != trial.axes)
        FAIL_CHECK("info.extent_dimension is " << trial.facts.extent_dimension << ", expected 0 or " << trial.axes);
}

PELORUS_CHECK(trajectory, "trajectory-velocity-is-derivative", 3,
              "Velocity is the derivative of position; sensors measure the one and trackers are scored on the other.",
              {"trajectory-space-well-formed", "trajectory-times-are-independent"}) {
    TrajectoryTrial trial(bench);
    const std::string fault = IntegralTest(trial, 0, trial.axes).fault(trial.sample);
    if (!fault.empty()) FAIL("states: " << fault);
}

PELORUS_CHECK(trajectory, "trajectory-acceleration-is-derivative", 3,
              "Acceleration, where it is told, is the derivative of velocity.",
              {"trajectory-space-well-formed", "trajectory-times-are-independent"}) {
    TrajectoryTrial trial(bench);
    if (trial.space.size() < 3 * trial.axes) skip("tells no accelerations");
    const std::string fault = IntegralTest(trial, trial.axes, 2 * trial.axes).fault(trial.sample);
    if (!fault.empty()) FAIL("states: " << fault);
}

PELORUS_CHECK(
    trajectory, "trajectory-is-drawn-by-its-key", 3,
    "realise writes the whole record, the same for the same key and, where it says that it draws, another for "
    "another; runs are repeated and told apart by keys.",
    {"numbers-finite"}) {
    TrajectoryTrial trial(bench);
    const std::int64_t size = trial.facts.record_size;
    for (std::int64_t r = 0; r < size; ++r)
        if (GuardedMemory::is_pattern(trial.record.values[static_cast<std::size_t>(r)]))
            FAIL("realise: record[" << r << "] was not written");
    const auto differs = [&](const Argument& other) {
        return size > 0 && std::memcmp(trial.record.values.data(), other.values.data(),
                                       trial.record.values.size() * sizeof(double)) != 0;
    };
    if (differs(realised(*trial.instance, trial.sample.key())))
        FAIL("realise: the same key gives another record: it draws from elsewhere than the key");
    bool is_other = false;
    for (std::uint64_t k = 1; k <= 8; ++k) {
        plr_key key = trial.sample.key();
        key.word[k % 2] += k * 0x9E3779B97F4A7C15u;
        is_other = is_other || differs(realised(*trial.instance, key));
    }
    const bool draws = (trial.facts.flags & PLR_FLAG_USES_KEYS) != 0;
    if (draws && !is_other)
        FAIL("realise: nine keys give one record, and info says that it draws (PLR_FLAG_USES_KEYS)");
    if (!draws && is_other)
        FAIL("realise: other keys give other records, and info does not say that it draws (PLR_FLAG_USES_KEYS)");
}

PELORUS_CHECK(
    trajectory, "trajectory-times-are-independent", 3,
    "The states at a time have the same bits, whatever other times are asked for; sources ask for blocks, and "
    "resumed runs for other blocks.",
    {"numbers-finite"}) {
    TrajectoryTrial trial(bench);
    const Times times = trial.interesting_times();
    const Flight all = trial.flight(times);
    for (std::size_t t = 0; t < times.size(); t += 3) {
        const Flight one = trial.flight({times[t]});
        for (std::int64_t o = 0; o < all.objects(); ++o) {
            const Eigen::VectorXd among = all.states_of(o).col(static_cast<Eigen::Index>(t)),
                                  alone = one.states_of(o).col(0);
            for (Eigen::Index r = 0; r < among.size(); ++r) {
                const bool is_same = among(r) == alone(r) || (std::isnan(among(r)) && std::isnan(alone(r)));
                if (!is_same)
                    FAIL(fmt::format("states: {} of object {} {} is {:.17g} among {} times and {:.17g} alone",
                                     trial.space[static_cast<int>(r)].name, o, at_time(times[t]), among(r),
                                     times.size(), alone(r)));
            }
        }
        if (one.ids != all.ids || one.parents != all.parents || one.births != all.births || one.deaths != all.deaths)
            FAIL("states: ids, parents, births or deaths differ between " << times.size() << " times and one");
    }
}

PELORUS_CHECK(trajectory, "trajectory-lives-from-birth-to-death", 3,
              "An object has numbers from its birth on until its death, and NaN before and after; whoever simulates it "
              "decides by NaN whether it is there.",
              {"numbers-finite"}) {
    TrajectoryTrial trial(bench);
    const Flight flight = trial.flight(trial.interesting_times());
    for (std::int64_t o = 0; o < flight.objects(); ++o) {
        const auto at = static_cast<std::size_t>(o);
        if (flight.births[at] >= flight.deaths[at])
            FAIL("states: object " << o << " is born " << at_time(flight.births[at]) << " and dies "
                                   << at_time(flight.deaths[at]));
        const Eigen::MatrixXd x = flight.states_of(o);
        for (std::size_t t = 0; t < flight.times.size(); ++t) {
            const std::int64_t time = flight.times[t];
            if (time == flight.deaths[at]) continue;  // its last moment or the first without it
            for (Eigen::Index r = 0; r < x.rows(); ++r) {
                const double value = x(r, static_cast<Eigen::Index>(t));
                if (flight.is_alive(o, time) && !std::isfinite(value))
                    FAIL("states: " << trial.space[static_cast<int>(r)].name << " of object " << o << " is " << value
                                    << " " << at_time(time) << ", while it exists");
                if (!flight.is_alive(o, time) && (!std::isnan(value) || GuardedMemory::is_pattern(value)))
                    FAIL("states: " << trial.space[static_cast<int>(r)].name << " of object " << o << " is "
                                    << (GuardedMemory::is_pattern(value) ? "not written" : fmt::format("{}", value))
                                    << " " << at_time(time) << ", while it does not exist; expected NaN");
            }
        }
    }
}

PELORUS_CHECK(trajectory, "trajectory-family-is-sound", 3,
              "Objects have the ids 0 to o - 1, and each has no parent or one that exists when it is born, and none "
              "descends from itself; analyzers follow families by them.",
              {"numbers-finite"}) {
    TrajectoryTrial trial(bench);
    const Flight flight = trial.flight({0});
    Times sorted = flight.ids;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t o = 0; o < sorted.size(); ++o)
        if (sorted[o] != static_cast<std::int64_t>(o))
            FAIL("states: the ids are not 0 to " << sorted.size() - 1 << ", each once: object " << o << " has "
                                                 << flight.ids[o]);
    for (std::size_t o = 0; o < flight.parents.size(); ++o) {
        const std::int64_t parent = flight.parents[o];
        if (parent == -1) continue;
        if (parent < 0 || parent >= flight.objects() || parent == static_cast<std::int64_t>(o))
            FAIL("states: the parent of object " << o << " is " << parent << ", expected -1 or another's index below "
                                                 << flight.objects());
        const auto p = static_cast<std::size_t>(parent);
        if (flight.births[p] > flight.births[o] || flight.deaths[p] < flight.births[o])
            FAIL("states: object " << o << " is born " << at_time(flight.births[o]) << " of object " << parent
                                   << ", which lives from " << at_time(flight.births[p]) << " until "
                                   << at_time(flight.deaths[p]));
    }
    // All parents are there. Objects of one birth may be each other's ancestors all the same.
    for (std::size_t o = 0; o < flight.parents.size(); ++o) {
        std::int64_t ancestor = flight.parents[o];
        for (std::size_t steps = 0; ancestor != -1; ++steps) {
            if (steps == flight.parents.size())
                FAIL("states: the parents of object " << o << ", followed upwards, go round in a circle");
            ancestor = flight.parents[static_cast<std::size_t>(ancestor)];
        }
    }
}

PELORUS_CHECK(trajectory, "trajectory-extents-are-ellipsoids", 3,
              "While an object exists its extent is a symmetric matrix with eigenvalues above 0, squares of half axes; "
              "and states are the same where extents are not wanted.",
              {"trajectory-lives-from-birth-to-death"}) {
    TrajectoryTrial trial(bench);
    if (!trial.has_extents()) skip("its objects are points");
    const Flight flight = trial.flight(trial.interesting_times(), true), bare = trial.flight(flight.times);
    const Eigen::Index d = trial.facts.extent_dimension;
    for (std::int64_t o = 0; o < flight.objects(); ++o) {
        const Eigen::MatrixXd x = flight.extents_of(o), states = flight.states_of(o), others = bare.states_of(o);
        for (std::size_t t = 0; t < flight.times.size(); ++t) {
            if (!flight.is_alive(o, flight.times[t])) continue;
            const auto column = static_cast<Eigen::Index>(t);
            INFO("object " << o << " " << at_time(flight.times[t]));
            if (states.col(column) != others.col(column)) FAIL("states: other states where extents are not wanted");
            const Eigen::VectorXd elements = x.col(column);
            const Eigen::Map<const Eigen::MatrixXd> shape(elements.data(), d, d);
            if (!shape.allFinite()) FAIL("states: the extent has elements that are not finite");
            if ((shape - shape.transpose()).cwiseAbs().maxCoeff() > 1e-12 * shape.cwiseAbs().maxCoeff())
                FAIL("states: the extent is not symmetric: " << text_of(elements));
            const double least =
                Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(shape, Eigen::EigenvaluesOnly).eigenvalues()(0);
            if (!(least > 0)) FAIL("states: the extent has the eigenvalue " << least << ", expected above 0");
        }
    }
}

}  // namespace pelorus::conformance
