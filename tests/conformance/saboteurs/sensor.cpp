// A radar in the plane whose noise falls with the signal-to-noise ratio, with what a nonlinear sensor may do wrong.
#include <cmath>
#include <limits>

#include <pelorus/pelorus.hpp>

#include "defect.h"

namespace {

constexpr double pi = 3.14159265358979323846;

struct Saboteur : pelorus::Sensor<Saboteur, 2, 2> {
    using Base = pelorus::Sensor<Saboteur, 2, 2>;
    using Look = pelorus::Look;
    static constexpr std::uint32_t flags = PLR_SENSOR_CAN_INVERT;
    double range_noise = 0, azimuth_noise = 0;

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("A radar with a defect")
            .purpose("Range and azimuth, for the proof that the conformance suites can fail.")
            .equation("r = |p|, a = atan2(y, x); variances times 10 / snr")
            .source(
                "Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, "
                "2001, section 10.4");
        plugin.parameter("range_noise", &Saboteur::range_noise)
            .unit("m")
            .initially("10 m")
            .above(0)
            .doc("deviation of a range at a signal-to-noise ratio of 10");
        plugin.parameter("azimuth_noise", &Saboteur::azimuth_noise)
            .unit("rad")
            .initially("5 mrad")
            .above(0)
            .doc("deviation of an azimuth at a signal-to-noise ratio of 10");
    }
    pelorus::Space measurement_space() const {
        const char* const name = NEAR_MISS("sensor-spaces-well-formed") ? "ground_range" : "range";
        const char* const unit = DEFECT("sensor-spaces-well-formed") ? "s" : "m";
        return pelorus::Space({{name, unit, 0, 0, false}, {"azimuth", "rad", 0, 0, true}});
    }
    pelorus::Space cartesian_space() const { return pelorus::position_space(2); }
    pelorus::Space inverse_space() const { return pelorus::position_space(2); }
    void complete(const plr_config& config, const plr_description& description) {
        Base::complete(config, description);
        told_ = *Base::table().info(this);
        if (DEFECT("sensor-linear-means-linear")) told_.flags |= PLR_SENSOR_LINEAR;
        const bool is_bad = DEFECT("sensor-table-agrees-with-info");
        if (!is_bad && !NEAR_MISS("sensor-table-agrees-with-info")) return;
        waveform_ = pelorus::Space({{"pulse_length", "s", 1e-6, 0, false}});
        if (!is_bad) told_.flags |= PLR_SENSOR_WAVEFORM;
        told_.waveform = waveform_.c();
    }

