#include "cli/output.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <sstream>
#include <system_error>

#include <nlohmann/json.hpp>

#include "host/error.hpp"
#include "report/text_width.hpp"

namespace pelorus::cli {

namespace {

constexpr std::size_t line_width = 100;

/// Whether all of it was taken; errno says why not.
bool write_all(int descriptor, const std::string& text) {
    for (std::size_t done = 0; done < text.size();) {
        const ::ssize_t written = ::write(descriptor, text.data() + done, text.size() - done);
        if (written < 0 && errno != EINTR) return false;
        if (written > 0) done += static_cast<std::size_t>(written);
    }
    return true;
}

}  // namespace

void prepare_streams() {
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);  // a file that may grow no more is an error like a full disk
    for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (::fcntl(descriptor, F_GETFD) < 0 && errno == EBADF)
            // Opened for reading, so that writing results to a closed standard output fails as it should.
            ::open("/dev/null", descriptor == STDERR_FILENO ? O_RDWR : O_RDONLY);
}

void print(const std::string& text) {
    if (write_all(STDOUT_FILENO, text)) return;
    if (errno == EPIPE) throw OutputClosed();
    throw Error(Exit::run_failed, "cannot write to standard output: " + std::generic_category().message(errno));
}

void print_json(const nlohmann::ordered_json& json) {
    print(json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

void tell(const std::string& line) { tell_raw("pelorus: " + line + "\n"); }

// Where talk cannot be written there is nobody to be told of it.
void tell_raw(const std::string& text) { write_all(STDERR_FILENO, text); }

bool error_is_terminal() { return ::isatty(STDERR_FILENO) == 1; }

std::string aligned(const std::vector<std::vector<std::string>>& rows, std::size_t indent) {
    std::vector<std::size_t> widths;
    for (const auto& row : rows)
        for (std::size_t i = 0; i < row.size(); ++i) {
            if (i == widths.size()) widths.push_back(0);
            if (i + 1 < row.size()) widths[i] = std::max(widths[i], report::text_width(row[i]));
        }
    std::string text;
    for (const auto& row : rows) {
        std::string line(indent, ' ');
        for (std::size_t i = 0; i < row.size(); ++i) {
            line += row[i];
            if (i + 1 < row.size()) line += std::string(widths[i] - report::text_width(row[i]) + 2, ' ');
        }
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + '\n';
    }
    return text;
}

std::string wrapped(const std::string& paragraph, std::size_t indent) {
    const std::string margin(indent, ' ');
    std::string text, line, word;
    std::istringstream words(paragraph);
    while (words >> word) {
        if (!line.empty() && indent + report::text_width(line) + 1 + report::text_width(word) > line_width) {
            text += margin + line + '\n';
            line.clear();
        }
        line += (line.empty() ? "" : " ") + word;
    }
    return line.empty() ? text : text + margin + line + '\n';
}

}  // namespace pelorus::cli
