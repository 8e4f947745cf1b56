#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "host/plugin_error.hpp"
#include "host/services.hpp"

using namespace pelorus::host;

namespace {

using Body = std::function<plr_status(std::int64_t first, std::int64_t last, plr_scratch& scratch, plr_error& error)>;

/// plr_parallel.run with a C++ body.
plr_status run(const ThreadPool& pool, std::int64_t count, std::int64_t block, const Body& body,
               plr_error* error = nullptr) {
    const auto call = [](void* argument, std::int64_t first, std::int64_t last, plr_scratch* scratch, plr_error* told) {
        return (*static_cast<const Body*>(argument))(first, last, *scratch, *told);
    };
    const plr_parallel& service = pool.service();
    return service.run(service.context, count, block, call, const_cast<Body*>(&body), error);
}

void rest() { std::this_thread::sleep_for(std::chrono::milliseconds(20)); }

}  // namespace

TEST_CASE("Every item is worked on once, in blocks that do not depend on the threads", "[host]") {
    for (const auto& [count, block] :
         {std::pair<std::int64_t, std::int64_t>{1000, 7}, {1000, 1000}, {5, 100}, {64, 1}}) {
        std::set<std::pair<std::int64_t, std::int64_t>> expected;
        for (std::int64_t first = 0; first < count; first += block)
            expected.emplace(first, std::min(first + block, count));
        for (const unsigned threads : {1u, 2u, 8u}) {
            const ThreadPool pool(threads);
            CHECK(pool.service().threads == threads);
            std::mutex mutex;
            std::set<std::pair<std::int64_t, std::int64_t>> blocks;
            std::vector<int> visits(static_cast<std::size_t>(count));
            REQUIRE(run(pool, count, block, [&](std::int64_t first, std::int64_t last, plr_scratch&, plr_error&) {
                        for (std::int64_t i = first; i < last; ++i) ++visits[static_cast<std::size_t>(i)];
                        const std::lock_guard<std::mutex> lock(mutex);
                        blocks.emplace(first, last);
                        return PLR_OK;
                    }) == PLR_OK);
            CHECK(visits == std::vector<int>(visits.size(), 1));
            CHECK(blocks == expected);
        }
    }
}

