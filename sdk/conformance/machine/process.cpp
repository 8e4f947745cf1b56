#include "process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <sstream>
#include <system_error>
#include <vector>

namespace pelorus::conformance {

namespace {

constexpr std::size_t longest_talk = 2000;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

[[noreturn]] void fail(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

/// The last lines of a file that a child wrote to.
std::string end_of(int file) {
    const off_t size = lseek(file, 0, SEEK_END);
    if (size <= 0) return {};
    const auto wanted = std::min<off_t>(size, static_cast<off_t>(longest_talk));
    std::string text(static_cast<std::size_t>(wanted), '\0');
    const ssize_t got = pread(file, text.data(), text.size(), size - wanted);
    text.resize(got < 0 ? 0 : static_cast<std::size_t>(got));
    if (size > wanted) text = "... " + text.substr(std::min(text.size(), text.find('\n') + 1));
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
    return text;
}

std::string how_it_ended(int status) {
    if (WIFSIGNALED(status)) return std::string("signal ") + strsignal(WTERMSIG(status));
    return "exit code " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

ProcessPool::~ProcessPool() {
    while (!running_.empty()) finish(running_.begin(), true);
}

void ProcessPool::start(std::size_t job, double time_limit, const std::function<void(int)>& body) {
    auto folder = std::make_unique<TemporaryFolder>();
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) fail("pipe");
    const int talk = memfd_create("talk", MFD_CLOEXEC);
    if (talk < 0) fail("memfd_create");
    std::fflush(nullptr);  // or the child writes it once more
    const pid_t process = fork();
    if (process < 0) fail("fork");
    if (process == 0) {
        setpgid(0, 0);  // with whatever it starts, it can be killed
        folder->become_home();
        close(ends[0]);
        dup2(talk, STDOUT_FILENO);
        dup2(talk, STDERR_FILENO);
        const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
        dup2(nothing, STDIN_FILENO);
        body(ends[1]);
        _exit(0);
    }
    setpgid(process, process);
    close(ends[1]);
    const double start = now();
    running_[ends[0]] = {job, process, ends[0], talk, start, start + time_limit, std::move(folder), {}};
}

ProcessPool::Ended ProcessPool::wait() {
    for (;;) {
        std::vector<pollfd> waiting;
        double deadline = 1e300;
        for (const auto& [descriptor, child] : running_) {
            waiting.push_back({descriptor, POLLIN, 0});
            deadline = std::min(deadline, child.deadline);
        }
        const int milliseconds = static_cast<int>(std::max(0.0, std::min(1e6, (deadline - now()) * 1e3 + 1)));
        poll(waiting.data(), waiting.size(), milliseconds);
        for (const pollfd& each : waiting) {
            const auto at = running_.find(each.fd);
            if (each.revents != 0) {
                char bytes[65536];
                const ssize_t got = read(each.fd, bytes, sizeof bytes);
                if (got > 0)
                    at->second.written.append(bytes, static_cast<std::size_t>(got));
                else if (got == 0)
                    return finish(at, false);
            }
            if (now() > at->second.deadline) return finish(at, true);
        }
    }
}

ProcessPool::Ended ProcessPool::finish(std::map<int, Child>::iterator at, bool ran_out_of_time) {
    Child& child = at->second;
    if (ran_out_of_time) kill(-child.process, SIGKILL);
    int status = 0;
    while (waitpid(child.process, &status, 0) < 0 && errno == EINTR) {
    }
    kill(-child.process, SIGKILL);  // what it may have started
    Ended ended{child.job,       std::move(child.written), end_of(child.talk), how_it_ended(status),
                ran_out_of_time, now() - child.started};
    close(child.results);
    close(child.talk);
    running_.erase(at);
    return ended;
}

namespace {

/// Whether a place that addr2line tells is in a file that a plugin's author has written: not in a header of Eigen, the SDK, the system.
bool is_authors_own(const std::string& place) { return place.find("/include/") == std::string::npos; }

/// What addr2line says of an address: `function at file:line`, or "". Of functions inlined into one another, the innermost that is
/// the author's own.
std::string line_of(const std::string& library, const std::string& address) {
    std::string quoted = "'";
    for (const char c : library) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    const std::string command = "addr2line -C -f -i -p -e " + quoted + "' " + address + " 2>/dev/null";
    FILE* const output = popen(command.c_str(), "r");
    if (output == nullptr) return {};
    std::string told;
    char part[1024];
    while (std::fgets(part, sizeof part, output) != nullptr) told += part;
    pclose(output);
    std::string innermost;
    std::istringstream lines(told);
    for (std::string line; std::getline(lines, line);) {
        const std::string inlined = " (inlined by) ";
        if (line.rfind(inlined, 0) == 0) line.erase(0, inlined.size());
        if (line.rfind("??", 0) == 0) continue;
        const std::string place = line.substr(std::min(line.size(), line.rfind(" at ")));
        if (is_authors_own(place)) return line;
        if (innermost.empty()) innermost = line;
    }
    return innermost;
}

}  // namespace

std::string with_places_resolved(const std::string& message) {
    std::string text;
    std::size_t from = 0;
    for (;;) {
        const std::size_t first = message.find("<<", from), end = message.find(">>", first);
        if (first == std::string::npos || end == std::string::npos) return text + message.substr(from);
        const std::string mark = message.substr(first + 2, end - first - 2);
        const std::size_t plus = mark.rfind('+');
        text += message.substr(from, first - from);
        from = end + 2;
        if (plus == std::string::npos) {
            text += mark;
            continue;
        }
        const std::string library = mark.substr(0, plus), address = mark.substr(plus + 1);
        const std::string line = line_of(library, address);
        const std::string name = library.substr(library.rfind('/') + 1);
        text += line.empty() ? name + "+" + address + " (addr2line knows no line: build with -g)"
                             : line + " (" + name + "+" + address + ")";
    }
}

}  // namespace pelorus::conformance
