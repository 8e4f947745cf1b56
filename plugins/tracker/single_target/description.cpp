#include "single_target_tracker.hpp"

namespace single_target {

void SingleTargetTracker::describe_start(pelorus::Describe<SingleTargetTracker>& plugin) {
    plugin.parameter("start", &SingleTargetTracker::start_)
        .initially("measurement")
        .choices({{"measurement", "from the first measurement that tells a position; the rest from the priors"},
                  {"given", "at the first scan, from start_position, start_velocity and start_acceleration"},
                  {"drawn", "at the first scan that has a truth of its time, from that truth and a random error"}})
        .doc("what the track begins with");
    plugin.parameter("start_position", &SingleTargetTracker::start_position_)
        .unit("m")
        .rows(1, 3)
        .doc("with start: given; one value an axis");
    plugin.parameter("start_velocity", &SingleTargetTracker::start_velocity_)
        .unit("m/s")
        .rows(1, 3)
        .doc("with start: given; absent: the prior's");
    plugin.parameter("start_acceleration", &SingleTargetTracker::start_acceleration_)
        .unit("m/s2")
        .rows(1, 3)
        .doc("with start: given; absent: the prior's");
    plugin.parameter("start_sd", &SingleTargetTracker::start_sd_)
        .unit("m, m/s, m/s2")
        .rows(3, 3)
        .above(0)
        .doc(
            "standard deviation at the start of each axis' position, velocity and acceleration; required with start: "
            "given or drawn");
}

void SingleTargetTracker::describe(pelorus::Describe<SingleTargetTracker>& plugin) {
    plugin.title("One target, no association")
        .purpose(
            "Follows one target that every measurement is of: each is one update of the estimator, in the order of "
            "their times. For recordings and simulations in which nothing has to be decided, and for comparisons of "
            "estimators that no association may blur.")
        .equation("start: drawn: m0 = x + diag(start_sd) u, P0 = diag(start_sd)^2, x the truth, u standard normal")
        .source(
            "Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, Wiley "
            "2001, 5.4 (consistency: starts drawn about the truth), 5.5 (start from a measurement)");
    plugin.slot("estimator", "estimator", 1, 1, "the filter; its sensors are those whose scans may come");
    describe_start(plugin);
    plugin.parameter("anew", &SingleTargetTracker::anew_)
        .initially("false")
        .doc(
            "every measurement that tells a position by itself begins the track anew: what measurements tell without a "
            "filter, to compare filters with");
    plugin.parameter("maximum_misses", &SingleTargetTracker::maximum_misses_)
        .min(1)
        .doc("scans in a row without a measurement after which the track ends; absent: never");
    plugin.parameter("records", &SingleTargetTracker::records_)
        .initially("false")
        .doc("tell the estimator's record with the track, for a scheduler that predicts it");
    plugin.in_port("scans", PLR_MESSAGE_SCAN, "measurements of the sensors in the estimator's slot", PLR_PORT_MANY);
    plugin.in_port("truth", PLR_MESSAGE_TRUTH, "for start: drawn; nothing but the start looks at it",
                   PLR_PORT_OPTIONAL);
    plugin.in_port("inputs", PLR_MESSAGE_VALUES, "values of the models' inputs", PLR_PORT_OPTIONAL | PLR_PORT_MANY);
    plugin.out_port("tracks", PLR_MESSAGE_TRACKS, "the target, once a scan");
    plugin.out_port("innovations", PLR_MESSAGE_VALUES, "normalised innovations squared, for tests of consistency");
}

void SingleTargetTracker::check_start() const {
    const bool given = start_ == Start::given;
    const struct {
        const char* name;
        const std::optional<std::vector<double>>& value;
    } states[] = {{"start_position", start_position_},
                  {"start_velocity", start_velocity_},
                  {"start_acceleration", start_acceleration_}};
    std::size_t axes = 0;
    for (int c = 0; c < filter_.cartesian().size(); ++c) {
        const int place = one_track::kinematic_place(filter_.cartesian()[c].name);
        if (place >= 0 && place < 3) ++axes;
    }
    if (axes == 0)
        throw pelorus::PartError("estimator",
                                 "its components are " + filter_.cartesian().text() + ", expected a position");
    for (const auto& state : states) {
        if (!state.value) continue;
        if (!given) throw pelorus::ParameterError(state.name, "belongs to start: given");
        if (state.value->size() != axes)
            throw pelorus::ParameterError(state.name, "has " + std::to_string(state.value->size()) +
                                                          " elements, the estimator has " + std::to_string(axes) +
                                                          " axes");
    }
    if (given && !start_position_) throw pelorus::ParameterError("start_position", "is required with start: given");
    if (start_ != Start::measurement && anew_) throw pelorus::ParameterError("anew", "belongs to start: measurement");
    if (start_ == Start::measurement && start_sd_)
        throw pelorus::ParameterError("start_sd", "belongs to start: given or drawn; a measurement has a covariance");
    if (start_ != Start::measurement && !start_sd_)
        throw pelorus::ParameterError("start_sd", "is required with start: given or drawn");
    if (start_ == Start::measurement) {
        bool some = false;
        for (std::size_t i = 0; i < filter_.sensors().size(); ++i) some = some || filter_.inverts(static_cast<int>(i));
        if (!some)
            throw pelorus::PartError("estimator",
                                     "none of its sensors tells a position by a single measurement "
                                     "(PLR_SENSOR_CAN_INVERT); no track can start. Add one that does, or "
                                     "use start: given or drawn");
    }
}

}  // namespace single_target
