#include "report/json_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <system_error>

#include "host/error.hpp"

namespace pelorus::report {
namespace {

using Json = nlohmann::ordered_json;

std::string leaf(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

bool is_flat(const Json& json) {
    return std::none_of(json.begin(), json.end(),
                        [](const Json& part) { return part.is_structured() && !part.empty(); });
}

void append(std::string& text, const Json& json, std::size_t depth) {
    if (!json.is_structured() || json.empty()) {
        text += leaf(json);
        return;
    }
    const bool flat = is_flat(json);
    const std::string separator = flat ? ", " : ",\n" + std::string(2 * (depth + 1), ' ');
    text += json.is_object() ? '{' : '[';
    if (!flat) text += separator.substr(1);
    bool first = true;
    for (auto part = json.begin(); part != json.end(); ++part) {
        if (!first) text += separator;
        first = false;
        if (json.is_object()) text += leaf(Json(part.key())) + ": ";
        append(text, *part, depth + 1);
    }
    if (!flat) text += '\n' + std::string(2 * depth, ' ');
    text += json.is_object() ? '}' : ']';
}

[[noreturn]] void fail(const std::filesystem::path& file, int reason) {
    throw Error(Exit::run_failed, "cannot write " + file.string() + ": " + std::generic_category().message(reason));
}

/// A file beside the one to be written; it goes away unless it is renamed.
class Draft {
public:
    explicit Draft(const std::filesystem::path& file)
        : file_(file), name_(file.string() + ".part" + std::to_string(::getpid())) {
        descriptor_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666);
        if (descriptor_ < 0) fail(file, errno);
    }
    Draft(const Draft&) = delete;
    Draft& operator=(const Draft&) = delete;
    ~Draft() {
        if (descriptor_ >= 0) ::close(descriptor_);
        if (!name_.empty()) ::unlink(name_.c_str());
    }

    void write(const std::string& text) {
        for (std::size_t done = 0; done < text.size();) {
            const ::ssize_t written = ::write(descriptor_, text.data() + done, text.size() - done);
            if (written < 0 && errno != EINTR) fail(file_, errno);
            if (written > 0) done += static_cast<std::size_t>(written);
        }
    }
    void become_the_file() {
        if (::fsync(descriptor_) != 0) fail(file_, errno);
        const int closed = ::close(descriptor_);
        descriptor_ = -1;
        if (closed != 0 || std::rename(name_.c_str(), file_.c_str()) != 0) fail(file_, errno);
        name_.clear();
    }

private:
    const std::filesystem::path& file_;
    std::string name_;
    int descriptor_ = -1;
};

}  // namespace

std::string json_text(const Json& document) {
    std::string text;
    append(text, document, 0);
    return text + '\n';
}

void write_file(const std::filesystem::path& file, const std::string& text) {
    Draft draft(file);
    draft.write(text);
    draft.become_the_file();
}

}  // namespace pelorus::report
