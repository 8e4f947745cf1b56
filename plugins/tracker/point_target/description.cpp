// What tracker.point_target says of itself.
#include "point_target_tracker.hpp"

namespace point_target {

namespace {

void describe_start(pelorus::Describe<PointTargetTracker>& plugin) {
    plugin.parameter("start", &Parameters::start)
        .initially("one_point")
        .choices({{"one_point", "one detection begins a track; its velocity is the motion's prior"},
                  {"two_point", "two detections within reach do, with the velocity between them"}})
        .doc("what begins a track");
    plugin.parameter("start_confirm", &Parameters::start_confirm)
        .initially("3")
        .min(1)
        .doc("M: a track is confirmed by so many detections, the first included");
    plugin.parameter("start_of", &Parameters::start_of)
        .initially("5")
        .min(1)
        .doc("N: within so many scans, the first included; with misses: by_time within silences");
}

void describe_end(pelorus::Describe<PointTargetTracker>& plugin) {
    plugin.parameter("misses", &Parameters::misses)
        .initially("per_scan")
        .choices(
            {{"per_scan", "every scan should show every object (a radar's revolution): a scan without it is a miss"},
             {"by_time", "objects report by themselves (AIS): only silence counts"}})
        .doc("what it means that an object is not in a scan");
    plugin.parameter("misses_to_delete", &Parameters::misses_to_delete)
        .initially("5")
        .min(1)
        .doc("a confirmed track ends after so many misses in a row; not with misses: by_time");
    plugin.parameter("silence", &Parameters::silence)
        .unit("s")
        .above(0.0)
        .doc("any track ends so long after its last detection; required with misses: by_time");
    plugin.parameter("maximum_deviation", &Parameters::maximum_deviation)
        .unit("m")
        .above(0.0)
        .doc(
            "a track without a detection ends when its position is less certain than this (root of the covariance's "
            "trace)");
}

}  // namespace

void PointTargetTracker::describe(pelorus::Describe<PointTargetTracker>& plugin) {
    plugin.title("Many point targets, global nearest neighbour")
        .purpose(
            "Follows any number of objects that cause at most one measurement a scan each. Tracks gate the scan, the "
            "gated pairs are assigned at the least total cost, exactly; what is left over begins new tracks, which are "
            "confirmed by M of N; tracks without measurements coast and end. Works with any estimator and with sensors "
            "of "
            "which one at least tells a position by a single measurement. Tracks are predicted to the time of each "
            "measurement.")
        .equation(
            "d^2 = e' S^-1 e, S = H P H' + R; gate: d^2 <= chi^2 quantile, and distance <= maximum_speed T + "
            "deviations; "
            "cost = d^2 + ln det S")
        .source(
            "S. Blackman, R. Popoli, Design and Analysis of Modern Tracking Systems, Artech House 1999, ch. 6; R. "
            "Jonker, A. "
            "Volgenant, Computing 38, 325-340, 1987");
    plugin.slot("estimator", "estimator", 1, 1, "the filter of a track; its sensors are those whose scans may come");
    plugin.parameter("gate_probability", &Parameters::gate_probability)
        .initially("0.997")
        .above(0.0)
        .below(1.0)
        .doc("a track's own measurement is within its gate with this probability");
    plugin.parameter("maximum_speed", &Parameters::maximum_speed)
        .unit("m/s")
        .above(0.0)
        .doc(
            "no object is faster: bounds where a track's next measurement can be, and which two points can begin a "
            "track");
    describe_start(plugin);
    describe_end(plugin);
    plugin.parameter("publish", &Parameters::publish_which)
        .initially("updated")
        .choices({{"updated", "those that took a measurement or changed their status"},
                  {"all", "all, predicted to the scan's time where they took none"}})
        .doc("which tracks are told after a scan");
    plugin.parameter("tentative", &Parameters::tentative)
        .initially("hide")
        .choices({{"hide", ""}, {"show", ""}})
        .doc("whether tracks are told before they are confirmed");
    plugin.in_port("scans", PLR_MESSAGE_SCAN, "measurements", PLR_PORT_MANY);
    plugin.in_port("inputs", PLR_MESSAGE_VALUES, "values of the models' inputs", PLR_PORT_OPTIONAL | PLR_PORT_MANY);
    plugin.out_port("tracks", PLR_MESSAGE_TRACKS, "estimates after each scan");
    plugin.out_port("innovations", PLR_MESSAGE_VALUES,
                    "normalised innovations squared of the tracks told, for tests of consistency");
    plugin.out_port("smoothed", PLR_MESSAGE_TRACKS,
                    "confirmed tracks as they were, as far back as the estimator tells; nothing where it does not");
}

}  // namespace point_target
