#include "runner.hpp"

#include <algorithm>
#include <chrono>
#include <map>
#include <set>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include "elf.hpp"
#include "process.hpp"

namespace pelorus::conformance {

namespace {

bool concerns(const Check& check, const std::string& kind) {
    static const std::set<std::string> models{"motion",      "sensor",   "estimator", "extent",
                                              "partitioner", "waveform", "trajectory"};
    const std::string group = check.group;
    if (group == "library") return false;  // once, and not for each plugin
    if (group == "every" || group == kind) return true;
    return group == (models.count(kind) != 0 ? "model" : "stage");
}

/// A check of one plugin on its way through the run.
struct Job {
    const Check* check;
    std::string plugin, kind;
    std::vector<std::size_t> needs;  // indices of jobs that must be done before it
    Outcome outcome;
    bool is_done = false;
};

class Run {
public:
    Run(const Host& host, const Options& options) : host_(host), options_(options) { plan(); }

    std::vector<Result> go() {
        const unsigned jobs = options_.jobs != 0 ? options_.jobs : std::max(1u, std::thread::hardware_concurrency());
        ProcessPool pool(jobs);
        while (!std::all_of(jobs_.begin(), jobs_.end(), [](const Job& job) { return job.is_done; })) {
            start_what_can(pool);
            const bool all_done = std::all_of(jobs_.begin(), jobs_.end(), [](const Job& job) { return job.is_done; });
            if (!pool.is_empty())
                take(pool.wait());
            else if (!all_done)
                throw std::logic_error("checks rest on each other in a circle");
        }
        std::vector<Result> results;
        for (Job& job : jobs_)
            results.push_back({job.check, job.plugin, job.kind, std::move(job.outcome), repeat_of(job)});
        return results;
    }

    std::string names() const {
        std::string text;
        std::set<std::string> told;
        for (const Job& job : jobs_)
            if (told.insert(job.check->name).second) text += std::string(job.check->name) + "\n";
        return text;
    }

private:
    void plan() {
        std::vector<ManifestEntry> plugins = plugins_of_library();
        if (!options_.kinds.empty()) {
            const auto is_other = [&](const ManifestEntry& each) {
                return std::find(options_.kinds.begin(), options_.kinds.end(), each.kind) == options_.kinds.end();
            };
            plugins.erase(std::remove_if(plugins.begin(), plugins.end(), is_other), plugins.end());
            if (plugins.empty())
                throw Refused(fmt::format("{}: none of its plugins is of kind {}", options_.library.string(),
                                          fmt::join(options_.kinds, ", ")));
        }
        if (!options_.subjects.empty()) subjects_ = host_.subjects(options_.subjects);
        for (const Subject& subject : subjects_) {
            const auto is_it = [&](const ManifestEntry& each) { return each.id == subject.plugin; };
            if (std::none_of(plugins.begin(), plugins.end(), is_it) && options_.kinds.empty())
                throw Refused(fmt::format("{}: subject {}: {} is no plugin of {}", options_.subjects.string(),
                                          subject.title, subject.plugin, options_.library.string()));
        }
        const std::set<std::string> wanted = wanted_checks();
        for (const Check& check : checks())
            if (std::string(check.group) == "library" && is_selected(check, wanted)) add(check, "", "");
        for (const ManifestEntry& plugin : plugins)
            for (const Check& check : checks())
                if (concerns(check, plugin.kind) && is_selected(check, wanted)) add(check, plugin.id, plugin.kind);
        find_needs();
        for (const std::string& name : options_.only)
            if (std::none_of(jobs_.begin(), jobs_.end(), [&](const Job& job) { return name == job.check->name; }))
                throw Refused(fmt::format("{}: check {} concerns {} plugins, and the library has none",
                                          options_.library.string(), name, find_check(name)->group));
    }

    /// None where the manifest cannot be read: the checks of the library tell why.
    std::vector<ManifestEntry> plugins_of_library() const {
        read_elf(options_.library.string());  // or there is nothing to try
        try {
            return host_.manifests(options_.library);
        } catch (const Refused&) {
            if (!options_.kinds.empty()) throw;
            return {};
        }
    }

    /// The checks asked for and what they rest on; empty: all.
    std::set<std::string> wanted_checks() const {
        std::set<std::string> wanted;
        std::vector<std::string> open = options_.only;
        while (!open.empty()) {
            const std::string name = open.back();
            open.pop_back();
            const Check* const check = find_check(name);
            if (check == nullptr) throw Refused("there is no check " + name + "; `pelorus conform --list` tells all");
            if (!wanted.insert(name).second) continue;
            for (const std::string& needed : prerequisites_of(*check)) open.push_back(needed);
        }
        return wanted;
    }
    bool is_selected(const Check& check, const std::set<std::string>& wanted) const {
        return wanted.empty() ? check.level <= options_.level : wanted.count(check.name) != 0;
    }

