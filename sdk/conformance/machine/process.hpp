/// Child processes with a time limit, and what they leave.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <sys/types.h>

#include "temporary_folder.hpp"

namespace pelorus::conformance {

class ProcessPool {
public:
    struct Ended {
        std::size_t job = 0;
        std::string written;  ///< to the descriptor that the child was given
        std::string talk;     ///< the end of what it wrote to standard output and error
        std::string how;      ///< `exit code 3`, `signal 11`
        bool ran_out_of_time = false;
        double seconds = 0;
    };

    /// At most `most` children at once. Once `stop` is set, wait() throws Interrupted; children are killed with the pool.
    explicit ProcessPool(unsigned most, const std::atomic<bool>* stop = nullptr) : most_(most), stop_(stop) {}
    ~ProcessPool();
    ProcessPool(const ProcessPool&) = delete;
    ProcessPool& operator=(const ProcessPool&) = delete;

    struct Interrupted {};

    bool is_full() const noexcept { return running_.size() >= most_; }
    bool is_empty() const noexcept { return running_.empty(); }
    /// Runs `body(descriptor)` in a child, in a folder that goes with it however it ends. `time_limit`, in s, is of processor time;
    /// so a busy machine makes no verdict. A child that waits without end has as long by the clock. Throws std::system_error if the
    /// system refuses a child.
    void start(std::size_t job, double time_limit, const std::function<void(int descriptor)>& body);
    /// Waits for the next child to end or to run out of time (then it is killed, with all that it started).
    Ended wait();

private:
    struct Child {
        std::size_t job;
        pid_t process;
        int alive, results, talk;  // descriptors of ours: it has ended; what it writes; what it says
        double started, time_limit;
        double looked_at, used_then;  // when we last looked whether it still works, and its processor time then
        std::unique_ptr<TemporaryFolder> folder;
        std::string written;
    };
    bool read_some(Child& child);
    bool has_run_out(Child& child) const;
    Ended finish(std::vector<Child>::iterator at, bool ran_out_of_time);

    unsigned most_;
    const std::atomic<bool>* stop_;
    std::vector<Child> running_;
};

/// The marks of places in a message (see place_of), replaced by function, file and line as far as they can be found.
std::string with_places_resolved(const std::string& message);

}  // namespace pelorus::conformance
