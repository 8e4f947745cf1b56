#include "../../../tests/support/reference.hpp"
#include "../../../tests/support/sensor_checks.hpp"

using namespace test_support;

TEST_CASE("monostatic range rate agrees with the reference library", "[sensor]") {
    const auto answers = reference("models_and_filters.json");
    const nlohmann::json& answer = answers.at("h EBRR moved+rotated+velocity");
    const Instance instance("sensor", "doppler",
                            {{"receiver", "[100, -200, 30]"}, {"receiver_velocity", "[10, 20, -5]"}});
    const SensorUnderTest sensor(instance);
    const std::vector<int> order{0, 2, 4, 1, 3, 5};
    const Eigen::VectorXd x = reordered(matrix(answer.at("x")), order, {0});
    CHECK(sensor.measure(x)(0) == Approx(matrix(answer.at("h"))(3)).epsilon(1e-12));
    const Eigen::MatrixXd expected = reordered(matrix(answer.at("H")), {3}, order);
    CHECK((sensor.jacobian(x) - expected).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("a bistatic path grows by both legs and a frequency falls with it", "[sensor]") {
    // Between two stations 10 km apart, 4 km beside the middle: flying away across the line at 100 m/s, cos = 4 / sqrt(41).
    const Values stations{{"receiver", "[-5e3, 0]"}, {"transmitter", "[5e3, 0]"}};
    const Instance path("sensor", "doppler", stations);
    Values with_carrier = stations;
    with_carrier["carrier"] = "1e8";
    with_carrier["frequency_noise"] = "2";
    const Instance shift("sensor", "doppler", with_carrier);
    const Eigen::Vector4d x(0, 4e3, 0, 100);
    const double rate = 2.0 * 100.0 * 4.0 / std::sqrt(41.0);
    CHECK(SensorUnderTest(path).component(0) == "path_rate");
    CHECK(SensorUnderTest(path).measure(x)(0) == Approx(rate));
    CHECK(SensorUnderTest(shift).measure(x)(0) == Approx(-1e8 * rate / 299792458.0));
    CHECK(SensorUnderTest(shift).noise()(0, 0) == 4.0);
    // At one place the bistatic path is twice the range.
    const Instance mono("sensor", "doppler", {{"receiver", "[1, 2]"}, {"carrier", "1e8"}, {"frequency_noise", "2"}}),
        twice("sensor", "doppler",
              {{"receiver", "[1, 2]"}, {"transmitter", "[1, 2]"}, {"carrier", "1e8"}, {"frequency_noise", "2"}});
    CHECK(SensorUnderTest(mono).measure(x)(0) == Approx(SensorUnderTest(twice).measure(x)(0)));
}

TEST_CASE("the Doppler Jacobian is the derivative of the measurement", "[sensor]") {
    const Instance instance("sensor", "doppler",
                            {{"receiver", "[-500, 0, 9]"},
                             {"transmitter", "[500, 30, 0]"},
                             {"receiver_velocity", "[9, 8, 7]"},
                             {"transmitter_velocity", "[-3, 2, 1]"}});
    Eigen::VectorXd x(6);
    x << 300, -400, 200, 40, -30, 70;
    SensorUnderTest(instance).check_jacobian(x, 1e-2);
    x.head(3) << 500, 30, 0;
    CHECK_THROWS_WITH(SensorUnderTest(instance).jacobian(x),
                      "the object is at the sensor's own position, where range rate has no derivative");
}

TEST_CASE("parameters of a Doppler sensor that do not belong together are refused by name", "[sensor]") {
    const auto refused_at = [](const Values& values) -> std::string {
        try {
            const Instance instance("sensor", "doppler", values);
        } catch (const Refused& error) {
            return error.where;
        }
        return "nowhere";
    };
    CHECK(refused_at({{"carrier", "1e8"}}) == "frequency_noise");
    CHECK(refused_at({{"frequency_noise", "2"}}) == "frequency_noise");
    CHECK(refused_at({{"transmitter_velocity", "[1, 2, 3]"}}) == "transmitter_velocity");
    CHECK(refused_at({{"receiver", "[1, 2]"}, {"transmitter", "[1, 2, 3]"}}) == "transmitter");
    CHECK(refused_at({{"receiver_velocity", "[1, 2]"}}) == "receiver_velocity");
}
