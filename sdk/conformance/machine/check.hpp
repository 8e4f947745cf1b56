/// A check of the conformance suites: one law that a plugin must obey, and the Catch2 case that tries it.
///
///     PELORUS_CHECK(motion, "motion-jacobian-is-derivative", 3,
///                   "The Jacobian is the derivative of propagate; a filter with another one diverges without a word.",
///                   {"numbers-finite"}) {
///         const Instance instance = bench.make();
///         ...
///         FAIL("element (velocity.x, position.y) is 0.1, differences say -0.1 at dt = 1 s");
///     }
///
/// The body runs in a process of its own, once for every subject (a plugin under one set of parameter values). What it tells goes
/// through Catch2: REQUIRE, CHECK, FAIL, INFO. It may also leave by skip().
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

namespace pelorus::conformance {

class Bench;

struct Check {
    const char* group;  ///< whom it concerns: `library`, `every`, `model`, `stage`, or one kind
    const char* name;   ///< kebab-case, unique among all checks
    int level;  ///< 1: it loads; 2: the contract; 3: the laws of its kind; 4: statistics and fuzz; 5: load and cost
    const char* law;                         ///< a sentence: what must hold, and why it matters
    std::vector<std::string> prerequisites;  ///< names of checks without which this one means nothing
    const char* file;
    int line;
};

/// All checks, in the order in which they are told: groups as in `groups`, then level, then as they stand in the source.
const std::vector<Check>& checks();
/// The check of that name, or nullptr.
const Check* find_check(const std::string& name);

/// Leaves a check that has nothing to try on this subject. The reason is shown.
struct Skipped : std::runtime_error {
    using std::runtime_error::runtime_error;
};
[[noreturn]] inline void skip(const std::string& reason) { throw Skipped(reason); }

/// Something that an author should know but that breaks no law.
void warn(const std::string& text);
/// A figure that the report shows beside the verdict: `3.1 ns an item`.
void note(const std::string& text);

namespace detail {
struct Registration {
    explicit Registration(Check check);
};
/// Runs the body for every subject, and keeps skips apart from failures.
void run(void (*body)(Bench&));
}  // namespace detail

}  // namespace pelorus::conformance

#define PELORUS_CHECK_NAMED_(body, group_, name_, level_, law_, ...)                                                \
    static void body(::pelorus::conformance::Bench& bench);                                                         \
    static const ::pelorus::conformance::detail::Registration INTERNAL_CATCH_UNIQUE_NAME(check_registration)(       \
        ::pelorus::conformance::Check{#group_, name_, level_, law_, std::vector<std::string> __VA_ARGS__, __FILE__, \
                                      __LINE__});                                                                   \
    TEST_CASE(name_, "[" #group_ "]") { ::pelorus::conformance::detail::run(&body); }                               \
    static void body([[maybe_unused]] ::pelorus::conformance::Bench& bench)

/// The last argument is the braced list of prerequisites, `{}` if there are none.
#define PELORUS_CHECK(group_, name_, level_, law_, ...) \
    PELORUS_CHECK_NAMED_(INTERNAL_CATCH_UNIQUE_NAME(check_body), group_, name_, level_, law_, __VA_ARGS__)
