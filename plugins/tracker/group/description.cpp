// What tracker.group says of itself.
#include "group_tracker.hpp"

namespace group {

namespace {

void describe_association(pelorus::Describe<GroupTracker>& plugin) {
    plugin.parameter("threshold", &Parameters::threshold)
        .unit("m")
        .min(1e-9)
        .max(1e15)
        .doc(
            "distance that joins two points to one group, handed to the partitioner's input `threshold`; absent: the "
            "partitioner's own");
    plugin.parameter("association", &Parameters::association)
        .choices({{"by_partitioner",
                   "the cells that the partitioner makes for a prediction are its group's; a "
                   "measurement may serve several"},
                  {"nearest", "cells and groups are paired one to one by their centres, the smallest distance first"},
                  {"members",
                   "a cell is that group's most of whose members of the last scan are in it, even if its "
                   "centre jumps; what that leaves, as nearest"}})
        .doc(
            "how groups come to their cells; absent: by_partitioner where the partitioner's cells may overlap, "
            "nearest elsewhere");
    plugin.parameter("gate_probability", &Parameters::gate_probability)
        .initially("0.99")
        .above(0)
        .below(1)
        .doc("a group's cell is within its gate with this probability; association: nearest, and the lineage");
    plugin.parameter("centroid_noise", &Parameters::centroid_noise)
        .initially("mean")
        .choices({{"mean", "the weighted mean R of the members, however many: Han and Zhou 2020"},
                  {"effective", "what the extent says: (lambda X + R)/n"}})
        .doc("covariance of a cell's centre about the group's; not with an extent that owns the kinematics");
}

void describe_life(pelorus::Describe<GroupTracker>& plugin) {
    plugin.parameter("maximum_speed", &Parameters::maximum_speed)
        .unit("m/s")
        .above(0)
        .doc("no group is faster: bounds the first step of a start");
    plugin.parameter("start_gate_probability", &Parameters::start_gate_probability)
        .initially("0.99")
        .above(0)
        .below(1)
        .doc("the third centre of a start is where the first two point to with this probability");
    plugin.parameter("start_acceleration", &Parameters::start_acceleration)
        .unit("m/s2")
        .initially("0.1 m/s2")
        .above(0)
        .doc("deviation of each axis' acceleration at the start");
    plugin.parameter("misses_to_delete", &Parameters::misses_to_delete)
        .initially("5")
        .min(1)
        .doc("scans in a row without a cell after which a group ends");
    plugin.parameter("duplicate_distance", &Parameters::duplicate_distance)
        .unit("m")
        .initially("20 m")
        .min(0)
        .doc("of two groups that are nearer to each other after an update, the younger one ends; 0: none does");
}

}  // namespace

void GroupTracker::describe(pelorus::Describe<GroupTracker>& plugin) {
    plugin.title("Groups of objects, each as one target with a shape")
        .purpose(
            "Splits every scan into groups by a partitioner and follows each group by its centre and its shape, "
            "through splits and mergers: who keeps most of what was predicted keeps its identity, what is left over "
            "begins a group of its own after three scans, and parents tell where each group came from and which ones "
            "it has absorbed.")
        .equation(
            "zb = sum w_j z_j, Rb = sum w_j R_j, S = H P H' + Rb; start: x = [z3; v; 0] of three centres with z3 about "
            "2 z2 - z1, v = (z3 - z1)/(2 T) carried on to z3 by the motion, P_pp = R3, P_pv = R3/(2 T), P_vv = (R1 + "
            "R3)/(2 T)^2")
        .source("Han, Zhou, Journal of Ordnance Equipment Engineering 41(12), 2020");
    plugin.slot("estimator", "estimator", 0, 1, "the filter of the centre; none where the extent owns the kinematics");
    plugin.slot("extent", "extent", 1, 1, "the shape");
    plugin.slot("partitioner", "partitioner", 1, 1, "what splits a scan into groups");
    describe_association(plugin);
    describe_life(plugin);
    plugin.in_port("scans", PLR_MESSAGE_SCAN,
                   "measurements of the sensors in the slot of the estimator or joint extent", PLR_PORT_MANY);
    plugin.in_port("inputs", PLR_MESSAGE_VALUES, "values of the models' inputs", PLR_PORT_OPTIONAL | PLR_PORT_MANY);
    plugin.out_port("tracks", PLR_MESSAGE_TRACKS, "all groups, after each scan");
    plugin.out_port("innovations", PLR_MESSAGE_VALUES,
                    "normalised innovations squared of the centres, for tests of consistency");
}

}  // namespace group
