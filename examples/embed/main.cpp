// Pushes the plots of a radar that turns once in 2 s into a pipeline, and prints the tracks that come out.
#include <pelorus/embed.hpp>

#include <cmath>
#include <cstdio>

constexpr std::int64_t period = 2'000'000'000;  // ns

int fail(const pelorus::Status& status) {
    std::fprintf(stderr, "%s\n", status.text().c_str());
    return 1;
}

void print(const plr_tracks& tracks, std::int64_t time) {
    for (std::int64_t i = 0; i < tracks.count; ++i)
        std::printf("%4.0f s  track %llu  east %7.0f m  north %7.0f m\n", static_cast<double>(time) * 1e-9,
                    static_cast<unsigned long long>(tracks.ids[i]), pelorus::number(tracks.mean, i, 0),
                    pelorus::number(tracks.mean, i, 1));
}

int main(int count, char** arguments) {
    if (count != 2) {
        std::fprintf(stderr, "usage: embed CONFIG\n");
        return 2;
    }
    auto pipeline = pelorus::Pipeline::open(arguments[1]);
    if (!pipeline) return fail(pipeline.status());
    auto tracks = pipeline->subscribe("tracker.tracks");
    if (!tracks) return fail(tracks.status());
    auto radar = pipeline->stream("radar.scans", "radar");
    if (!radar) return fail(radar.status());

    pelorus::ScanMessage scan(*radar);  // range [m], azimuth [rad], elevation [rad]
    for (std::int64_t k = 0; k < 10; ++k) {
        const double east = 10e3 - 150.0 * 2.0 * static_cast<double>(k), north = 5e3, up = 1e3;
        const double plot[] = {std::hypot(east, north, up), std::atan2(north, east),
                               std::atan2(up, std::hypot(east, north))};
        scan.clear();
        scan.add(static_cast<std::uint64_t>(k) + 1, plot);
        if (auto status = pipeline->push("radar.scans", scan.message(k * period)); !status) return fail(status);
        if (auto status = pipeline->advance(k * period); !status) return fail(status);
        while (const plr_message* message = tracks->pull()) print(*message->body.tracks, message->time);
    }
    const pelorus::Status status = pipeline->finish();
    return status ? 0 : fail(status);
}
