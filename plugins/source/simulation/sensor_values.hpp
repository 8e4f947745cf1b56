/// What the config says of a simulated sensor beyond its model: the parameters of the slot `sensors`.
#pragma once

#include <optional>
#include <vector>

#include <pelorus/describe.hpp>

namespace simulation {

/// What the box of clutter lies about: the origin, or the middle of the objects, as the window of a radar that follows them does.
enum class ClutterAbout { origin, targets };

/// What the config says of a sensor beyond its model.
struct SensorValues {
    std::optional<double> period;  // s
    double detection_probability = 1;
    double clutter = 0;  // mean number of false alarms a scan
    ClutterAbout clutter_about = ClutterAbout::origin;
    std::optional<std::vector<double>> clutter_min, clutter_max;  // m
    double drop = 0;
    bool shared_error = false;
    bool converted = false;
    std::optional<std::vector<double>> site;  // rad, rad, m

    // How a sensor in the field differs from what is known of it.
    std::optional<std::vector<double>> attitude_error;  // rad
    std::optional<std::vector<double>> bias;            // SI units of what it measures
    double clock_offset = 0, jitter = 0;                // s
    std::optional<std::vector<double>> outage;          // s: from, to, from, to, ...
    double delay = 0, delay_spread = 0;                 // s

    // Where it looks; absent: everywhere.
    std::optional<std::vector<double>> field_of_view, pointing;  // rad
    std::optional<double> slew_rate;                             // rad/s
};

/// Where it looks.
template <class Plugin> void describe_view(pelorus::Describe<Plugin>& plugin) {
    plugin.slot_parameter("field_of_view", &SensorValues::field_of_view)
        .unit("rad")
        .rows(1, 2)
        .above(0)
        .doc(
            "full angle of a cone, or full angles across azimuth and elevation of a window, outside of which it "
            "detects "
            "nothing; absent: it sees everything");
    plugin.slot_parameter("pointing", &SensorValues::pointing)
        .unit("rad")
        .rows(1, 2)
        .doc(
            "azimuth and elevation (azimuth alone in the plane), along its own axes, of the middle of the field at the "
            "start; absent: 0");
    plugin.slot_parameter("slew_rate", &SensorValues::slew_rate)
        .unit("rad/s")
        .above(0)
        .doc("how fast commands `pointing` turn the field, along great circles; absent: at once");
}

/// How it stands, and what its clock and its line do.
template <class Plugin> void describe_field_values(pelorus::Describe<Plugin>& plugin) {
    plugin.slot_parameter("attitude_error", &SensorValues::attitude_error)
        .unit("rad")
        .rows(1, 3)
        .doc(
            "how far the mount really stands turned beyond its attitude, about the sensor's own axes: roll, pitch, "
            "yaw, "
            "or yaw alone in the plane; what is `like` the sensor does not know of it");
    plugin.slot_parameter("bias", &SensorValues::bias)
        .rows(1, -1)
        .doc(
            "really added to what is measured, a number a component in SI units; what is `like` the sensor does not "
            "know of it");
    plugin.slot_parameter("clock_offset", &SensorValues::clock_offset)
        .unit("s")
        .initially("0 s")
        .min(-1e6)
        .max(1e6)
        .doc("how far its clock is fast: stamps are that much later than the truth's time");
    plugin.slot_parameter("jitter", &SensorValues::jitter)
        .unit("s")
        .initially("0 s")
        .min(0)
        .doc(
            "deviation of the times at which it really measures about its ticks (normal, less than half a period, not "
            "before 0); stamps tell them");
    plugin.slot_parameter("outage", &SensorValues::outage)
        .unit("s")
        .rows(2, -1)
        .doc("from, to: while it tells nothing, the end excluded; further pairs for further outages");
    plugin.slot_parameter("delay", &SensorValues::delay)
        .unit("s")
        .initially("0 s")
        .min(0)
        .max(1e6)
        .doc("from the measurement to the arrival of its scan");
    plugin.slot_parameter("delay_spread", &SensorValues::delay_spread)
        .unit("s")
        .initially("0 s")
        .min(0)
        .max(1e6)
        .doc(
            "up to this much more delay, uniform at random from scan to scan; above the period scans overtake each "
            "other");
}

template <class Plugin> void describe_sensors(pelorus::Describe<Plugin>& plugin) {
    plugin.slot("sensors", "sensor", 1, -1, "what measures; scans bear the part's name");
    plugin.slot_parameter("period", &SensorValues::period)
        .unit("s")
        .above(0)
        .doc("from scan to scan; absent: the simulation's");
    plugin.slot_parameter("detection_probability", &SensorValues::detection_probability)
        .initially("1")
        .min(0)
        .max(1)
        .doc("of each point");
    plugin.slot_parameter("clutter", &SensorValues::clutter)
        .initially("0")
        .min(0)
        .doc("mean number of false alarms a scan (Poisson), uniform in the box of clutter_min and clutter_max");
    plugin.slot_parameter("clutter_about", &SensorValues::clutter_about)
        .initially("origin")
        .choices(
            {{"origin", "the box has coordinates of the scene"},
             {"targets", "the box is about the middle of the objects, like the window of a radar that follows them"}})
        .doc("what clutter_min and clutter_max are measured from");
    plugin.slot_parameter("clutter_min", &SensorValues::clutter_min)
        .unit("m")
        .rows(1, 3)
        .doc("lowest corner of the box of space in which false alarms arise");
    plugin.slot_parameter("clutter_max", &SensorValues::clutter_max)
        .unit("m")
        .rows(1, 3)
        .doc("highest corner of that box");
    plugin.slot_parameter("drop", &SensorValues::drop)
        .initially("0")
        .min(0)
        .max(1)
        .doc("probability that a whole scan is lost, so that nothing is published for it");
    plugin.slot_parameter("shared_error", &SensorValues::shared_error)
        .initially("false")
        .doc("one error a scan that all its points share, instead of one a point; scans tell the same covariances");
    plugin.slot_parameter("site", &SensorValues::site)
        .unit("rad, rad, m")
        .rows(3, 3)
        .doc(
            "latitude, longitude and height (WGS84) where a sensor with `converted` stands, its axes east, north, "
            "up there; "
            "what it tells is moved back to the scene's axes; absent: at the scene's origin");
    plugin.slot_parameter("converted", &SensorValues::converted)
        .initially("false")
        .doc(
            "scans tell positions: measurements converted without a correction for the bend of angles, covariances "
            "A R A' with A = d position / d measurement there");
    describe_view(plugin);
    describe_field_values(plugin);
}

}  // namespace simulation
