// What tracker.point_target says of itself.
#include "point_target_tracker.hpp"

namespace point_target {

namespace {

void describe_association(pelorus::Describe<PointTargetTracker>& plugin) {
    plugin.parameter("association", &Parameters::association)
        .initially("nearest")
        .choices({{"nearest", "each track takes one detection or none: those of the least total cost"},
                  {"joint", "each track takes all in its gate, weighted by joint probabilities (JPDA)"}})
        .doc("how confirmed tracks and detections come together; tentative tracks take the nearest of what is left");
    plugin.parameter("detection_probability", &Parameters::detection_probability)
        .initially("0.9")
        .above(0.0)
        .below(1.0)
        .doc("an object is measured in a scan with this probability; used by association: joint");
    plugin.parameter("clutter_density", &Parameters::clutter_density)
        .above(0.0)
        .doc(
            "false alarms a scan and unit of the measurement space, in SI (1/m2 for positions in a plane); absent: "
            "estimated from each scan; used by association: joint");
    plugin.parameter("most_joint_events", &Parameters::most_joint_events)
        .initially("100000")
        .min(2)
        .max(10000000)
        .doc(
            "joint events of a cluster at most; from a larger cluster the weakest pairs are left out; used by "
            "association: joint");
}

void describe_start(pelorus::Describe<PointTargetTracker>& plugin) {
    plugin.parameter("start", &Parameters::start)
        .initially("one_point")
        .choices({{"one_point", "one detection begins a track; its velocity is the motion's prior"},
                  {"two_point", "two detections within reach do, with the velocity between them"},
                  {"three_point", "all pairs of detections within reach are tried, and a third one decides"}})
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
    plugin.title("Many point targets, global nearest neighbour or joint probabilities")
        .purpose(
            "Follows any number of objects that cause at most one measurement a scan each. Tracks gate the scan, the "
            "gated pairs are assigned at the least total cost, exactly, or weighted by the probabilities of all joint "
            "events; what is left over begins new tracks, which are "
            "confirmed by M of N; tracks without measurements coast and end. Works with any estimator and with sensors "
            "of "
            "which one at least tells a position by a single measurement. Tracks are predicted to the time of each "
            "measurement.")
        .equation(
            "d^2 = e' S^-1 e, S = H P H' + R; gate: d^2 <= chi^2 quantile, and distance <= maximum_speed T + "
            "deviations; "
            "cost = d^2 + ln det S; joint: P(event) ~ product over its pairs of P_D N(e; 0, S) / (clutter_density "
            "(1 - P_D P_G))")
        .source(
            "S. Blackman, R. Popoli, Design and Analysis of Modern Tracking Systems, Artech House 1999, ch. 6; R. "
            "Jonker, A. "
            "Volgenant, Computing 38, 325-340, 1987; T. Fortmann, Y. Bar-Shalom, M. Scheffe, Sonar Tracking of "
            "Multiple Targets Using Joint Probabilistic Data Association, IEEE J. Oceanic Engineering 8(3), 173-184, "
            "1983; Y. Bar-Shalom, T. Fortmann, Tracking and Data Association, Academic Press 1988, chapter 9");
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
    describe_association(plugin);
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
