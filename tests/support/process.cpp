#include "process.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace pelorus::test {

namespace fs = std::filesystem;

namespace {

void redirect(const fs::path& file, int descriptor) {
    const int opened = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (opened < 0 || ::dup2(opened, descriptor) < 0) ::_exit(127);
}

/// The write end of a pipe whose read end is closed.
void redirect_to_nobody(int descriptor) {
    int ends[2];
    if (::pipe(ends) != 0 || ::dup2(ends[1], descriptor) < 0) ::_exit(127);
    ::close(ends[0]);
    ::close(ends[1]);
}

[[noreturn]] void become(const std::vector<std::string>& words, const ProcessOptions& options, const fs::path& files) {
    redirect("/dev/null", STDERR_FILENO);
    if (!options.folder.empty() && ::chdir(options.folder.c_str()) != 0) ::_exit(127);
    for (const auto& [name, value] : options.environment)
        value.empty() ? ::unsetenv(name.c_str()) : ::setenv(name.c_str(), value.c_str(), 1);
    redirect(files / "err", STDERR_FILENO);
    if (options.close_output)
        redirect_to_nobody(STDOUT_FILENO);
    else
        redirect(files / "out", STDOUT_FILENO);
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    ::execvp(arguments[0], arguments.data());
    ::_exit(127);
}

}  // namespace

Process::Process(const std::vector<std::string>& words, const ProcessOptions& options) {
    std::string name = (fs::temp_directory_path() / "pelorus-process-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    files_ = name;
    pid_ = ::fork();
    if (pid_ == 0) become(words, options, files_);
    if (pid_ < 0) throw std::runtime_error("cannot start " + words.front());
}

Process::~Process() {
    if (pid_ > 0) {
        ::kill(pid_, SIGKILL);
        ::waitpid(pid_, nullptr, 0);
    }
    std::error_code ignored;
    fs::remove_all(files_, ignored);
}

void Process::send(int signal) const { ::kill(pid_, signal); }

bool Process::running() const {
    siginfo_t ended{};
    return ::waitid(P_PID, static_cast<::id_t>(pid_), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 && ended.si_pid == 0;
}

std::string Process::errors() const { return fs::exists(files_ / "err") ? read_file(files_ / "err") : ""; }

Ended Process::wait() {
    int status = 0;
    if (::waitpid(pid_, &status, 0) != pid_) throw std::runtime_error("a process got lost");
    pid_ = -1;
    Ended ended;
    ended.exit = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    if (fs::exists(files_ / "out")) ended.out = read_file(files_ / "out");
    ended.err = read_file(files_ / "err");
    return ended;
}

Ended run(const std::vector<std::string>& words, const ProcessOptions& options) {
    return Process(words, options).wait();
}

namespace {

Ended command(const char* executable, std::vector<std::string> arguments, ProcessOptions options) {
    arguments.insert(arguments.begin(), executable);
    options.environment.emplace("PELORUS_PLUGIN_PATH", "");
    return run(arguments, options);
}

}  // namespace

Ended pelorus_command(std::vector<std::string> arguments, ProcessOptions options) {
    return command(PELORUS_EXECUTABLE, std::move(arguments), std::move(options));
}

Ended shipped_command(std::vector<std::string> arguments, ProcessOptions options) {
    return command(PELORUS_SHIPPED_EXECUTABLE, std::move(arguments), std::move(options));
}

Ended validate_configs(const std::filesystem::path& schema, const std::vector<std::string>& configs) {
    std::vector<std::string> words{"python3", PELORUS_SOURCE_DIR "/tests/integration/validate_config.py",
                                   schema.string()};
    words.insert(words.end(), configs.begin(), configs.end());
    return run(words);
}

std::string read_file(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw std::runtime_error("no file " + file.string());
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t number = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++number;
    return number;
}

}  // namespace pelorus::test
