#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdio>
#include <limits>
#include <map>
#include <stdexcept>
#include <thread>
#include <vector>

#include "host/plugin_error.hpp"
#include "host/services.hpp"
#include "host_fixtures.hpp"

using namespace pelorus;
using namespace pelorus::host;
using namespace pelorus::host::test;
using Catch::Matchers::Contains;

namespace {

/// What a call writes to standard error.
template <class Call> std::string standard_error_of(Call&& call) {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.write("stderr", "");
    std::fflush(stderr);
    const int saved = ::dup(2);
    REQUIRE(saved >= 0);
    FILE* capture = std::fopen(file.c_str(), "w");
    REQUIRE(capture != nullptr);
    ::dup2(::fileno(capture), 2);
    call();
    std::fflush(stderr);
    ::dup2(saved, 2);
    ::close(saved);
    std::fclose(capture);
    return bytes_of(file);
}

template <class Service> const Service* service(const InstanceHost& instance, const char* id) {
    return static_cast<const Service*>(instance.host()->service(instance.host(), id));
}

struct Recorder : Publisher {
    std::vector<std::uint32_t> ports;
    plr_status publish(std::uint32_t port, const plr_message&, plr_error* error) override {
        if (port == 7) throw std::runtime_error("no memory");
        if (port == 8) return tell(error, PLR_E_ARGUMENT, "no such port");
        ports.push_back(port);
        return PLR_OK;
    }
};

}  // namespace

TEST_CASE("An instance is served by id, and told when there is no such service", "[host]") {
    const FrameTree frames;
    const ThreadPool pool(1);
    const InstanceHost instance("world.sensors.radar", "sensor.position", {&frames, &pool});
    CHECK(instance.host()->struct_size == sizeof(plr_host));
    CHECK(instance.host()->abi_major == PLR_ABI_MAJOR);
    CHECK(std::string(instance.host()->version) == PELORUS_VERSION);
    CHECK(service<plr_log>(instance, PLR_SERVICE_LOG) == instance.log());
    CHECK(service<plr_random>(instance, PLR_SERVICE_RANDOM) == &random_service());
    CHECK(service<plr_frames>(instance, PLR_SERVICE_FRAMES) == &frames.service());
    CHECK(service<plr_parallel>(instance, PLR_SERVICE_PARALLEL) == &pool.service());
    CHECK(service<plr_diagnostics>(instance, PLR_SERVICE_DIAGNOSTICS) != nullptr);
    CHECK(service<plr_publish>(instance, PLR_SERVICE_PUBLISH) != nullptr);
    CHECK(service<void>(instance, "org.example.coffee") == nullptr);
    CHECK(service<void>(instance, "") == nullptr);
    CHECK(service<void>(instance, nullptr) == nullptr);
    const InstanceHost bare("library.so", "", {});
    CHECK(service<plr_frames>(bare, PLR_SERVICE_FRAMES) == nullptr);
    CHECK(service<plr_parallel>(bare, PLR_SERVICE_PARALLEL) == nullptr);
}

TEST_CASE("A log line carries level, address and plugin, and stays one line", "[host][serial]") {
    const InstanceHost instance("world.sensors.radar", "sensor.position", {});
    const plr_log& log = *instance.log();
    const std::string text = standard_error_of([&] {
        log.write(log.context, PLR_LOG_WARNING, "beam\nlost {} %s");
        log.write(log.context, PLR_LOG_DEBUG, "not at this level");
        log.write(log.context, 77, "beyond the levels");
        log.write(log.context, PLR_LOG_ERROR, nullptr);
    });
    CHECK_THAT(text, Contains("warning [world.sensors.radar (sensor.position)] beam lost {} %s\n"));
    CHECK_THAT(text, Contains("error [world.sensors.radar (sensor.position)] beyond the levels\n"));
    CHECK(text.find("not at this level") == std::string::npos);
}

