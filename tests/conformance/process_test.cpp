// The processes in which checks are tried, whatever a plugin does to them.
#include <catch2/catch.hpp>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include "conformance/machine/process.hpp"
#include "fixtures/temporary_folder.hpp"

namespace {

using pelorus::conformance::ProcessPool;
using pelorus::test::TemporaryFolder;

/// One child alone.
ProcessPool::Ended ended(double time_limit, const std::function<void(int)>& body) {
    ProcessPool pool(1);
    pool.start(7, time_limit, body);
    ProcessPool::Ended one = pool.wait();
    CHECK(one.job == 7);
    CHECK(pool.is_empty());
    return one;
}

void tell(int descriptor, const std::string& text) {
    if (write(descriptor, text.data(), text.size()) != static_cast<ssize_t>(text.size())) _exit(9);
}

[[noreturn]] void spin() {
    for (volatile unsigned turns = 0;;) turns = turns + 1;
}

/// Whether a process is gone soon.
bool ends(pid_t process) {
    for (int tries = 0; tries < 200 && kill(process, 0) == 0; ++tries)
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return kill(process, 0) != 0;
}

pid_t process_in(const std::string& file) {
    for (int tries = 0; tries < 200; ++tries) {
        pid_t process = 0;
        if (std::ifstream(file) >> process) return process;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return -1;
}

void note_process(const std::string& file) {
    std::ofstream(file + ".part") << getpid() << "\n";
    std::filesystem::rename(file + ".part", file);
}

}  // namespace

TEST_CASE("A child process tells what it found, what it said, and how it ended") {
    const std::string much(1 << 20, 'x');
    const auto one = ended(20, [&](int descriptor) {
        tell(descriptor, much);
        tell(STDOUT_FILENO, "first\nlast\n");
        _exit(3);
    });
    CHECK(one.written == much);
    CHECK(one.talk == "first\nlast");
    CHECK(one.how == "exit code 3");
    CHECK_FALSE(one.ran_out_of_time);
}

TEST_CASE("A child that closes all it was given and turns in circles runs out of time") {
    const auto one = ended(1, [](int descriptor) {
        tell(descriptor, "so far");
        for (int each = 0; each < 256; ++each) close(each);
        spin();
    });
    CHECK(one.ran_out_of_time);
    CHECK(one.written == "so far");
}

TEST_CASE("A child that waits for what never comes runs out of time, too") {
    CHECK(ended(1, [](int) {
              for (;;) pause();
          }).ran_out_of_time);
}

TEST_CASE("A child has ended although what it started keeps its descriptors") {
    const TemporaryFolder folder;
    const std::string file = folder / "helper";
    const auto one = ended(20, [&](int descriptor) {
        if (fork() == 0) {
            setsid();  // out of the group, too
            note_process(file);
            sleep(60);
            _exit(0);
        }
        process_in(file);
        tell(descriptor, "done");
        _exit(0);
    });
    CHECK_FALSE(one.ran_out_of_time);
    CHECK(one.written == "done");
    CHECK(one.seconds < 20);
    kill(process_in(file), SIGKILL);
}

TEST_CASE("With a child that ran out of time go its own children") {
    const TemporaryFolder folder;
    const std::string file = folder / "grandchild";
    const auto one = ended(1, [&](int) {
        ProcessPool inner(1);
        inner.start(0, 60, [&](int) {
            note_process(file);
            spin();
        });
        spin();
    });
    CHECK(one.ran_out_of_time);
    CHECK(ends(process_in(file)));
}

TEST_CASE("A pool that is asked to stop kills its children and throws") {
    const TemporaryFolder folder;
    const std::string file = folder / "child";
    std::atomic<bool> stop{false};
    {
        ProcessPool pool(2, &stop);
        pool.start(0, 60, [&](int) {
            note_process(file);
            spin();
        });
        process_in(file);
        stop = true;
        CHECK_THROWS_AS(pool.wait(), ProcessPool::Interrupted);
    }
    CHECK(ends(process_in(file)));
}

TEST_CASE("A child works in a folder of its own, which goes with it") {
    const auto one = ended(20, [](int descriptor) {
        std::ofstream("left behind") << "something";
        tell(descriptor, std::filesystem::current_path().string());
        raise(SIGKILL);
    });
    CHECK(one.how.find("signal") == 0);
    REQUIRE_FALSE(one.written.empty());
    CHECK_FALSE(std::filesystem::exists(one.written));
}

TEST_CASE("A child that writes without end is stopped") {
    const auto one = ended(20, [](int) {
        const std::string line(1 << 16, 'x');
        for (;;) tell(STDOUT_FILENO, line);
    });
    CHECK_FALSE(one.ran_out_of_time);
    CHECK(one.how.find("signal") == 0);
}
