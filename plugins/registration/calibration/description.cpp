#include "calibration_stage.hpp"

namespace calibration {

void CalibrationStage::describe(pelorus::Describe<CalibrationStage>& plugin) {
    plugin.title("On-line calibration of one sensor against another")
        .purpose(
            "Learns from the targets that two sensors share how one of them is turned, offset, biased in range and off "
            "in time against the other, says what of that can be seen and what cannot, and takes it off its "
            "measurements. Where nothing is wrong it soon corrects nothing.")
        .equation(
            "d = z(t + offset) - h(x_ref(t); b) = H b + noise, z(t) a parabola through the frames around the fix "
            "x_ref; b "
            "by a Kalman filter on d; estimate = sum over sets S of biases that are 0 of P(S | d) E(b | d, b_S = 0)")
        .source(
            "X. Lin, Y. Bar-Shalom, T. Kirubarajan, Exact multisensor dynamic bias estimation with local tracks, IEEE "
            "Transactions on Aerospace and Electronic Systems 40(2), 576-590, 2004; S. F. Schmidt, Application of "
            "state-space methods to navigation problems, Advances in Control Systems 3, 293-340, 1966; J. M. Dickey, "
            "The weighted likelihood ratio, The Annals of Mathematical Statistics 42(1), 204-223, 1971");
    plugin.slot("sensors", "sensor", 2, 2, "the reference and the sensor to be calibrated, named like their scans");
    plugin.parameter("reference", &CalibrationStage::reference_name_)
        .doc("the sensor that is right, by its name in the slot; absent: the first one. It must tell positions");
    plugin.parameter("sensor", &CalibrationStage::sensor_name_)
        .doc("the sensor that is calibrated; absent: the other one");
    plugin.parameter("correct", &CalibrationStage::corrected_)
        .initially("scans")
        .choices({{"scans", "everything is taken off the sensor's measurements"},
                  {"tracks", "angles and offset are taken off tracks, range and clock off the measurements"}})
        .doc("where the estimate is applied");
    plugin.parameter("mode", &CalibrationStage::mode_)
        .initially("augmented")
        .choices({{"augmented", "the estimate is taken off, what is not known of it is left"},
                  {"schmidt", "nothing is moved; covariances grow by all that the biases may be"}})
        .doc("whether what is learnt is taken off, or only reckoned with");
    plugin.parameter("covariance", &CalibrationStage::spread_)
        .initially("widened")
        .choices({{"kept", "as it came"}, {"widened", "what is not known of the biases is added"}})
        .doc("of what is corrected (with `mode: schmidt` always widened)");
    plugin.parameter("attitude_sd", &CalibrationStage::attitude_sd_)
        .unit("rad")
        .initially("[0 rad, 0 rad, 0 rad]")
        .min(0.0)
        .max(0.5)
        .doc("prior deviations of the angles by which it is turned about its own x, y, z; 0: right for certain");
    plugin.parameter("position_sd", &CalibrationStage::position_sd_)
        .unit("m")
        .initially("[0 m, 0 m, 0 m]")
        .min(0.0)
        .max(1e6)
        .doc("of the offset of its position along x, y, z of the frame");
    plugin.parameter("range_sd", &CalibrationStage::range_sd_)
        .unit("m")
        .initially("0 m")
        .min(0.0)
        .max(1e6)
        .doc("of what is added to its ranges");
    plugin.parameter("clock_sd", &CalibrationStage::clock_sd_)
        .unit("s")
        .initially("0 s")
        .min(0.0)
        .max(1e3)
        .doc("of what is added to its time stamps");
    plugin.parameter("presence", &CalibrationStage::presence_)
        .initially("0.5")
        .min(0.001)
        .max(1.0)
        .doc("probability, before anything is seen, that a bias is not 0; 1: a Kalman filter's estimate as it is");
    plugin.parameter("observable", &CalibrationStage::observable_)
        .initially("0.5")
        .min(0.0)
        .max(1.0)
        .doc("a bias counts as observable once its deviation is at most this part of the prior one");
    plugin.parameter("window", &CalibrationStage::window_)
        .unit("s")
        .initially("1 s")
        .min(1e-6)
        .max(1e6)
        .doc("frames within half of it before and after a fix are compared with the fix; at least 3");
    plugin.parameter("lateness", &CalibrationStage::lateness_)
        .unit("s")
        .initially("2 s")
        .min(0.0)
        .max(1e6)
        .doc("frames and fixes that come up to so much later than newer ones are learnt from");
    plugin.parameter("gate", &CalibrationStage::gate_)
        .initially("5")
        .min(0.1)
        .max(100.0)
        .doc("distance, in deviations, up to which a measurement and a fix may be of one target");
    plugin.parameter("maximum_speed", &CalibrationStage::maximum_speed_)
        .unit("m/s")
        .initially("100 m/s")
        .min(0.0)
        .max(1e6)
        .doc("of targets, for following one from frame to frame");
    plugin.parameter("every", &CalibrationStage::every_)
        .unit("s")
        .initially("10 s")
        .min(1e-3)
        .max(1e9)
        .doc("between rows of the table `biases`; doubled when it has grown to 256 times");
    plugin.in_port("scans", PLR_MESSAGE_SCAN, "of both sensors; those of others are passed on", PLR_PORT_MANY);
    plugin.in_port("tracks", PLR_MESSAGE_TRACKS, "made of the uncorrected scans, to be corrected", PLR_PORT_OPTIONAL);
    plugin.out_port("scans", PLR_MESSAGE_SCAN, "all, those of the calibrated sensor corrected");
    plugin.out_port("tracks", PLR_MESSAGE_TRACKS, "those that came in, with `correct: tracks` corrected");
    plugin.out_port(
        "values", PLR_MESSAGE_VALUES,
        "`bias`, `attitude_error`, `platform_position` of the sensor, for a model of it, and `clock_offset`");
    plugin.out_port("biases", PLR_MESSAGE_TABLE, "table `biases` over time, table `directions`, and the last values");
}

}  // namespace calibration
