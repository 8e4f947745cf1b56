#include "pointing_scheduler.hpp"

namespace pointing_scheduler {

void PointingScheduler::describe(pelorus::Describe<PointingScheduler>& plugin) {
    plugin.title("Pointing at a track")
        .purpose(
            "Points a sensor of narrow field at a track, mostly one that other sensors keep: predicts the track to the "
            "sensor's next look, searches around the prediction where the field does not cover what is likely, and "
            "says "
            "when the sensor has got hold of the target and when it has lost it. With the command fed back to a "
            "simulation, the loop is closed.")
        .equation(
            "x-, P- of the look; z = h(x-), P = H P- H' of the sensor's azimuth and elevation, across: diag(cos "
            "elevation, 1) on both sides; the field goes over { e : e' (k^2 (P + m^2 I) + w^2 I)^-1 e <= 1 }, "
            "likeliest "
            "places first; a look is a hit where a measurement has (z - h)' (H P- H' + R)^-1 (z - h) <= g^2")
        .source(
            "S. Blackman, R. Popoli, Design and Analysis of Modern Tracking Systems, Artech House 1999, chapters 2 and "
            "15 (cued search, sensor management)");
    plugin.slot("estimator", "estimator", 1, 1, "the tracker's estimator again, written like: tracker.estimator");
    plugin.parameter("sensor", &PointingScheduler::sensor_name_)
        .doc("the sensor that is pointed, by its name among those of the estimator; absent: the only one");
    plugin.parameter("field_of_view", &PointingScheduler::field_of_view_)
        .unit("rad")
        .rows(1, 2)
        .above(0)
        .doc("of the sensor: full angle of a cone, or of a window across azimuth and elevation");
    plugin.parameter("period", &PointingScheduler::period_)
        .unit("s")
        .above(0)
        .doc("from a look of the sensor to the next; absent: as long as between the last two");
    plugin.parameter("track", &PointingScheduler::policy_)
        .initially("first")
        .choices({{"first", "that of the lowest id"}, {"worst", "that of the largest variance of position"}})
        .doc("which of several confirmed tracks is taken; it is kept until it is deleted");
    plugin.parameter("sigmas", &PointingScheduler::sigmas_)
        .initially("3")
        .above(0)
        .doc("k: deviations of the prediction that the field has to cover, or the search goes over");
    plugin.parameter("misalignment", &PointingScheduler::misalignment_)
        .unit("rad")
        .initially("0 rad")
        .min(0)
        .doc("m: deviation, on each axis, of how the sensor's mount is known");
    plugin.parameter("gate", &PointingScheduler::gate_)
        .initially("5")
        .above(0)
        .doc("g: deviations from the prediction within which a measurement is taken for the target's");
    plugin.parameter("lock_looks", &Rules::lock_looks)
        .initially("3")
        .min(1)
        .doc("looks in a row that see the target, after which it is locked");
    plugin.parameter("loss_looks", &Rules::loss_looks)
        .initially("5")
        .min(1)
        .doc(
            "looks in a row that do not, after which it is lost; and how long the only place of a search is looked at");
    plugin.parameter("dwell_looks", &Rules::dwell_looks)
        .initially("1")
        .min(1)
        .doc("looks at each of several places of a search");
    plugin.parameter("table_period", &PointingScheduler::table_period_)
        .unit("s")
        .initially("0 s")
        .min(0)
        .doc("least time between two rows of the table `looks`; 0: a row for each look");
    plugin.in_port("tracks", PLR_MESSAGE_TRACKS, "what there is to look at, with the estimator's records");
    plugin.in_port("scans", PLR_MESSAGE_SCAN,
                   "the sensor's looks: whether they see the target; those of others are passed over", PLR_PORT_MANY);
    plugin.in_port("pointing", PLR_MESSAGE_VALUES,
                   "where the sensor really looks (quantity `pointing`); absent: where it was told to",
                   PLR_PORT_OPTIONAL);
    plugin.out_port("commands", PLR_MESSAGE_VALUES, "`pointing`, azimuth and elevation, addressed to the sensor");
    plugin.out_port("results", PLR_MESSAGE_TABLE,
                    "tables `looks` and `locks`, and how much of the time there was a lock");
}

}  // namespace pointing_scheduler
