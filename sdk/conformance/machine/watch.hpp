/// Watches what a plugin asks of the operating system while it works: memory, locks, clocks, chance, files. The runner interposes
/// these functions of the C library, so libraries that the plugin uses are seen as well.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace pelorus::conformance::watch {

enum class Concern : unsigned {
    memory = 1u << 0,  ///< malloc and its kin
    locks = 1u << 1,   ///< mutexes, condition variables, semaphores, sleeping
    clocks = 1u << 2,
    chance = 1u << 3,  ///< rand and its kin: random numbers that are not the host's
    files = 1u << 4    ///< opening, reading, writing
};

/// False in a build with sanitizers, which interpose the same functions.
bool is_available() noexcept;

/// The first thing that was asked for while a Guard watched for it.
struct Offence {
    const char* function = nullptr;  ///< `clock_gettime`; nullptr: nothing
    std::uint64_t count = 0;         ///< of all such calls
    std::string place;               ///< where in the library under test, see `place_of`; "" if nowhere in it

    /// Takes in what another watch saw later.
    void add(const Offence& later);
};

/// Watches the calling thread while it lives.
class Guard {
public:
    explicit Guard(unsigned concerns) noexcept;
    ~Guard();
    Guard(const Guard&) = delete;
    Guard& operator=(const Guard&) = delete;
    /// Ends the watch and tells what it saw.
    Offence end();

private:
    bool ended_ = false;
};

/// Ends the calling thread's watch for a while, and answers what to resume it with.
unsigned pause() noexcept;
void resume(unsigned concerns) noexcept;
/// What a thread saw that worked for the calling one, whose watch is paused, becomes part of that watch.
void report(const Offence& offence);

/// The host's own work within a call of the plugin: nothing is watched and no allocation fails while it lives.
class HostWork {
public:
    HostWork() noexcept;
    ~HostWork();
    HostWork(const HostWork&) = delete;
    HostWork& operator=(const HostWork&) = delete;

private:
    unsigned watching_;
    std::int64_t until_failure_;
};

/// Blocks that this process holds from malloc and its kin.
std::int64_t blocks_in_use() noexcept;
/// Lets the n-th allocation of the calling thread from now on fail (0: the next one); negative: none. Answers how many more would
/// have had to come.
std::int64_t fail_allocation(std::int64_t n) noexcept;

}  // namespace pelorus::conformance::watch

namespace pelorus::conformance {

/// The frames of this library are what `place_of_caller` looks for.
void set_watched_library(const std::string& path, const void* symbol) noexcept;
/// A mark for an address of code that the report resolves to function, file and line: `<<LIBRARY+0x1234>>`.
std::string place_of(const void* address);
/// Of the innermost frame of the calling thread that is in the library under test, or "".
std::string place_of_caller();
/// Where the library under test writes first to its own static memory while `body` runs (in a process that is forked for it), or "".
std::string place_of_static_write(const std::function<void()>& body);

}  // namespace pelorus::conformance
