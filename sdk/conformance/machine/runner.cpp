#include "runner.hpp"

#include <algorithm>
#include <chrono>
#include <map>
#include <set>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include <pelorus/abi/stage.h>

#include "elf.hpp"
#include "process.hpp"

namespace pelorus::conformance {

namespace {

bool concerns(const Check& check, const ManifestEntry& plugin) {
    const std::string group = check.group;
    if (group == "library") return false;  // once, and not for each plugin
    return group == "every" || group == plugin.kind || group == (plugin.table_id == PLR_STAGE ? "stage" : "model");
}

/// A check of one plugin on its way through the run.
struct Job {
    const Check* check;
    std::string plugin, kind;
    std::vector<std::size_t> needs = {};  // indices of jobs that must be done before it
    enum class State { waiting, running, done } state = State::waiting;
    Outcome outcome = {};
    bool is_spoilt = false;  // it failed, or was skipped because of one that did
};

class Run {
public:
    Run(const Host& host, const Options& options) : host_(host), options_(options) { plan(); }

    std::vector<Result> go() {
        const unsigned jobs = options_.jobs != 0 ? options_.jobs : std::max(1u, std::thread::hardware_concurrency());
        ProcessPool pool(jobs, options_.stop);
        try {
            for (;;) {
                skip_what_rests_on_failures();
                start_what_can(pool);
                if (pool.is_empty()) break;
                take(pool.wait());
            }
        } catch (const ProcessPool::Interrupted&) {
            for (Job& job : jobs_)
                if (job.state != Job::State::done) skip(job, "interrupted");
        }
        if (std::any_of(jobs_.begin(), jobs_.end(), [](const Job& job) { return job.state != Job::State::done; }))
            throw std::logic_error("checks rest on each other in a circle");
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
            if (std::string(check.group) == "library" && is_selected(check, wanted)) jobs_.push_back({&check, "", ""});
        for (const ManifestEntry& plugin : plugins)
            for (const Check& check : checks())
                if (concerns(check, plugin) && is_selected(check, wanted))
                    jobs_.push_back({&check, plugin.id, plugin.kind});
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

    /// Once all are there: a check may stand before what it rests on.
    void find_needs() {
        for (Job& job : jobs_)
            for (const std::string& name : prerequisites_of(*job.check))
                for (std::size_t i = 0; i < jobs_.size(); ++i)
                    if (name == jobs_[i].check->name && (jobs_[i].plugin.empty() || jobs_[i].plugin == job.plugin))
                        job.needs.push_back(i);
    }

    static void skip(Job& job, const std::string& reason) {
        job.outcome.verdict = Verdict::skipped;
        job.outcome.reason = reason;
        job.state = Job::State::done;
    }

    /// Again and again, because what rests on a check may come before it in the list.
    void skip_what_rests_on_failures() {
        for (bool is_news = true; is_news;) {
            is_news = false;
            for (Job& job : jobs_) {
                const auto spoilt = std::find_if(job.needs.begin(), job.needs.end(),
                                                 [&](std::size_t needed) { return jobs_[needed].is_spoilt; });
                if (job.state != Job::State::waiting || spoilt == job.needs.end()) continue;
                skip(job, std::string(jobs_[*spoilt].check->name) + " failed");
                job.is_spoilt = is_news = true;
            }
        }
    }

    void start_what_can(ProcessPool& pool) {
        for (std::size_t i = 0; i < jobs_.size() && !pool.is_full(); ++i) {
            Job& job = jobs_[i];
            const auto is_done = [&](std::size_t needed) { return jobs_[needed].state == Job::State::done; };
            if (job.state != Job::State::waiting || !std::all_of(job.needs.begin(), job.needs.end(), is_done)) continue;
            job.state = Job::State::running;
            const Task task = task_of(job);
            pool.start(i, options_.time_limit, [task](int descriptor) { run_child(task, descriptor); });
        }
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
        job.outcome = read_outcome(ended.written);
        if (ended.ran_out_of_time) {
            std::string told = fmt::format("did not come back within {} s", options_.time_limit);
            if (job.outcome.verdict == Verdict::hang && !job.outcome.messages.empty())
                told += "; " + job.outcome.messages.front();
            job.outcome = Outcome();
            job.outcome.verdict = Verdict::hang;
            job.outcome.messages.push_back(told);
        } else if (job.outcome.verdict == Verdict::crash && job.outcome.messages.empty()) {
            job.outcome.messages.push_back("the process ended: " + ended.how);
        }
        job.outcome.seconds = ended.seconds;
        for (std::string& message : job.outcome.messages) message = with_places_resolved(message);
        job.is_spoilt = is_bad(job.outcome.verdict);
        if (job.is_spoilt && !ended.talk.empty()) job.outcome.messages.push_back("the plugin wrote: " + ended.talk);
        job.state = Job::State::done;
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
    const auto is_amiss = [](const Result& result) {
        const Verdict verdict = result.outcome.verdict;
        // A plugin of which there is no instance was not tried at all.
        return is_bad(verdict) ||
               (verdict == Verdict::skipped && std::string(result.check->name) == "instance-is-made");
    };
    return !was_interrupted && std::none_of(results.begin(), results.end(), is_amiss);
}

std::string selected_names(const Host& host, const Options& options) { return Run(host, options).names(); }

Report run_checks(const Host& host, const Options& options) {
    const auto start = std::chrono::steady_clock::now();
    Report report;
    report.library = options.library;
    report.seed = options.seed;
    report.level = options.level;
    report.results = Run(host, options).go();
    report.was_interrupted = options.stop != nullptr && *options.stop;
    report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return report;
}

}  // namespace pelorus::conformance
