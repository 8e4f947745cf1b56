/// The bench on which a check puts its subject: the library under test, instances of it, random samples.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "check.hpp"
#include "host.hpp"
#include "instance.hpp"
#include "library.hpp"
#include "sample.hpp"

namespace pelorus::conformance {

/// What one child process works on.
struct Task {
    const Host* host = nullptr;
    std::string library;  ///< absolute path
    std::string plugin;   ///< id, or "" for checks of the library
    std::string kind;     ///< of the plugin
    std::string check;
    std::vector<Subject> subjects;  ///< of the plugin; empty: its defaults and single choices
    std::uint64_t seed = 1;
};

class Bench {
public:
    Bench(const Task& task, const Subject& subject, bool is_first)
        : task_(task), subject_(subject), is_first_(is_first) {}

    const Host& host() const noexcept { return *task_.host; }
    const Task& task() const noexcept { return task_; }
    const Subject& subject() const noexcept { return subject_; }
    /// Leaves a check that concerns the plugin as such, whatever its values, after the first subject.
    void once_a_plugin() const {
        if (!is_first_) skip("tried once a plugin");
    }
    /// The library, loaded (once) in this process. Fails the check if it cannot be.
    const Library& library() const { return Library::load(task_.library); }
    const plr_plugin& plugin() const { return library().plugin(task_.plugin); }
    const plr_description& description() const { return *plugin().description; }

    /// The subject with everything below it. Fails the check if it cannot be made.
    std::unique_ptr<Instance> make(const Surroundings& surroundings = {}) const;
    /// The same with further parameters, as a YAML map.
    std::unique_ptr<Instance> make_with(const std::string& yaml, const Surroundings& surroundings = {}) const;
    /// The same; Refused is let through.
    std::unique_ptr<Instance> try_make(const std::string& yaml, const Surroundings& surroundings = {}) const;

    /// Random numbers of this check and subject; other streams are independent. The same for the same seed.
    Sample sample(std::uint64_t stream = 0) const;

private:
    const Task& task_;
    const Subject& subject_;
    bool is_first_;
};

}  // namespace pelorus::conformance
