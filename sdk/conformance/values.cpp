// What create makes of the values that a host hands it: at the bounds, within them, and beyond.
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "machine/bench.hpp"
#include "machine/creation.hpp"
#include "machine/fault_handler.hpp"
#include "machine/refusal.hpp"

namespace pelorus::conformance {

namespace {

/// Whether create survives these values: an instance, or a lawful refusal. Ends the check if not.
void try_values(const Instance& holder, const AlteredConfig& altered, const std::string& title) {
    set_subject_of_fault(title.c_str());
    const Creation made(holder.plugin(), altered.get());
    if (!made.left_by().empty()) FAIL("with {" << title << "}: " << made.told());
    if (!made.is_made() && made.status() >= 0)
        FAIL("with {" << title << "}: create answered " << made.told() << ", and no instance");
}

void try_each(const Instance& holder, const std::vector<Trial>& trials) {
    for (const Trial& trial : trials) {
        AlteredConfig altered(holder);
        if (apply(trial, holder.description(), altered)) try_values(holder, altered, trial.title);
    }
    set_subject_of_fault("");
}

/// A value within the bounds; of parameters without, some plausible one.
double random_within(const plr_parameter& parameter, Sample& sample) {
    const double least = std::max(parameter.min, -1e6), most = std::min(parameter.max, 1e6);
    const double wide = sample.uniform(least, most);
    const double narrow = std::min(most, std::max(least, sample.normal()));
    const double value = sample.below(2) == 0 ? wide : narrow;
    const bool is_excluded = (value <= parameter.min && (parameter.flags & PLR_PARAMETER_MIN_EXCLUSIVE) != 0) ||
                             (value >= parameter.max && (parameter.flags & PLR_PARAMETER_MAX_EXCLUSIVE) != 0);
    return is_excluded ? least + (most - least) / 2 : value;
}

/// A whole number within the bounds; of threads, particles and the like there are not so many that a machine breaks down.
double random_count(const plr_parameter& parameter, Sample& sample) {
    constexpr double span = 100;
    const double least = std::max(parameter.min, std::isfinite(parameter.max) ? parameter.max - 1e6 : -span),
                 most = std::min(parameter.max, std::max(least, 0.0) + span);
    return std::min(most, std::floor(sample.uniform(least, most + 1)));
}

}  // namespace

PELORUS_CHECK(
    every, "bounds-are-survived", 2,
    "Values at the bounds that a parameter or column declares, and just inside them, make an instance or are refused, "
    "and so do strings and paths of any kind and tables of few and many rows; there lie divisions by zero, empty "
    "ranges and buffers that are too short.",
    {"instance-is-accepted"}) {
    const auto holder = bench.make();
    const std::vector<Trial> trials = trials_within(bench.description());
    if (trials.empty()) skip("no parameter has bounds, choices, text or rows");
    try_each(*holder, trials);
}

PELORUS_CHECK(
    every, "absurd-values-are-survived", 2,
    "A number beyond its bounds, infinite or not a number never makes create crash or throw, whatever it is answered: "
    "a host that checks less than ours must not be taken down.",
    {"instance-is-accepted"}) {
    const auto holder = bench.make();
    const std::vector<Trial> trials = trials_outside(bench.description());
    if (trials.empty()) skip("no parameter is a number");
    try_each(*holder, trials);
}

PELORUS_CHECK(
    every, "random-values-are-survived", 4,
    "Random values within the bounds, in random combinations, make an instance or are refused with the name of a "
    "parameter; sweeps reach combinations that nobody thought of.",
    {"bounds-are-survived", "refusals-are-told"}) {
    constexpr int most = 500;
    constexpr double time_limit = 1;  // s
    const plr_description& description = bench.description();
    const auto holder = bench.make();
    Sample sample = bench.sample();
    const auto start = std::chrono::steady_clock::now();
    int count = 0, refused = 0;
    while (count < most && std::chrono::steady_clock::now() - start < std::chrono::duration<double>(time_limit)) {
        AlteredConfig altered(*holder);
        std::vector<std::string> titles;
        for (std::uint32_t p = 0; p < description.parameter_count; ++p) {
            const plr_parameter& parameter = element_of(description.parameters, p);
            const bool is_number = parameter.type == PLR_TYPE_DOUBLE || parameter.type == PLR_TYPE_VECTOR ||
                                   parameter.type == PLR_TYPE_MATRIX;
            Trial trial{p, "", 0};
            if (is_number)
                trial.number = random_within(parameter, sample);
            else if (parameter.type == PLR_TYPE_INT)
                trial.number = random_count(parameter, sample);
            else if (parameter.type == PLR_TYPE_BOOL)
                trial.number = static_cast<double>(sample.below(2));
            else if (parameter.type == PLR_TYPE_CHOICE)
                trial.number = static_cast<double>(sample.below(parameter.choice_count));
            else
                continue;
            if (sample.below(4) != 0 && apply(trial, description, altered))
                titles.push_back(fmt::format("{}: {:.17g}", parameter.name, trial.number));
        }
        const std::string title = fmt::format("{}", fmt::join(titles, ", "));
        set_subject_of_fault(title.c_str());
        const Creation made(holder->plugin(), altered.get());
        ++count;
        if (made.is_made()) continue;
        ++refused;
        const std::string problem = refusal_problem(made, description, true);
        if (!problem.empty()) FAIL("with {" << title << "}: " << problem);
    }
    set_subject_of_fault("");
    note(fmt::format("{} combinations, {} of them refused", count, refused));
}

}  // namespace pelorus::conformance
