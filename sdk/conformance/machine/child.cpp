#include "child.hpp"

#include <unistd.h>

#include <algorithm>
#include <iterator>

#include <nlohmann/json.hpp>

#include "catch_runner.hpp"
#include "fault_handler.hpp"
#include "subjects.hpp"

namespace pelorus::conformance {

namespace {

using Json = nlohmann::json;

/// What the check has told so far in this process.
struct Telling {
    const Task* task = nullptr;
    std::vector<std::string> failures, warnings, notes, skips;
    std::size_t tried = 0;
};
Telling telling;

Json outcome_json() {
    Json json{{"verdict", "pass"}, {"messages", telling.failures}, {"notes", telling.notes}};
    for (const std::string& warning : telling.warnings) json["messages"].push_back(warning);
    if (!telling.failures.empty())
        json["verdict"] = "fail";
    else if (!telling.warnings.empty())
        json["verdict"] = "warn";
    else if (telling.tried == telling.skips.size())
        json["verdict"] = "skipped";
    if (!telling.skips.empty()) json["reason"] = telling.skips.front();
    return json;
}

void write_all(int descriptor, const std::string& text) {
    for (std::size_t done = 0; done < text.size();) {
        const ssize_t now = write(descriptor, text.data() + done, text.size() - done);
        if (now <= 0) return;
        done += static_cast<std::size_t>(now);
    }
}

}  // namespace

void warn(const std::string& text) { telling.warnings.push_back(text); }
void note(const std::string& text) { telling.notes.push_back(text); }

namespace detail {

void run(void (*body)(Bench&)) {
    const std::vector<Subject> subjects =
        telling.task->subjects.empty() ? subjects_of(*telling.task) : telling.task->subjects;
    for (const Subject& subject : subjects) {
        ++telling.tried;
        set_subject_of_fault(subject.title.c_str());
        Bench bench(*telling.task, subject, telling.tried == 1);
        try {
            if (subject.title.empty()) {
                body(bench);
            } else {
                INFO("with {" << subject.title << "}");
                body(bench);
            }
        } catch (const Skipped& skipped) {
            telling.skips.push_back(skipped.what());
        } catch (const Refused& refused) {
            telling.failures.push_back(refused.what());
        }
    }
}

}  // namespace detail

void run_child(const Task& task, int descriptor) {
    telling.task = &task;
    install_fault_handler(descriptor);
    run_catch(task.check, [](const std::string& failure) { telling.failures.push_back(failure); });
    write_all(descriptor, outcome_json().dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
    // Not exit(): destructors of the plugin's own libraries are not what this check is about. The lifecycle checks try those.
    _exit(0);
}

namespace {
constexpr const char* verdict_names[] = {"pass", "warn", "fail", "crash", "hang", "skipped"};
}

const char* verdict_name(Verdict verdict) noexcept { return verdict_names[static_cast<int>(verdict)]; }

std::optional<Verdict> find_verdict(const std::string& name) noexcept {
    const auto* const found = std::find(std::begin(verdict_names), std::end(verdict_names), name);
    if (found == std::end(verdict_names)) return std::nullopt;
    return static_cast<Verdict>(found - std::begin(verdict_names));
}

bool is_bad(Verdict verdict) noexcept {
    return verdict == Verdict::fail || verdict == Verdict::crash || verdict == Verdict::hang;
}

Outcome read_outcome(const std::string& written) {
    Outcome outcome;
    const Json json = Json::parse(written, nullptr, false);
    if (!json.is_object()) {
        outcome.verdict = Verdict::crash;
        return outcome;
    }
    outcome.verdict = find_verdict(json["verdict"]).value_or(Verdict::crash);
    outcome.messages = json["messages"].get<std::vector<std::string>>();
    if (json.contains("notes")) outcome.notes = json["notes"].get<std::vector<std::string>>();
    outcome.reason = json.value("reason", "");
    return outcome;
}

}  // namespace pelorus::conformance
