#include "process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <initializer_list>
#include <sstream>
#include <system_error>
#include <vector>

extern "C" {  // which the header forgets in glibc 2.36
#include <sys/pidfd.h>
}

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

namespace {

constexpr rlim_t most_memory = rlim_t{8} << 30, longest_file = rlim_t{256} << 20;  // bytes
/// How often a child that took its time is looked at, and what is no work in between, in s.
constexpr double look_every = 2, no_work = 0.005;

void limit(int resource, rlim_t most) {
    rlimit now{};
    if (getrlimit(static_cast<__rlimit_resource_t>(resource), &now) != 0 || now.rlim_cur <= most) return;
    now.rlim_cur = most;
    setrlimit(static_cast<__rlimit_resource_t>(resource), &now);
}

/// What a child of ours is, before anything of a plugin runs in it.
void become_child(pid_t parent, int talk, bool is_nested) {
    if (!is_nested) setpgid(0, 0);  // with whatever it starts, it can be killed
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) std::signal(number, SIG_DFL);
#if !defined(__SANITIZE_THREAD__)  // whose shadow memory is larger than any machine
    limit(RLIMIT_AS, most_memory);
#endif
    limit(RLIMIT_FSIZE, longest_file);
    limit(RLIMIT_CORE, 0);
    dup2(talk, STDOUT_FILENO);
    dup2(talk, STDERR_FILENO);
    dup2(open("/dev/null", O_RDONLY | O_CLOEXEC), STDIN_FILENO);
}

/// A pool in a child of a pool: its children stay in the group of that child, and are killed with it.
bool is_child = false;

double processor_time(pid_t process) {
    clockid_t clock;
    timespec time{};
    if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0;
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

ProcessPool::~ProcessPool() {
    while (!running_.empty()) finish(running_.begin(), true);
}

void ProcessPool::start(std::size_t job, double time_limit, const std::function<void(int)>& body) {
    auto folder = std::make_unique<TemporaryFolder>();
    int ends[2];
    if (pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) fail("pipe");
    const int talk = memfd_create("talk", MFD_CLOEXEC);
    if (talk < 0) fail("memfd_create");
    std::fflush(nullptr);  // or the child writes it once more
    const pid_t parent = getpid();
    const pid_t process = fork();
    if (process < 0) fail("fork");
    if (process == 0) {
        become_child(parent, talk, is_child);
        is_child = true;
        folder->become_home();
        close(ends[0]);
        fcntl(ends[1], F_SETFL, 0);  // the child waits until we have read
        body(ends[1]);
        _exit(0);
    }
    if (!is_child) setpgid(process, process);
    close(ends[1]);
    const int alive = pidfd_open(process, 0);
    if (alive < 0) fail("pidfd_open");
    const double start = now();
    running_.push_back({job, process, alive, ends[0], talk, start, time_limit, start, 0, std::move(folder), {}});
}

/// Takes what there is to read; false once there will be no more.
bool ProcessPool::read_some(Child& child) {
    char bytes[65536];
    for (;;) {
        const ssize_t got = read(child.results, bytes, sizeof bytes);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return got < 0 && errno == EAGAIN;
        child.written.append(bytes, static_cast<std::size_t>(got));
    }
}

bool ProcessPool::has_run_out(Child& child) const {
    const double time = now();
    if (time < child.started + child.time_limit || time < child.looked_at + look_every) return false;
    const double used = processor_time(child.process), before = child.used_then;
    const bool is_first_look = child.looked_at == child.started;
    child.looked_at = time;
    child.used_then = used;
    return used >= child.time_limit || (!is_first_look && used - before < no_work);
}

ProcessPool::Ended ProcessPool::wait() {
    for (;;) {
        if (stop_ != nullptr && *stop_) throw Interrupted();
        std::vector<pollfd> waiting;
        for (const Child& child : running_) {
            waiting.push_back({child.alive, POLLIN, 0});
            waiting.push_back({child.results, POLLIN, 0});  // -1, once it is closed, is passed over
        }
        constexpr int milliseconds = 200;  // a signal may come just before
        poll(waiting.data(), waiting.size(), milliseconds);
        for (std::size_t i = 0; i < running_.size(); ++i) {
            const auto at = running_.begin() + static_cast<std::ptrdiff_t>(i);
            if (waiting[2 * i + 1].revents != 0 && !read_some(*at)) {
                close(at->results);
                at->results = -1;
            }
            if (waiting[2 * i].revents != 0) return finish(at, false);
            if (has_run_out(*at)) return finish(at, true);
        }
    }
}

ProcessPool::Ended ProcessPool::finish(std::vector<Child>::iterator at, bool ran_out_of_time) {
    Child& child = *at;
    // While it is not waited for, its number is its own; with it goes what it started.
    if (ran_out_of_time) {
        kill(child.process, SIGXCPU);  // where it is, it may tell; see fault_handler.hpp
        pollfd ended{child.alive, POLLIN, 0};
        poll(&ended, 1, 1000);
        kill(child.process, SIGKILL);
    }
    if (!is_child) kill(-child.process, SIGKILL);
    int status = 0;
    while (waitpid(child.process, &status, 0) < 0 && errno == EINTR) {
    }
    if (child.results >= 0) read_some(child);
    Ended ended{child.job,       std::move(child.written), end_of(child.talk), how_it_ended(status),
                ran_out_of_time, now() - child.started};
    for (const int descriptor : {child.alive, child.results, child.talk})
        if (descriptor >= 0) close(descriptor);
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
        if (line.empty())
            text += name + "+" + address + " (addr2line knows no line: build with -g)";
        else
            text += line + " (" + name + "+" + address + (line.back() == '?' ? "; build with -g for the line)" : ")");
    }
}

}  // namespace pelorus::conformance