    void add(const Check& check, const std::string& plugin, const std::string& kind) {
        jobs_.push_back({&check, plugin, kind, {}, {}, false});
        is_started_.push_back(false);
    }
    /// Once all are there: a check may stand before what it rests on.
    void find_needs() {
        for (Job& job : jobs_)
            for (const std::string& name : prerequisites_of(*job.check))
                for (std::size_t i = 0; i < jobs_.size(); ++i)
                    if (name == jobs_[i].check->name && (jobs_[i].plugin.empty() || jobs_[i].plugin == job.plugin))
                        job.needs.push_back(i);
    }

    void start_what_can(ProcessPool& pool) {
        for (std::size_t i = 0; i < jobs_.size(); ++i) {
            if (is_started_[i]) continue;
            Job& job = jobs_[i];
            const auto is_done = [&](std::size_t needed) { return jobs_[needed].is_done; };
            if (!std::all_of(job.needs.begin(), job.needs.end(), is_done)) continue;
            const auto spoilt = std::find_if(job.needs.begin(), job.needs.end(),
                                             [&](std::size_t needed) { return is_spoilt(jobs_[needed]); });
            if (spoilt != job.needs.end()) {
                job.outcome.verdict = Verdict::skipped;
                job.outcome.reason = std::string(jobs_[*spoilt].check->name) + " failed";
                job.is_done = is_started_[i] = true;
                is_spoilt_.insert(i);
                i = static_cast<std::size_t>(-1);  // what rests on it may come before it in the list
                continue;
            }
            if (pool.is_full()) continue;
            is_started_[i] = true;
            const Task task = task_of(job);
            pool.start(i, options_.time_limit, [task](int descriptor) { run_child(task, descriptor); });
        }
    }

    bool is_spoilt(const Job& job) const {
        const auto index = static_cast<std::size_t>(&job - jobs_.data());
        const Verdict verdict = job.outcome.verdict;
        return verdict == Verdict::fail || verdict == Verdict::crash || verdict == Verdict::hang ||
               is_spoilt_.count(index) != 0;
    }

    Task task_of(const Job& job) const {
        Task task;
        task.host = &host_;
        task.library = options_.library.string();
        task.plugin = job.plugin;
        task.kind = job.kind;
        task.check = job.check->name;
        task.seed = options_.seed;
        for (const Subject& subject : subjects_)
            if (subject.plugin == job.plugin) task.subjects.push_back(subject);
        return task;
    }

    void take(const ProcessPool::Ended& ended) {
        Job& job = jobs_[ended.job];
        job.outcome = ended.ran_out_of_time ? Outcome() : read_outcome(ended.written);
        if (ended.ran_out_of_time) {
            job.outcome.verdict = Verdict::hang;
            job.outcome.messages.push_back(fmt::format("did not come back within {} s", options_.time_limit));
        } else if (job.outcome.verdict == Verdict::crash && job.outcome.messages.empty()) {
            job.outcome.messages.push_back("the process ended: " + ended.how);
        }
        job.outcome.seconds = ended.seconds;
        for (std::string& message : job.outcome.messages) message = with_places_resolved(message);
        const bool is_bad = job.outcome.verdict == Verdict::fail || job.outcome.verdict == Verdict::crash ||
                            job.outcome.verdict == Verdict::hang;
        if (is_bad && !ended.talk.empty()) job.outcome.messages.push_back("the plugin wrote: " + ended.talk);
        job.is_done = true;
    }

    std::string repeat_of(const Job& job) const {
        std::string command = "pelorus conform " + quoted(options_.library.string()) + " --only " + job.check->name;
        for (const std::string& word : options_.repeat) command += " " + quoted(word);
        return command;
    }
    static std::string quoted(const std::string& word) {
        const bool is_plain = word.find_first_not_of(
                                  "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                  "_-+./:=,@%") == std::string::npos;
        if (is_plain && !word.empty()) return word;
        std::string text = "'";
        for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
        return text + "'";
    }

    const Host& host_;
    const Options& options_;
    std::vector<Subject> subjects_;
    std::vector<Job> jobs_;
    std::vector<bool> is_started_;
    std::set<std::size_t> is_spoilt_;  // skipped because of a failure
};

}  // namespace

std::vector<std::string> prerequisites_of(const Check& check) {
    std::vector<std::string> all = check.prerequisites;
    const std::string group = check.group;
    if (group != "library") all.emplace_back(group == "every" ? "library-answers-its-plugins" : "instance-is-accepted");
    all.erase(std::remove(all.begin(), all.end(), check.name), all.end());
    return all;
}

bool Report::is_well() const {
    return std::none_of(results.begin(), results.end(), [](const Result& result) {
        const Verdict verdict = result.outcome.verdict;
        return verdict == Verdict::fail || verdict == Verdict::crash || verdict == Verdict::hang;
    });
}

std::string selected_names(const Host& host, const Options& options) { return Run(host, options).names(); }

Report run_checks(const Host& host, const Options& options) {
    const auto start = std::chrono::steady_clock::now();
    Report report;
    report.library = options.library;
    report.seed = options.seed;
    report.level = options.level;
    report.results = Run(host, options).go();
    report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return report;
}

}  // namespace pelorus::conformance
