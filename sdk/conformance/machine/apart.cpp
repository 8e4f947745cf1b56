#include "apart.hpp"

#include <unistd.h>

#include <exception>

#include "child.hpp"
#include "fault_handler.hpp"
#include "process.hpp"

namespace pelorus::conformance {

namespace {

constexpr int time_limit = 8;  // s; well below that of a check

}  // namespace

Apart apart(const std::function<std::string()>& body) {
    ProcessPool pool(1);
    pool.start(0, time_limit, [&](int descriptor) {
        install_fault_handler(descriptor);
        std::string text;
        try {
            text = body();
        } catch (...) {
            _exit(3);  // a failed assertion: the check makes it again, and tells it, where it matters
        }
        for (std::size_t done = 0; done < text.size();) {
            const ssize_t now = write(descriptor, text.data() + done, text.size() - done);
            if (now <= 0) _exit(2);
            done += static_cast<std::size_t>(now);
        }
        _exit(0);
    });
    const ProcessPool::Ended ended = pool.wait();
    if (ended.how == "exit code 0") return {ended.written, ""};
    const Outcome outcome = read_outcome(ended.written);
    if (ended.ran_out_of_time)
        return {"", "did not come back within " + std::to_string(time_limit) + " s" +
                        (outcome.messages.empty() ? "" : "; " + outcome.messages.front())};
    return {"", outcome.messages.empty() ? "the process ended: " + ended.how : outcome.messages.front()};
}

}  // namespace pelorus::conformance
