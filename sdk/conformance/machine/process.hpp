/// Child processes with a time limit, and what they leave.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>

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

    explicit ProcessPool(unsigned most) : most_(most) {}
    ~ProcessPool();
    ProcessPool(const ProcessPool&) = delete;
    ProcessPool& operator=(const ProcessPool&) = delete;

    bool is_full() const noexcept { return running_.size() >= most_; }
    bool is_empty() const noexcept { return running_.empty(); }
    /// Runs `body(descriptor)` in a child, in a folder that goes with it however it ends. Throws std::system_error if the system
    /// refuses one.
    void start(std::size_t job, double time_limit, const std::function<void(int descriptor)>& body);
    /// Waits for the next child to end or to run out of time (then it is killed).
    Ended wait();

private:
    struct Child {
        std::size_t job;
        pid_t process;
        int results, talk;  // descriptors of ours
        double started, deadline;
        std::unique_ptr<TemporaryFolder> folder;
        std::string written;
    };
    Ended finish(std::map<int, Child>::iterator at, bool ran_out_of_time);

    unsigned most_;
    std::map<int, Child> running_;  // by the descriptor that we read
};

/// The marks of places in a message (see place_of), replaced by function, file and line as far as they can be found.
std::string with_places_resolved(const std::string& message);

}  // namespace pelorus::conformance
