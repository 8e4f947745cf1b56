/// How far a run has come, on a terminal.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>

namespace pelorus::cli {

/// One line on standard error that is written anew ten times a second and taken away at the end; nothing where standard error is
/// no terminal. No source says how long it will go on, so the line tells the time reached and not a share.
class Progress {
public:
    Progress();
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// To be called after each event, with its arrival in ns; empty where nobody would see it.
    std::function<void(std::int64_t)> callback();

private:
    void show(std::int64_t arrival);

    const bool visible_;
    std::chrono::steady_clock::time_point start_, shown_;
    std::uint64_t events_ = 0;
};

}  // namespace pelorus::cli
