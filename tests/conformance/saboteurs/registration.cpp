// Hands the scans of one radar on, with what a stage of registration may do wrong.
#include <cmath>

#include <pelorus/pelorus.hpp>

#include "defect.h"

namespace {

struct Saboteur : pelorus::Stage<Saboteur> {
    static constexpr const char* kind = "registration";

    std::string frame;
    std::uint64_t passed = 0;

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("A registration with a defect").purpose("Hands scans on, for the proof that the suites can fail.");
        plugin.in_port("scans", PLR_MESSAGE_SCAN, "of one radar");
        plugin.out_port("scans", PLR_MESSAGE_SCAN, "the same");
    }
    void setup(const pelorus::Setup& setup) { frame = setup.frame(); }
    std::vector<pelorus::Stream> in_streams(std::uint32_t) const {
        pelorus::Stream stream;
        stream.sensor = "radar";
        stream.space = pelorus::position_space(3);
        stream.frame = frame;
        return {stream};
    }
    std::vector<pelorus::Stream> out_streams(std::uint32_t port) const { return in_streams(port); }

    void on_scan(const pelorus::Event& event, const plr_scan& scan) {
        pelorus::ScanBuilder builder("radar", frame, pelorus::position_space(3));
        for (std::int64_t i = 0; i < scan.measurements.count; ++i) {
            if (NEAR_MISS("registration-measurements-came-in") && i > 0) break;  // fewer than came
            std::uint64_t id = scan.ids[i];
            if (DEFECT("registration-measurements-came-in")) id += 1'000'000;
            const Eigen::MatrixXd measurement = pelorus::item(scan.measurements, i);
            Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(3, 3);
            if (scan.covariances.data != nullptr) covariance = pelorus::item(scan.covariances, i);
            if (DEFECT("registration-covariances-positive"))
                covariance(0, 1) += covariance(0, 0);  // and not its mirror image
            if (DEFECT("registration-covariances-positive.direction"))
                covariance(0, 1) = covariance(1, 0) = 2 * std::sqrt(covariance(0, 0) * covariance(1, 1));
            if (NEAR_MISS("registration-covariances-positive"))
                covariance *= 1e-24;  // a sure thing, but a positive one
            builder.add(id, measurement.data(), covariance.data());
        }
        publish(0, builder.message(event.time));
        ++passed;
    }

    template <class Archive> void state(Archive& archive) { archive(passed); }
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.registration.saboteur");