TEST_CASE("The log level decides what instances made afterwards write", "[host][serial]") {
    const auto lines_at = [](const char* level) {
        set_log_level(level);
        const InstanceHost instance("node", "tracker.x", {});
        const plr_log& log = *instance.log();
        const std::string text = standard_error_of([&] {
            for (const std::int32_t each : {PLR_LOG_TRACE, PLR_LOG_DEBUG, PLR_LOG_INFO, PLR_LOG_WARNING, PLR_LOG_ERROR})
                log.write(log.context, each, "line");
        });
        set_log_level("info");
        return std::pair<std::int32_t, std::ptrdiff_t>(log.level, std::count(text.begin(), text.end(), '\n'));
    };
    using Seen = std::pair<std::int32_t, std::ptrdiff_t>;
    CHECK(lines_at("trace") == Seen(PLR_LOG_TRACE, 5));
    CHECK(lines_at("debug") == Seen(PLR_LOG_DEBUG, 4));
    CHECK(lines_at("info") == Seen(PLR_LOG_INFO, 3));
    CHECK(lines_at("warning") == Seen(PLR_LOG_WARNING, 2));
    CHECK(lines_at("error") == Seen(PLR_LOG_ERROR, 1));
    CHECK(error_of([] { set_log_level("loud"); }) ==
          "no log level loud: expected trace, debug, info, warning or error");
}

TEST_CASE("Counters add up and gauges keep the last value, from many threads", "[host]") {
    InstanceHost instance("node", "tracker.x", {});
    const plr_diagnostics& diagnostics = *service<plr_diagnostics>(instance, PLR_SERVICE_DIAGNOSTICS);
    std::vector<std::thread> threads;
    for (int thread = 0; thread < 4; ++thread)
        threads.emplace_back([&] {
            for (int i = 0; i < 1000; ++i) {
                diagnostics.count(diagnostics.context, "rejected", 2);
                diagnostics.gauge(diagnostics.context, "gate", "m", 3.5);
                (void)instance.counters();
            }
        });
    for (std::thread& thread : threads) thread.join();
    CHECK(instance.counters() == std::map<std::string, std::int64_t>{{"rejected", 8000}});
    REQUIRE(instance.gauges().count("gate") == 1);
    CHECK(instance.gauges().at("gate").unit == "m");
    CHECK(instance.gauges().at("gate").value == 3.5);

    diagnostics.count(diagnostics.context, "rejected", std::numeric_limits<std::int64_t>::max());
    CHECK(instance.counters().at("rejected") == std::numeric_limits<std::int64_t>::max());
    instance.restore({{"rejected", 5}}, {});
    CHECK(instance.counters().at("rejected") == 5);
    CHECK(instance.gauges().empty());
}

TEST_CASE("Publishing leads to the runtime once it is connected", "[host]") {
    InstanceHost instance("node", "tracker.x", {});
    const plr_publish& publish = *service<plr_publish>(instance, PLR_SERVICE_PUBLISH);
    const plr_message message{};
    plr_error error = empty_error();
    CHECK(publish.publish(publish.context, 0, &message, &error) == PLR_E_UNSUPPORTED);
    CHECK_THAT(error.message, Contains("only a stage of a running graph"));
    Recorder recorder;
    instance.connect(&recorder);
    CHECK(publish.publish(publish.context, 3, &message, nullptr) == PLR_OK);
    CHECK(recorder.ports == std::vector<std::uint32_t>{3});
    CHECK(publish.publish(publish.context, 3, nullptr, nullptr) == PLR_E_ARGUMENT);
    error = empty_error();
    CHECK(publish.publish(publish.context, 8, &message, &error) == PLR_E_ARGUMENT);
    CHECK(std::string(error.message) == "no such port");
    error = empty_error();
    CHECK(publish.publish(publish.context, 7, &message, &error) == PLR_E_EXCEPTION);
    CHECK(std::string(error.message) == "no memory");
}
