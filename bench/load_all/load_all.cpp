// load_all FOLDER: finds and loads every plugin below the folder as the host does, and prints how many there are and how
// many nanoseconds it took to find and to load them. A process of its own, because libraries stay loaded.
#include <chrono>
#include <cstdio>
#include <exception>

#include "host/catalog.hpp"

int main(int count, char** arguments) {
    if (count != 2) {
        std::fputs("load_all FOLDER\n", stderr);
        return 2;
    }
    using Clock = std::chrono::steady_clock;
    const auto nanoseconds = [](Clock::duration span) {
        return static_cast<long long>(std::chrono::duration_cast<std::chrono::nanoseconds>(span).count());
    };
    try {
        const auto start = Clock::now();
        pelorus::host::Catalog catalog({arguments[1]});
        const auto found = Clock::now();
        for (const auto& plugin : catalog.plugins()) catalog.load(plugin.id);
        const auto loaded = Clock::now();
        std::printf("%zu %lld %lld\n", catalog.plugins().size(), nanoseconds(found - start),
                    nanoseconds(loaded - found));
        return 0;
    } catch (const std::exception& problem) {
        std::fprintf(stderr, "load_all: %s\n", problem.what());
        return 1;
    }
}
