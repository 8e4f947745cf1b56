/// Other programs, as a test starts them.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace pelorus::test {

/// How a program ended and what it said.
struct Ended {
    int exit = -1;    ///< exit code, or 128 + the signal that ended it
    std::string out;  ///< standard output
    std::string err;  ///< standard error
};

struct ProcessOptions {
    std::filesystem::path folder = {};                    ///< to run in; here unless given
    std::map<std::string, std::string> environment = {};  ///< over the test's own; "" takes a variable away
    bool close_output = false;                            ///< standard output is a pipe that nobody reads
};

/// A program under way; killed when the object dies.
class Process {
public:
    explicit Process(const std::vector<std::string>& words, const ProcessOptions& options = {});
    ~Process();
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    void send(int signal) const;
    /// Whether it has not ended yet.
    bool running() const;
    /// What it has said on standard error so far.
    std::string errors() const;
    Ended wait();

private:
    std::filesystem::path files_;
    ::pid_t pid_ = -1;
};

Ended run(const std::vector<std::string>& words, const ProcessOptions& options = {});

/// The command of this build, with no plugins but its own and those that the arguments name.
Ended pelorus_command(std::vector<std::string> arguments, ProcessOptions options = {});

/// The same command, which finds what an installation has: the plugins of this build without the examples of the SDK.
Ended shipped_command(std::vector<std::string> arguments, ProcessOptions options = {});

/// Checks configs against a schema that `pelorus schema` has written: exit code 0, or 1 and a line each for what is wrong.
Ended validate_configs(const std::filesystem::path& schema, const std::vector<std::string>& configs);

std::string read_file(const std::filesystem::path& file);

/// Occurrences of a part in a text.
std::size_t count(const std::string& text, const std::string& part);

}  // namespace pelorus::test