    Measurement measure(const Cartesian& x, const Look&) const {
        if (NEAR_MISS("sensor-blind-spots-are-told") && x.isZero(0.0))
            throw pelorus::NumericError("the object is at the sensor's own position");
        double azimuth = pelorus::wrap_angle(std::atan2(x(1), x(0)));
        if (DEFECT("sensor-angles-in-range") && azimuth < 0) azimuth += 2 * pi;
        if (NEAR_MISS("sensor-angles-in-range") && azimuth < -pi + 1e-12) azimuth = pi;
        return {std::hypot(x(0), x(1)), azimuth};
    }
    Jacobian jacobian(const Cartesian& x, const Look&) const {
        const double range = std::hypot(x(0), x(1)), square = range * range;
        Jacobian h;
        h << x(0) / range, x(1) / range, -x(1) / square, x(0) / square;
        if (DEFECT("sensor-jacobian-is-derivative")) h.row(1) = -h.row(1);
        if (DEFECT("sensor-jacobian-is-derivative.nan")) h(1, 0) = std::numeric_limits<double>::quiet_NaN();
        if (NEAR_MISS("sensor-jacobian-is-derivative")) h.row(1) *= 1 + 1e-7;
        return h;
    }
    Noise noise(const Query& query, const Look&) const {
        double growth = query.snr == nullptr ? 1.0 : 10.0 / *query.snr;
        if (DEFECT("sensor-noise-falls-with-snr")) growth = 1 / growth;
        if (NEAR_MISS("sensor-noise-falls-with-snr")) growth = std::max(growth, 0.1);
        double correlation = 0;
        if (DEFECT("sensor-noise-is-definite")) correlation = 1;
        if (NEAR_MISS("sensor-noise-is-definite")) correlation = 1 - 1e-9;
        const double cross = correlation * range_noise * azimuth_noise;
        Noise r;
        r << range_noise * range_noise, cross, cross, azimuth_noise * azimuth_noise;
        return growth * r;
    }
    Measurement residual(const Measurement& measurement, const Measurement& reference) const noexcept {
        Measurement difference = Base::residual(measurement, reference);
        if (DEFECT("sensor-residual-wraps")) {  // one turn is enough, it seems
            difference(1) = measurement(1) - reference(1);
            if (difference(1) > pi) difference(1) -= 2 * pi;
            if (difference(1) < -pi) difference(1) += 2 * pi;
        }
        if (NEAR_MISS("sensor-residual-wraps") && std::abs(difference(1)) < 3) difference(1) *= 1 + 1e-16;
        return difference;
    }
    Inverse invert(const Measurement& z, const Noise& noise, const Look&) const {
        double debias = std::exp(noise(1, 1) / 2);
        if (DEFECT("sensor-inverse-is-unbiased")) debias = 1;
        if (NEAR_MISS("sensor-inverse-is-unbiased")) debias = 1 + noise(1, 1) / 2;
        const double c = std::cos(z(1)), s = std::sin(z(1));
        Inverse out;
        out.mean << debias * z(0) * c, debias * z(0) * s;
        if (DEFECT("sensor-inverse-undoes-measure")) out.mean << debias * z(0) * s, debias * z(0) * c;
        if (NEAR_MISS("sensor-inverse-undoes-measure")) out.mean *= 1 + 1e-10;
        double arm = z(0);
        if (DEFECT("sensor-inverse-covariance-is-carried")) arm = 1;
        Jacobian j;
        j << c, -arm * s, s, arm * c;
        const Noise carried = j * noise * j.transpose();
        out.covariance = (carried + carried.transpose()) / 2;
        // The bend: what a turn by the azimuth's error takes from the range, along the line of sight.
        const double bend = z(0) * noise(1, 1);
        if (!DEFECT("sensor-inverse-is-consistent"))
            out.covariance += bend * bend / 2 * j.col(0) * j.col(0).transpose();
        if (NEAR_MISS("sensor-inverse-is-consistent")) out.covariance += bend * bend * j.col(0) * j.col(0).transpose();
        if (NEAR_MISS("sensor-inverse-covariance-is-carried")) out.covariance *= 1.005;
        return out;
    }

    static const plr_sensor& table() noexcept {
        static const plr_sensor made = [] {
            plr_sensor table = Base::table();
            table.info = [](const void* self) noexcept -> const plr_sensor_info* {
                return &static_cast<const Saboteur*>(self)->told_;
            };
            table.measure = &measure_entry;
            table.jacobian = &jacobian_entry;
            return table;
        }();
        return made;
    }

private:
    static plr_status measure_entry(const void* self, const plr_call* call, const plr_sensor_measure* args) noexcept {
        const plr_status status = Base::table().measure(self, call, args);
        const bool is_bad = DEFECT("sensor-points-equal-singles");
        if (status < 0 || !(is_bad || NEAR_MISS("sensor-points-equal-singles"))) return status;
        for (std::int64_t i = 0; i < args->out.count; ++i)
            for (std::int64_t p = 1; p < args->out.cols; ++p) {
                if (call->item_status != nullptr && call->item_status[i] != PLR_OK) continue;
                double* const item = args->out.data + i * args->out.item_stride;
                double& range = item[p * args->out.col_stride];
                range = is_bad ? item[0] : range * (1 + 1e-15);
            }
        return status;
    }
    static plr_status jacobian_entry(const void* self, const plr_call* call, const plr_sensor_jacobian* args) noexcept {
        plr_status status = Base::table().jacobian(self, call, args);
        if (status != PLR_ITEMS_FAILED || !DEFECT("sensor-blind-spots-are-told")) return status;
        // 0 / 0 goes out as a result.
        status = PLR_OK;
        for (std::int64_t i = 0; i < args->out.count; ++i) {
            const double* const x = args->cartesian.data + i * args->cartesian.item_stride;
            if (call->item_status[i] != PLR_OK && x[0] == 0 && x[args->cartesian.row_stride] == 0) {
                call->item_status[i] = PLR_OK;
                args->out.data[i * args->out.item_stride] = std::numeric_limits<double>::quiet_NaN();
            }
            if (call->item_status[i] != PLR_OK) status = PLR_ITEMS_FAILED;
        }
        return status;
    }

    plr_sensor_info told_{};
    pelorus::Space waveform_;
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.sensor.saboteur");