TEST_CASE("One thread works in the caller, several at the same time", "[host]") {
    const ThreadPool alone(1);
    const std::thread::id caller = std::this_thread::get_id();
    CHECK(run(alone, 10, 1, [&](auto, auto, auto&, auto&) {
              return std::this_thread::get_id() == caller ? PLR_OK : PLR_E_DATA;
          }) == PLR_OK);
    const ThreadPool pair(2);
    std::atomic<int> present{0};
    const auto meet = [&](std::int64_t, std::int64_t, plr_scratch&, plr_error&) {
        ++present;
        const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
        while (present < 2 && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
        return present == 2 ? PLR_OK : PLR_E_DATA;
    };
    CHECK(run(pair, 2, 1, meet) == PLR_OK);
}

TEST_CASE("The first failing block in order decides, whichever fails first in time", "[host]") {
    for (const unsigned threads : {1u, 2u, 8u}) {
        const ThreadPool pool(threads);
        for (int repeat = 0; repeat < 5; ++repeat) {
            plr_error error = empty_error();
            const plr_status status = run(
                pool, 16, 1,
                [](std::int64_t first, std::int64_t, plr_scratch&, plr_error& told) -> plr_status {
                    if (first == 3) rest();
                    if (first == 3) return tell(&told, PLR_E_NUMERIC, "block three");
                    if (first == 5) return tell(&told, PLR_E_DATA, "block five");
                    return PLR_OK;
                },
                &error);
            CHECK(status == PLR_E_NUMERIC);
            CHECK(error.code == PLR_E_NUMERIC);
            CHECK(std::string(error.message) == "block three");
        }
    }
}

TEST_CASE("All blocks before the failing one are done", "[host]") {
    const ThreadPool pool(8);
    std::vector<std::atomic<int>> done(1000);
    CHECK(run(pool, 1000, 1, [&](std::int64_t first, std::int64_t, plr_scratch&, plr_error&) {
              if (first == 700) return PLR_E_DATA;
              ++done[static_cast<std::size_t>(first)];
              return PLR_OK;
          }) == PLR_E_DATA);
    for (std::size_t i = 0; i < 700; ++i) REQUIRE(done[i] == 1);
}

TEST_CASE("Failed items are answered unless a whole block failed", "[host]") {
    const ThreadPool pool(2);
    const auto items = [](std::int64_t first, std::int64_t, plr_scratch&, plr_error& told) -> plr_status {
        if (first == 2 || first == 5) {
            tell(&told, PLR_E_NUMERIC, first == 2 ? "two" : "five");
            return PLR_ITEMS_FAILED;
        }
        return PLR_OK;
    };
    plr_error error = empty_error();
    CHECK(run(pool, 8, 1, items, &error) == PLR_ITEMS_FAILED);
    CHECK(std::string(error.message) == "two");
    error = empty_error();
    CHECK(run(
              pool, 8, 1,
              [&](std::int64_t first, std::int64_t last, plr_scratch& scratch, plr_error& told) {
                  return first == 7 ? tell(&told, PLR_E_IO, "seven") : items(first, last, scratch, told);
              },
              &error) == PLR_E_IO);
    CHECK(std::string(error.message) == "seven");
}

TEST_CASE("A body that throws fails its block, the pool goes on", "[host]") {
    for (const unsigned threads : {1u, 2u}) {
        const ThreadPool pool(threads);
        plr_error error = empty_error();
        const Body throwing = [](std::int64_t, std::int64_t, plr_scratch&, plr_error&) -> plr_status {
            throw std::runtime_error("out of luck");
        };
        CHECK(run(pool, 4, 1, throwing, &error) == PLR_E_EXCEPTION);
        CHECK(std::string(error.message) == "out of luck");
        CHECK(run(pool, 4, 1, [](auto, auto, auto&, auto&) { return PLR_OK; }) == PLR_OK);
    }
}

TEST_CASE("A run within a body of the same pool is refused, of another pool is fine", "[host]") {
    for (const unsigned threads : {1u, 2u}) {
        const ThreadPool outer(threads), inner(2);
        std::atomic<int> refused{0}, reached{0};
        const Body ok = [&](auto, auto, auto&, auto&) { return ++reached, PLR_OK; };
        const Body again = [&](std::int64_t, std::int64_t, plr_scratch&, plr_error&) -> plr_status {
            plr_error error = empty_error();
            if (run(outer, 2, 1, ok, &error) == PLR_E_ARGUMENT &&
                std::string(error.message) == "parallel: run called from within a body of another run")
                ++refused;
            return PLR_OK;
        };
        CHECK(run(outer, 2, 1, again) == PLR_OK);
        CHECK(refused == 2);
        CHECK(reached == 0);
        // From the inner pool's threads the outer one is still in use.
        CHECK(run(outer, 2, 1, [&](auto, auto, auto&, auto&) { return run(inner, 2, 1, again); }) == PLR_OK);
        CHECK(refused == 6);
        CHECK(run(outer, 2, 1, ok) == PLR_OK);
        CHECK(reached == 2);
    }
}

TEST_CASE("Each thread has scratch of its own: aligned, large, empty at every block", "[host]") {
    const ThreadPool pool(8);
    std::mutex mutex;
    std::set<unsigned char*> areas;
    const plr_status status =
        run(pool, 200, 1, [&](std::int64_t first, std::int64_t, plr_scratch& scratch, plr_error&) {
            if (reinterpret_cast<std::uintptr_t>(scratch.data) % 64 != 0 || scratch.size < (std::uint64_t{16} << 20) ||
                scratch.used != 0)
                return PLR_E_SCRATCH;
            scratch.used = 1024;  // left raised, against the contract
            std::memset(scratch.data, static_cast<int>(first % 251), 4096);
            std::this_thread::yield();
            for (int i = 0; i < 4096; ++i)
                if (scratch.data[i] != first % 251) return PLR_E_DATA;
            const std::lock_guard<std::mutex> lock(mutex);
            areas.insert(scratch.data);
            return PLR_OK;
        });
    CHECK(status == PLR_OK);
    CHECK(areas.size() <= 8);
}

TEST_CASE("Runs from several threads on one pool follow one another", "[host]") {
    const ThreadPool pool(4);
    std::atomic<std::int64_t> sum{0};
    std::vector<std::thread> callers;
    for (int caller = 0; caller < 4; ++caller)
        callers.emplace_back([&] {
            for (int repeat = 0; repeat < 200; ++repeat)
                run(pool, 32, 3, [&](std::int64_t first, std::int64_t last, plr_scratch&, plr_error&) {
                    for (std::int64_t i = first; i < last; ++i) sum += i;
                    return PLR_OK;
                });
        });
    for (std::thread& caller : callers) caller.join();
    CHECK(sum == 4 * 200 * (31 * 32 / 2));
}

TEST_CASE("A run of nothing is done, one without sense is refused", "[host]") {
    const ThreadPool pool(2);
    const Body never = [](auto, auto, auto&, auto&) { return PLR_E_DATA; };
    CHECK(run(pool, 0, 4, never) == PLR_OK);
    plr_error error = empty_error();
    CHECK(run(pool, -1, 4, never, &error) == PLR_E_ARGUMENT);
    CHECK(std::string(error.message) == "parallel: expected count >= 0, block > 0 and a body");
    CHECK(run(pool, 4, 0, never) == PLR_E_ARGUMENT);
    CHECK(pool.service().run(pool.service().context, 4, 1, nullptr, nullptr, nullptr) == PLR_E_ARGUMENT);
    const Body once = [](std::int64_t first, std::int64_t last, plr_scratch&, plr_error&) {
        return first == 0 && last == 3 ? PLR_OK : PLR_E_DATA;
    };
    CHECK(run(pool, 3, std::numeric_limits<std::int64_t>::max(), once) == PLR_OK);
    CHECK(ThreadPool(0).service().threads >= 1);
}
