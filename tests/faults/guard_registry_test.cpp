// The registry behind the guard tables, alone and with threads, and guards of instances that share or lack a `self`.
#include <catch2/catch.hpp>

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include <pelorus/abi/abi.h>

#include "host/guard/guard.hpp"
#include "host/guard/record.hpp"
#include "host/guard/registry.hpp"

using namespace pelorus::host;

TEST_CASE("guard registry: keys are found until they are removed, NULL and doubled ones are refused") {
    GuardRegistry registry(4);
    const GuardRecord first, second;
    const int keys[2] = {};
    CHECK(!registry.insert(nullptr, first));
    CHECK(registry.insert(&keys[0], first));
    CHECK(!registry.insert(&keys[0], second));
    CHECK(registry.insert(&keys[1], second));
    CHECK(registry.find(&keys[0]) == &first);
    CHECK(registry.find(&keys[1]) == &second);
    CHECK(registry.find(nullptr) == nullptr);
    registry.remove(&keys[0]);
    registry.remove(&keys[0]);
    CHECK(registry.find(&keys[0]) == nullptr);
    CHECK(registry.find(&keys[1]) == &second);
    CHECK(registry.insert(&keys[0], second));
    CHECK(registry.find(&keys[0]) == &second);
    CHECK(registry.size() == 2);
}

TEST_CASE("guard registry: it grows with what lives in it, not with what ever did") {
    GuardRegistry registry(4);
    const GuardRecord record;
    std::vector<double> keys(1000);
    for (const double& key : keys) {
        REQUIRE(registry.insert(&key, record));
        registry.remove(&key);
    }
    CHECK(registry.capacity() == 4);
    for (const double& key : keys) REQUIRE(registry.insert(&key, record));
    CHECK(registry.capacity() == 2048);
    for (const double& key : keys) REQUIRE(registry.find(&key) == &record);
    for (const double& key : keys) registry.remove(&key);
    for (const double& key : keys) REQUIRE(registry.find(&key) == nullptr);
}

TEST_CASE("guard registry: threads find their own keys while others come and go and the table grows") {
    constexpr std::size_t threads = 4, each = 400, rounds = 20;
    GuardRegistry registry(4);
    std::vector<std::vector<double>> keys(threads, std::vector<double>(each));
    std::vector<std::unique_ptr<GuardRecord>> records;
    for (std::size_t t = 0; t < threads; ++t) records.push_back(std::make_unique<GuardRecord>());
    std::atomic<int> wrong{0};
    std::vector<std::thread> workers;
    for (std::size_t t = 0; t < threads; ++t)
        workers.emplace_back([&, t] {
            for (std::size_t round = 0; round < rounds; ++round) {
                for (const double& key : keys[t]) wrong += !registry.insert(&key, *records[t]);
                for (const double& key : keys[t]) wrong += registry.find(&key) != records[t].get();
                for (const double& key : keys[t]) {
                    registry.remove(&key);
                    wrong += registry.find(&key) != nullptr;
                }
            }
        });
    for (std::thread& worker : workers) worker.join();
    CHECK(wrong == 0);
    CHECK(registry.size() == 0);
}

namespace {

const plr_trajectory_info the_info = [] {
    static const plr_component component{sizeof(plr_component), 0, "position.x", "m", 0, 1};
    static const plr_space space{sizeof(plr_space), 1, &component};
    plr_trajectory_info info{};
    info.struct_size = sizeof info;
    info.state = &space;
    info.objects = 1;
    return info;
}();

plr_trajectory table_of_a_constant() {
    plr_trajectory table{};
    table.head.struct_size = sizeof table;
    table.head.destroy = [](void*) {};
    table.info = [](const void*) { return &the_info; };
    table.realise = [](const void*, const plr_call*, const plr_view*) -> plr_status { return PLR_OK; };
    return table;
}

GuardedPart part_of(void* self, const plr_trajectory& table) {
    GuardedPart part;
    part.address = "world.targets.one";
    part.plugin = "trajectory.one";
    part.holder = "world";
    part.table_id = PLR_TRAJECTORY;
    part.instance = {self, &table.head};
    return part;
}

}  // namespace

TEST_CASE("guard: only instances that can be told apart by self are guarded, and only while they live") {
    const plr_trajectory table = table_of_a_constant();
    const auto latch = std::make_shared<FaultLatch>();
    int self = 0;
    CHECK(!Guard(part_of(nullptr, table), GuardMode::all, latch).is_on());
    CHECK(!Guard(part_of(&self, table), GuardMode::off, latch).is_on());
    GuardedPart unknown = part_of(&self, table);
    unknown.table_id = "org.example.levitation/1";
    CHECK(!Guard(unknown, GuardMode::all, latch).is_on());
    {
        const Guard first(part_of(&self, table), GuardMode::all, latch);
        CHECK(first.is_on());
        CHECK(!Guard(part_of(&self, table), GuardMode::all, latch).is_on());
        CHECK(first.instance().self == &self);
        CHECK(first.instance().table != &table.head);
    }
    CHECK(Guard(part_of(&self, table), GuardMode::all, latch).is_on());
}

TEST_CASE("guard: a table keeps its length, what it lacks, and what lies behind what the host knows") {
    struct Longer {
        plr_trajectory known;
        void (*of_tomorrow)();
    };
    Longer longer{};
    longer.known = table_of_a_constant();
    longer.known.head.struct_size = sizeof longer;
    longer.of_tomorrow = [] {};
    int self = 0;
    const Guard guard(part_of(&self, longer.known), GuardMode::all, std::make_shared<FaultLatch>());
    REQUIRE(guard.is_on());
    const auto& copy = *reinterpret_cast<const Longer*>(guard.instance().table);
    CHECK(copy.known.head.struct_size == sizeof longer);
    CHECK(copy.known.head.extension == nullptr);
    CHECK(copy.known.realise != longer.known.realise);
    CHECK(copy.known.states == nullptr);
    CHECK(copy.of_tomorrow == longer.of_tomorrow);

    plr_trajectory shorter = table_of_a_constant();
    shorter.head.struct_size = static_cast<std::uint32_t>(offsetof(plr_trajectory, states));
    int other = 0;
    const Guard short_guard(part_of(&other, shorter), GuardMode::all, std::make_shared<FaultLatch>());
    REQUIRE(short_guard.is_on());
    CHECK(short_guard.instance().table->struct_size == shorter.head.struct_size);
}
