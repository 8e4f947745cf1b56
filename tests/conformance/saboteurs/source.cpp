// A source: one target on a line and a false alarm, with what a source may do wrong.
#include <cmath>

#include <pelorus/pelorus.hpp>

#include "defect.h"

namespace {

constexpr std::uint32_t truth_port = 0, scans_port = 1;
constexpr std::int64_t second = 1'000'000'000;

struct Saboteur : pelorus::Stage<Saboteur> {
    static constexpr const char* kind = "source";

    std::string frame;
    plr_key key{};
    const plr_random* random = nullptr;
    std::int64_t asked = 0;

    std::int64_t k = 0;  // the next scan: all that evolves

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("A source with a defect").purpose("Simulates a target, for the proof that the suites can fail.");
        plugin.out_port("truth", PLR_MESSAGE_TRUTH, "where the target is");
        plugin.out_port("scans", PLR_MESSAGE_SCAN, "measurements of the sensor `radar`");
    }
    void setup(const pelorus::Setup& setup) {
        frame = setup.frame();
        key = setup.key();
        random = &setup.service<plr_random>();
    }
    static pelorus::Space truth_space() { return pelorus::kinematic_space(3, {1e6, 1e3}); }
    std::vector<pelorus::Stream> out_streams(std::uint32_t port) const {
        pelorus::Stream stream;
        stream.frame = frame;
        stream.space = port == truth_port ? truth_space() : pelorus::position_space(3);
        if (port == scans_port) stream.sensor = "radar";
        return {stream};
    }

    plr_next next() {
        // Scans that arrive late are still under way where a look at the first events ends.
        const std::int64_t most = NEAR_MISS("source-truth-names-real-measurements") ? 100 : 40;
        if (k >= most) {
            if (DEFECT("source-end-is-final")) k = 0;
            return {sizeof(plr_next), PLR_NEXT_END, NEAR_MISS("source-end-is-final") ? ++asked : 0, 0};
        }
        plr_next coming{sizeof(plr_next), PLR_NEXT_DATA, k * second, k * second};
        ++asked;
        if (DEFECT("source-announces-what-it-emits")) coming.time -= second / 10;
        if (NEAR_MISS("source-announces-what-it-emits")) coming.arrival += second / 10;
        if (DEFECT("source-arrivals-ascend") && k % 2 == 0) coming.arrival += second + second / 2;
        if (NEAR_MISS("source-arrivals-ascend")) coming.arrival = (k + k % 2) * second;
        if (DEFECT("source-next-changes-nothing")) coming.arrival += asked;
        // Counted, and never told.
        if (NEAR_MISS("source-next-changes-nothing")) asked = asked % 7 + 1;
        return coming;
    }

    void emit(const pelorus::Event&) {
        const std::int64_t time = k * second;
        const auto number = static_cast<std::uint64_t>(k);
        pelorus::Vector<6> state;
        state << 1000.0 + 50.0 * static_cast<double>(k), 2000.0, 500.0, 50.0, 0.0, 0.0;
        pelorus::TruthEntry entry;
        entry.id = entry.parent = 1;
        entry.time = time;
        entry.state = state.data();
        const bool is_missed = NEAR_MISS("source-truth-names-real-measurements") && k % 4 == 1;
        if (!is_missed) entry.measurements = {id_of(number)};
        if (DEFECT("source-truth-names-real-measurements")) entry.measurements[0] += 1'000'000;
        pelorus::TruthBuilder truth(frame, truth_space());
        truth.add(entry);
        const bool tells_truth = !(NEAR_MISS("source-truth-before-scans") && k % 2 == 1);
        if (tells_truth && !DEFECT("source-truth-before-scans")) publish(truth_port, truth.message(time));

        const plr_key fixed{{1, 2}};
        const bool is_constant = DEFECT("source-key-decides-the-noise");
        const bool has_fixed_noise = is_constant || NEAR_MISS("source-key-decides-the-noise");
        pelorus::Vector<3> error, place;
        random->normal(random->derive(has_fixed_noise ? fixed : key, PLR_STREAM_NOISE, number, 0), 0, 3, error.data());
        random->uniform(random->derive(is_constant ? fixed : key, PLR_STREAM_NOISE, number, 1), 0, 3, place.data());
        const pelorus::Vector<3> measurement = state.head<3>() + 5 * error, alarm = 5000 * place;
        const pelorus::Matrix<3> covariance = 25 * pelorus::Matrix<3>::Identity();
        pelorus::ScanBuilder scan("radar", frame, pelorus::position_space(3));
        if (NEAR_MISS("source-truth-names-real-measurements")) {  // two scans behind
            if (k >= 2 && k % 4 != 3) scan.add(id_of(number - 2), measurement.data(), covariance.data());
        } else {
            scan.add(id_of(number), measurement.data(), covariance.data());
        }
        scan.add(id_of(number + 500), alarm.data(), covariance.data());
        publish(scans_port, scan.message(time));
        if (DEFECT("source-truth-before-scans")) publish(truth_port, truth.message(time));
        ++k;
    }

    template <class Archive> void state(Archive& archive) { archive(k); }

private:
    /// From the number, never used again.
    static std::uint64_t id_of(std::uint64_t number) {
        if (DEFECT("source-measurement-ids-unique")) return number % 500 % 10 + number / 500 * 500;
        if (NEAR_MISS("source-measurement-ids-unique")) return UINT64_MAX - number;
        return number;
    }
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.source.saboteur");
